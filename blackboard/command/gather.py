"""What a run knows: its result at the end, and snapshots on the way for the moving picture."""

from dataclasses import replace

import numpy as np

from blackboard.grid import Grid
from blackboard.kinds import GRID, LINE
from blackboard.messages.geometry import Pose
from blackboard.report.animation import Frame
from blackboard.report.result import RunResult, driven_m
from blackboard.report.scores import score_table
from blackboard.report.view import known_part
from blackboard.runner import Run

FRAMES = 60


def gather(run: Run, title: str) -> RunResult:
    """Return what a run knows at its end, with the table of its figures."""
    trajectory = run.trajectory()
    span_s = float(trajectory[-1, 0] - trajectory[0, 0]) if len(trajectory) else 0.0
    result = RunResult(
        mission=title,
        robot=run.robot.description,
        trajectory=trajectory,
        grid=Grid.from_tiles(entry.value for entry in run.board.entries(GRID)),
        lines=run.board.entries(LINE),
        true_trajectory=run.true_trajectory(),
        truth=run.robot.truth(),
    )
    table: dict[str, float | int | str] = {"robot": result.robot.name, "time_s": span_s, "path_m": driven_m(trajectory)}
    table |= run.robot.summary()
    table |= {"lines": len(result.lines), "posts": run.board.posts}
    table |= score_table(result)
    return replace(result, table=table)


class FrameCollector:
    """Takes snapshots of a run, evenly over its time."""

    def __init__(self, run: Run) -> None:
        self.frames: list[Frame] = []
        self._run = run

    def note(self, elapsed_s: float, total_s: float) -> None:
        """Take a snapshot if it is time for one."""
        trajectory = self._run.trajectory()
        if len(self.frames) > FRAMES * elapsed_s / total_s or not len(trajectory):
            return
        grid = Grid.from_tiles(entry.value for entry in self._run.board.entries(GRID))
        known = known_part(grid) if grid is not None else None
        stamp_s, x_m, y_m, heading_rad = (float(number) for number in trajectory[-1])
        self.frames.append(
            Frame(
                stamp_s=stamp_s,
                pose=Pose(x_m=x_m, y_m=y_m, heading_rad=heading_rad),
                trajectory=trajectory,
                grid=replace(known, cells=np.array(known.cells)) if known is not None else None,
                lines=[entry.value for entry in self._run.board.entries(LINE)],
            )
        )
