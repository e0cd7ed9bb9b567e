"""What folding a scan into the grid costs, against a straightforward numpy implementation in the same run.

python benchmarks/grid_speed.py

Scans are those of the simulated k2a (12 sonars) and pioneer (181-beam laser) at 200 places on their way through the lab.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core

from math import pi
from statistics import median
from time import process_time
from typing import Any

import numpy as np

from blackboard.entry import Entry
from blackboard.kinds import LASER_SCAN, SONAR_SCAN
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import LaserScan, RobotDescription, SonarScan
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run
from knowledge_sources.eou_grid import EvidenceGrid
from knowledge_sources.eou_params import EouGridParams
from knowledge_sources.sonar_evidence import pings

PLACES, ROUNDS = 200, 9
Scan = SonarScan | LaserScan


def scans(robot: str, kind: Any) -> tuple[RobotDescription, list[tuple[Pose, Scan]]]:
    """Return scans of a simulated robot and where they were taken."""
    settings = {"robot": {"robot": robot, "odometry_errors": False}}
    run = Run(load_mission(find_mission("wander-lab"), settings))
    taken: list[tuple[Pose, Scan]] = []

    def note(entry: Entry[Any]) -> None:
        pose = run.robot.true_pose()
        if pose is not None:
            taken.append((pose, entry.value))

    run.board.subscribe(run.board.key(kind), note)
    while len(taken) < PLACES:
        run.cycle()
    return run.robot.description, taken


def plain_sonar(cells: np.ndarray, scan: SonarScan, robot: RobotDescription, pose: Pose, params: EouGridParams) -> None:
    """Test every cell of the window around each sonar against its cone."""
    half = cells.shape[0] // 2
    for ping in pings(scan, robot, pose, params):
        reach = int(params.sonar_range_m / params.cell_m) + 2
        row, column = half + int(ping.y_m / params.cell_m), half + int(ping.x_m / params.cell_m)
        window = cells[row - reach : row + reach + 1, column - reach : column + reach + 1]
        rows, columns = np.mgrid[-reach : reach + 1, -reach : reach + 1]
        ranges = np.hypot(rows, columns) * params.cell_m
        off = (np.arctan2(rows, columns) - ping.heading_rad + pi) % (2 * pi) - pi
        inside = np.abs(off) <= ping.cone_rad / 2
        window[inside & (ranges < ping.range_m - params.clear_margin_m)] -= params.sonar_down
        window[inside & (np.abs(ranges - ping.range_m) <= params.band_m)] += params.sonar_up
        np.clip(window, 0, 255, out=window)


def plain_laser(cells: np.ndarray, scan: LaserScan, robot: RobotDescription, pose: Pose, params: EouGridParams) -> None:
    """Walk along every beam in steps of half a cell."""
    half = cells.shape[0] // 2
    at = pose @ robot.lasers[scan.laser].mount
    for i, range_m in enumerate(scan.ranges_m):
        if range_m is None:
            continue
        angle = at.heading_rad + scan.angle_min_rad + i * scan.angle_step_rad
        along = np.arange(0.0, min(range_m, params.laser_range_m), params.cell_m / 2)
        rows = half + np.floor((at.y_m + along * np.sin(angle)) / params.cell_m).astype(int)
        columns = half + np.floor((at.x_m + along * np.cos(angle)) / params.cell_m).astype(int)
        cells[rows[:-3], columns[:-3]] -= params.laser_down
        cells[rows[-1], columns[-1]] += params.laser_up
        np.clip(cells[rows, columns], 0, 255)


def main() -> None:
    params = EouGridParams()
    cases: tuple[tuple[str, str, Any, Any], ...] = (
        ("12-sonar scan", "k2a", SONAR_SCAN, plain_sonar),
        ("181-beam scan", "pioneer", LASER_SCAN, plain_laser),
    )
    for name, robot_name, kind, plain in cases:
        robot, taken = scans(robot_name, kind)
        ours, theirs = [], []
        for _ in range(ROUNDS):
            grid = EvidenceGrid(params)
            for pose, scan in taken:  # once to warm the templates up, as after a minute of driving
                grid.fold(scan, robot, pose)
            started = process_time()
            for pose, scan in taken:
                grid.fold(scan, robot, pose)
            ours.append((process_time() - started) / PLACES * 1e3)
            cells = np.full((800, 800), 128, np.int16)
            started = process_time()
            for pose, scan in taken[:20]:
                plain(cells, scan, robot, pose, params)
            theirs.append((process_time() - started) / 20 * 1e3)
        print(
            f"{name}: {median(ours):.3f} ms, plain numpy {median(theirs):.3f} ms, ratio {median(ours) / median(theirs):.4f}"
        )


if __name__ == "__main__":
    main()
