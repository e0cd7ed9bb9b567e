"""Writes all that a run leaves behind, each file only where there is something to put in it."""

from pathlib import Path

from blackboard.report.grid_files import write_grid_png, write_ros_map
from blackboard.report.lines_file import write_lines
from blackboard.report.overview import write_overview
from blackboard.report.result import RunResult
from blackboard.report.trajectory_file import write_trajectory


def write_results(result: RunResult, folder: Path) -> None:
    """Write grid, lines, trajectories and overview into an existing folder; raise OutputError where that fails."""
    if result.grid is not None:
        write_grid_png(result.grid, folder / "grid.png")
        write_ros_map(result.grid, folder)
    write_lines(result.lines, folder / "lines.geojson")
    write_trajectory(result.trajectory, folder / "trajectory.tum")
    if result.true_trajectory is not None:
        write_trajectory(result.true_trajectory, folder / "truth.tum")
    write_overview(result, folder / "overview.png")
