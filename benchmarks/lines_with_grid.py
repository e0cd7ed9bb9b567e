"""What the grid is worth to the lines: with filter-raw and without it, in the simulated lab and on autolab.

python benchmarks/lines_with_grid.py [--seeds N] [--jobs N]

Bou-Ghannam 1992, section 5.2.2: echoes that the grid does not bear out are dropped before lines are sought. Twice: with the
thesis's lines (points on the cones' axes), and with the shipped ones, which hold each line against all echoes themselves. Sonars
only, and exact poses in both places, so that only the lines differ: in the lab exact odometry, on autolab the recorded truth in
odometry's stead. Degrees are the angle to the nearest direction of a wall within 10 cm, over the length that has one.
"""

import argparse
import os
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from statistics import mean
from typing import Any, NamedTuple

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core a run

import msgspec
import numpy as np
import shapely

from blackboard.component import Reading
from blackboard.kinds import LINE, ODOMETRY
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.sensing import Odometry
from blackboard.mission import find_mission, load_mission
from blackboard.report.pose_scores import true_poses
from blackboard.report.result import Trajectory, segments
from blackboard.report.scores import covered
from blackboard.report.trajectory_file import read_trajectory
from blackboard.report.visibility import viewpoints, visible
from blackboard.report.walls import Segments, sample, wall_edges
from blackboard.runner import Run, RunOptions
from sim.recordings.recorded import RecordedRobot
from sim.ros_map import load_ros_map

DATA = Path(__file__).resolve().parents[2] / "shared" / "data" / "sonar"
TRUTH = DATA / "autolab.truth.tum"
BITMAP = DATA.parent / "maps" / "stage-autolab.png"
SIZE_M = (16.0, 14.0)  # of the bitmap, which is centred on the origin
NEAR_M, NEAR_RAD = 0.10, np.deg2rad(3.0)
SAMPLE_M = 0.05
LEAST_WALL_M = 0.5
REACH_M = 5.0  # of a sonar
AUTOLAB_S = 900.0  # of its half hour
SCHEMES = tuple((method, use_grid) for method in ("axis", "tangent") for use_grid in (False, True))
Scheme = tuple[str, bool]


class Figures(NamedTuple):
    """How good the lines of a run are."""

    lines: float
    metres: float
    near_fraction: float  # of their length: within NEAR_M of a wall
    right_fraction: float  # and within NEAR_RAD of its direction
    turned_deg: float  # from the wall, over the length that is near one
    found_fraction: float  # of the length of walls that were in sight


class TrueRobot(RecordedRobot):
    """A recording in which the wheels know the truth."""

    @cached_property
    def _truth(self) -> Trajectory:
        return read_trajectory(TRUTH)

    def advance(self, until_s: float) -> Iterator[Reading[Any]]:
        for reading in super().advance(until_s):
            if reading.kind is not ODOMETRY:
                yield reading
                continue
            x_m, y_m, heading_rad = true_poses(np.array([reading.stamp_s]), self._truth)[0].tolist()
            pose = Pose(x_m=x_m, y_m=y_m, heading_rad=wrap_angle(heading_rad))
            value: Odometry = msgspec.structs.replace(reading.value, pose=pose)
            yield Reading(ODOMETRY, reading.stamp_s, value)


def settings(scheme: Scheme) -> dict[str, dict[str, Any]]:
    """Return what a scheme sets in a mission."""
    return {"line_finder": {"method": scheme[0]}, "filter_raw": {"use_grid": scheme[1]}}


def in_the_lab(job: tuple[Scheme, int]) -> Figures:
    """Return the figures of ten minutes in the lab."""
    scheme, seed = job
    run = Run(load_mission(find_mission("wander-lab"), settings(scheme)), RunOptions(seed=seed, strict=True))
    run.run(600.0)
    truth, path = run.robot.truth(), run.true_trajectory()
    assert truth is not None
    assert path is not None
    return figures(lines_of(run), wall_edges(truth), path)


def on_autolab(scheme: Scheme) -> Figures:
    """Return the figures of autolab."""
    robot = {"path": str(DATA / "autolab"), "sonar_latency_s": 0.1, "leave_out": "laser"}
    mission = load_mission(find_mission("map-recording"), {"robot": robot, **settings(scheme)})
    run = Run(replace(mission, robot=replace(mission.robot, type=TrueRobot)), RunOptions(strict=True))
    run.run(AUTOLAB_S)
    run.robot.close()
    return figures(lines_of(run), autolab_walls(), run.trajectory())


def lines_of(run: Run) -> Segments:
    """Return the lines that stand at the end."""
    return segments([entry.value for entry in run.board.entries(LINE)])


def figures(lines: Segments, edges: Segments, path: Trajectory) -> Figures:
    """Score lines against walls."""
    lengths = np.hypot(edges[:, 2] - edges[:, 0], edges[:, 3] - edges[:, 1])
    walls, drawn = sample(edges[lengths >= LEAST_WALL_M], SAMPLE_M), sample(lines, SAMPLE_M)
    seen = visible(walls, edges, viewpoints(path), REACH_M)
    found = covered(walls.points[seen], walls.directions[seen], lines, NEAR_M, NEAR_RAD)
    right = covered(drawn.points, drawn.directions, edges, NEAR_M, NEAR_RAD)
    total_m = float(drawn.weights_m.sum())
    if total_m == 0.0:
        return Figures(0, 0.0, 0.0, 0.0, 0.0, 0.0)
    tree = shapely.STRtree(shapely.linestrings(edges.reshape(-1, 2, 2)))
    at, edge = tree.query(shapely.points(drawn.points), predicate="dwithin", distance=NEAR_M)
    spans = (edges[:, 2:] - edges[:, :2]) / lengths[:, None]
    sine = np.abs(drawn.directions[at, 0] * spans[edge, 1] - drawn.directions[at, 1] * spans[edge, 0])
    turned = np.full(len(drawn.points), np.inf)
    np.minimum.at(turned, at, np.arcsin(np.minimum(sine, 1.0)))
    near = np.isfinite(turned)
    near_m = float(drawn.weights_m[near].sum())
    return Figures(
        lines=len(lines),
        metres=total_m,
        near_fraction=near_m / total_m,
        right_fraction=float(drawn.weights_m[right].sum()) / total_m,
        turned_deg=float(np.rad2deg(drawn.weights_m[near] @ turned[near] / near_m)) if near_m else 0.0,
        found_fraction=float(walls.weights_m[seen][found].sum() / walls.weights_m[seen].sum()),
    )


def autolab_walls() -> Segments:
    """Return the edges of what is free in the bitmap."""
    from PIL import Image

    with Image.open(BITMAP) as image:
        cell_m = SIZE_M[0] / image.width
    with tempfile.TemporaryDirectory() as folder:
        header = Path(folder) / "map.yaml"
        header.write_text(
            f"image: {BITMAP}\nresolution: {cell_m}\norigin: [{-SIZE_M[0] / 2}, {-SIZE_M[1] / 2}, 0]\n"
            "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
        )
        return wall_edges(load_ros_map(header).truth())


def show(scheme: Scheme, f: Figures) -> None:
    """Print one line of a table."""
    method = "points on the axes" if scheme[0] == "axis" else "tangent lines"
    shares = (
        f"{100 * f.near_fraction:12.1f}{100 * f.right_fraction:15.1f}{f.turned_deg:8.1f}{100 * f.found_fraction:15.1f}"
    )
    print(
        f"{method + (', filter-raw' if scheme[1] else ', all echoes'):33}{f.lines:6.0f}{f.metres:8.0f}{shares}",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    head = f"{'':33}{'lines':>6}{'metres':>8}{'in 10 cm %':>12}{'and 3 deg %':>15}{'deg':>8}{'walls found %':>15}"
    with ProcessPoolExecutor(max_workers=options.jobs) as pool:
        print(f"lab, mean of {options.seeds} seeds x 10 minutes\n{head}", flush=True)
        jobs = [(scheme, seed) for scheme in SCHEMES for seed in range(options.seeds)]
        done = list(pool.map(in_the_lab, jobs))
        for number, scheme in enumerate(SCHEMES):
            mine = done[number * options.seeds : (number + 1) * options.seeds]
            show(scheme, Figures(*(mean(column) for column in zip(*mine, strict=True))))
        if not (DATA / "autolab").exists():
            print(f"\n{DATA / 'autolab'} is absent: not measured there")
            return
        print(f"\nautolab, the first {AUTOLAB_S / 60:.0f} minutes\n{head}", flush=True)
        for scheme, scored in zip(SCHEMES, pool.map(on_autolab, SCHEMES), strict=True):
            show(scheme, scored)


if __name__ == "__main__":
    main()
