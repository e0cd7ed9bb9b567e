"""What the grid is worth to the lines: with filter-raw and without it, in the simulated lab and on autolab.

python benchmarks/lines_with_grid.py [--seeds N] [--jobs N]

Bou-Ghannam 1992, section 5.2.2: echoes that the grid does not bear out are dropped before lines are sought. Twice: with the
thesis's lines (points on the cones' axes) and with tangent lines, which hold each line against all echoes themselves. In the
lab (exact odometry) a wall is found, and a line right, within 5 cm and 3 degrees; on autolab, whose pose the sonar matcher
holds to about a decimetre, within 10 cm of the bitmap's walls.
"""

import argparse
import os
import tempfile
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from statistics import mean
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core a run

import numpy as np
import numpy.typing as npt
import shapely

from blackboard.command.gather import gather
from blackboard.mission import find_mission, load_mission
from blackboard.report.pose_scores import true_poses
from blackboard.report.result import segments
from blackboard.report.trajectory_file import read_trajectory
from blackboard.report.walls import sample
from blackboard.runner import Run, RunOptions
from sim.ros_map import load_ros_map

DATA = Path(__file__).resolve().parents[2] / "shared" / "data" / "sonar"
BITMAP = DATA.parent / "maps" / "stage-autolab.png"
SIZE_M = (16.0, 14.0)  # of the bitmap, which is centred on the origin
NEAR_M = 0.10
SAMPLE_M = 0.05
SCHEMES = tuple((method, use_grid) for method in ("axis", "tangent") for use_grid in (False, True))
Scheme = tuple[str, bool]


def settings(scheme: Scheme) -> dict[str, dict[str, Any]]:
    """Return what a scheme sets in a mission."""
    return {"line_finder": {"method": scheme[0]}, "filter_raw": {"use_grid": scheme[1]}}


def in_the_lab(job: tuple[Scheme, int]) -> tuple[int, float, float]:
    """Return the lines, the fraction of walls found and the fraction of the lines' length that is right."""
    scheme, seed = job
    run = Run(load_mission(find_mission("explore-lab"), settings(scheme)), RunOptions(seed=seed, strict=True))
    run.run(600.0)
    table: Mapping[str, Any] = gather(run, "lab").table
    return table["lines"], table.get("walls_found_fraction", 0.0), 1.0 - table.get("lines_spurious_fraction", 1.0)


def on_autolab(scheme: Scheme) -> tuple[int, float, float]:
    """Return the lines, their length, and the fraction of it within NEAR_M of a wall."""
    over = {"robot": {"path": str(DATA / "autolab"), "sonar_latency_s": 0.1}, **settings(scheme)}
    run = Run(load_mission(find_mission("map-recording-sonar"), over), RunOptions(strict=True))
    run.run()
    run.robot.close()
    result = gather(run, "autolab")
    lines = in_truth(segments([entry.value for entry in result.lines]), result.trajectory[0])
    drawn = sample(lines, SAMPLE_M)
    near = shapely.dwithin(shapely.points(drawn.points), walls(), NEAR_M)
    length_m = float(drawn.weights_m.sum())
    return len(lines), length_m, float(drawn.weights_m[near].sum()) / length_m if length_m else 0.0


def in_truth(lines: npt.NDArray[np.float64], first: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return lines (n, 4) in the frame of the truth, the first pose (stamp, x, y, heading) being where it was."""
    there = true_poses(first[:1], read_trajectory(DATA / "autolab.truth.tum"))[0]
    turn = there[2] - first[3]
    rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    ends = (lines.reshape(-1, 2) - first[1:3]) @ rotation + there[:2]
    return np.asarray(ends.reshape(-1, 4))


def walls() -> shapely.Geometry:
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
        world = load_ros_map(header)
    edges = shapely.boundary(world.free)
    shapely.prepare(edges)
    return edges


def show(scheme: Scheme, figures: str) -> None:
    """Print one line of a table."""
    method, use_grid = scheme
    named = (
        f"{'points on the axes' if method == 'axis' else 'tangent lines'}, {'filter-raw' if use_grid else 'all echoes'}"
    )
    print(f"{named:34}{figures}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    with ProcessPoolExecutor(max_workers=options.jobs) as pool:
        print(f"lab, mean of {options.seeds} seeds x 10 minutes")
        print(f"{'':34}{'lines':>8}{'walls found %':>16}{'lines right %':>16}")
        jobs = [(scheme, seed) for scheme in SCHEMES for seed in range(options.seeds)]
        done = list(pool.map(in_the_lab, jobs))
        for number, scheme in enumerate(SCHEMES):
            mine = done[number * options.seeds : (number + 1) * options.seeds]
            lines, found, right = (mean(column) for column in zip(*mine, strict=True))
            show(scheme, f"{lines:8.0f}{100 * found:16.1f}{100 * right:16.1f}")
        if not (DATA / "autolab").exists():
            print(f"\n{DATA / 'autolab'} is absent: not measured there")
            return
        print(f"\nautolab, half an hour\n{'':34}{'lines':>8}{'metres':>16}{'lines right %':>16}")
        for scheme, (count, length_m, near) in zip(SCHEMES, pool.map(on_autolab, SCHEMES), strict=True):
            show(scheme, f"{count:8}{length_m:16.1f}{100 * near:16.1f}")


if __name__ == "__main__":
    main()
