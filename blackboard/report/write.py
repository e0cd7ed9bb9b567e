"""Writes all that a run leaves behind, beside its `board.jsonl`. Slow to load (matplotlib): import it where it is needed."""

from collections.abc import Sequence
from pathlib import Path

from blackboard.report.animation import Frame, write_animation
from blackboard.report.figures import write_figures
from blackboard.report.grid_files import write_grid_png, write_ros_map
from blackboard.report.lines_file import write_lines
from blackboard.report.milestones import Milestones
from blackboard.report.output_folder import unwritable
from blackboard.report.overview import write_overview
from blackboard.report.result import RunResult
from blackboard.report.trajectory_file import write_trajectory
from blackboard.report.view import known_part


def write_results(
    result: RunResult, folder: Path, frames: Sequence[Frame] = (), milestones: Milestones | None = None
) -> list[str]:
    """Write every file that there is something for into a prepared folder, and return their names.

    What an earlier run left there under such a name and this one has nothing for is removed, so that the folder tells of one
    run. Raises OutputError when the system refuses.
    """
    written: list[str] = []
    try:
        known = known_part(result.grid) if result.grid is not None else None
        if known is not None:
            write_grid_png(known, folder / "grid.png")
            write_ros_map(known, folder)
            written += ["grid.png", "map.pgm", "map.yaml"]
        write_lines(result.lines, folder / "lines.geojson")
        written.append("lines.geojson")
        if len(result.trajectory):
            write_trajectory(result.trajectory, folder / "trajectory.tum")
            written.append("trajectory.tum")
        if result.true_trajectory is not None:
            write_trajectory(result.true_trajectory, folder / "truth.tum")
            written.append("truth.tum")
        write_overview(result, folder / "overview.png")
        written.append("overview.png")
        if milestones is not None and write_figures(result, milestones, folder / "figures.png"):
            written.append("figures.png")
        if frames:
            write_animation(frames, result.robot.radius_m, folder / "map.gif")
            written.append("map.gif")
        for name in ("grid.png", "map.pgm", "map.yaml", "trajectory.tum", "truth.tum", "figures.png", "map.gif"):
            if name not in written:
                (folder / name).unlink(missing_ok=True)
    except OSError as error:
        raise unwritable(Path(error.filename) if error.filename else folder, error) from None
    return sorted(written)
