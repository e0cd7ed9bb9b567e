"""Lines in maps of points: a real office against the lines that others drew for it, and floor plans against their own walls.

python benchmarks/lines_of_points.py [--noise M]

The office is an ARIA map. Of a plan, points are strewn along the edges of what is free, a centimetre apart, with a laser's noise;
its walls are those edges, from 0.25 m on. A line is on a wall, and a wall found, within 10 cm and 3 degrees.
"""

import argparse
import os
import tempfile
from pathlib import Path
from time import process_time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core

import numpy as np
import numpy.typing as npt

from blackboard.command.gather import gather
from blackboard.mission import find_mission, load_mission
from blackboard.report.drawn_lines import NEAR_M, NEAR_RAD, STEP_M
from blackboard.report.result import RunResult, segments
from blackboard.report.scores import covered
from blackboard.report.walls import Segments, sample, wall_edges
from blackboard.runner import Run, RunOptions
from sim.ros_map import load_ros_map

MAPS = Path(__file__).resolve().parents[2] / "shared" / "data" / "maps"
OFFICE = MAPS / "aria-columbia.map.gz"
PLANS = (  # file, metres a pixel; the widths of all but autolab's are a guess, which makes their walls as thick as walls are
    ("stage-autolab.png", 16.0 / 809),
    ("stage-simple_rooms.png", 0.05),
    ("stage-hospital_section.png", 0.04),
    ("stage-cave.png", 0.03),
)
LEAST_M = 0.25


def lines_of(path: Path) -> tuple[RunResult, float]:
    """Return what `ski lines` makes of a file, and the CPU seconds that it took without pictures."""
    started = process_time()
    run = Run(load_mission(find_mission("lines-of-points"), {"robot": {"path": str(path)}}), RunOptions(strict=True))
    run.run()
    used_s = process_time() - started
    return gather(run, path.name), used_s


def edges_of(image: Path, cell_m: float) -> Segments:
    """Return the straight edges of what is free in a plan."""
    with tempfile.TemporaryDirectory() as folder:
        header = Path(folder) / "map.yaml"
        header.write_text(
            f"image: {image}\nresolution: {cell_m}\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
        )
        return wall_edges(load_ros_map(header).truth())


def strewn(edges: Segments, noise_m: float) -> npt.NDArray[np.float64]:
    """Return points along edges."""
    points = sample(edges, 0.01).points
    return np.asarray(points + np.random.default_rng(0).normal(0.0, noise_m, points.shape))


def against(ours: Segments, edges: Segments) -> tuple[float, float]:
    """Return the share of the edges' length that is found, and the share of our lines' length on none."""
    asked = edges[np.hypot(edges[:, 2] - edges[:, 0], edges[:, 3] - edges[:, 1]) >= LEAST_M]
    walls, drawn = sample(asked, STEP_M), sample(ours, STEP_M)
    found = covered(walls.points, walls.directions, ours, NEAR_M, NEAR_RAD)
    on = covered(drawn.points, drawn.directions, edges, NEAR_M, NEAR_RAD)
    return float(walls.weights_m[found].sum() / walls.weights_m.sum()), float(
        drawn.weights_m[~on].sum() / drawn.weights_m.sum()
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--noise", type=float, default=0.015, help="deviation of the points along a plan's edges, m")
    options = parser.parse_args()
    if not OFFICE.exists():
        print(f"{OFFICE} is absent: nothing to measure")
        return
    result, used_s = lines_of(OFFICE)
    figures = {name: float(value) for name, value in result.table.items() if name != "robot"}
    print(f"{OFFICE.name}: {figures['points']:.0f} points, {figures['drawn_lines']:.0f} lines drawn by others")
    print(f"  of their length found             {100 * figures['drawn_found_fraction']:8.1f} %")
    print(f"  of it with a point within 10 cm   {100 * figures['drawn_near_points_fraction']:8.1f} %")
    print(f"  of our length on none of theirs   {100 * figures['lines_not_drawn_fraction']:8.1f} %")
    print(f"  our lines                         {figures['lines']:8.0f}")
    print(f"  CPU                               {used_s:8.1f} s")
    print(f"\n{'plan':28}{'points':>9}{'walls m':>9}{'found %':>9}{'on no wall %':>14}{'lines':>7}{'s CPU':>7}")
    for name, cell_m in PLANS:
        edges = edges_of(MAPS / name, cell_m)
        points = strewn(edges, options.noise)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "points.txt"
            np.savetxt(path, points, "%.4f")
            result, used_s = lines_of(path)
        ours = segments([entry.value for entry in result.lines])
        found, beside = against(ours, edges)
        walls_m = float(sample(edges, STEP_M).weights_m.sum())
        row = f"{len(points):9}{walls_m:9.0f}{100 * found:9.1f}{100 * beside:14.1f}{len(ours):7}{used_s:7.1f}"
        print(f"{name:28}{row}", flush=True)


if __name__ == "__main__":
    main()
