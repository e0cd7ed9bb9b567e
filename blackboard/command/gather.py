"""What a run knows: its result at the end, and snapshots on the way for the moving picture."""

from collections import Counter
from dataclasses import replace
from math import atan2, cos, pi, sin

import numpy as np
import numpy.typing as npt

from blackboard.board import Board
from blackboard.command.seen_run import SeenRun
from blackboard.entry import Entry
from blackboard.grid import Grid
from blackboard.kinds import (
    CORNER,
    CORRECTED_PATH,
    FOUND_OBJECT,
    GRID,
    LINE,
    MISSION,
    MODEL_LINE,
    RESOLUTION_TASK,
    SUPPORTED_POINTS,
    TARGET,
    TRAP,
)
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.mapping import CorrectedPath
from blackboard.messages.model import ModelLine
from blackboard.messages.motion import MissionStatus
from blackboard.messages.world import Line
from blackboard.report.animation import Frame
from blackboard.report.corner_scores import corner_scores
from blackboard.report.drawn_lines import drawn_lines_table
from blackboard.report.pose_scores import pose_table
from blackboard.report.result import RunResult, driven_m
from blackboard.report.scores import score_table
from blackboard.report.view import known_part

FRAMES = 60
OUTCOMES = ("confirmed", "denied", "given up", "open")  # of resolution tasks


def gather(run: SeenRun, title: str) -> RunResult:
    """Return what a run knows at its end, with the table of its figures."""
    corrected = run.board.newest(CORRECTED_PATH)
    trajectory = run.trajectory() if corrected is None else corrected.value.poses.unpack()
    span_s = float(trajectory[-1, 0] - trajectory[0, 0]) if len(trajectory) else 0.0
    result = RunResult(
        mission=title,
        robot=run.robot.description,
        trajectory=trajectory,
        grid=Grid.from_tiles(entry.value for entry in run.board.entries(GRID)),
        points=points_of(run.board),
        lines=lines_of(run.board),
        corners=[entry.value for entry in run.board.entries(CORNER)],
        targets=[entry.value for entry in run.board.entries(TARGET)],
        true_trajectory=run.true_trajectory(),
        truth=run.robot.truth(),
    )
    table: dict[str, float | int | str] = {"robot": result.robot.name, "time_s": span_s, "path_m": driven_m(trajectory)}
    table |= mission_rows(run.board.newest(MISSION))
    table |= run.robot.summary()
    if corrected is not None:
        table |= closing(corrected.value)
    symbols = {"corners": len(result.corners), "targets": len(result.targets), "traps": len(run.board.entries(TRAP))}
    symbols |= {"found_objects": sum(e.value.standing == "confirmed" for e in run.board.entries(FOUND_OBJECT))}
    table |= {"lines": len(result.lines)} | {name: count for name, count in symbols.items() if count}
    tasks: Counter[str] = Counter(entry.value.outcome for entry in run.board.entries(RESOLUTION_TASK))
    table |= {f"tasks_{outcome.replace(' ', '_')}": tasks[outcome] for outcome in OUTCOMES if tasks[outcome]}
    table |= {"posts": run.board.posts}
    table |= pose_table(result.trajectory, result.true_trajectory)
    table |= drawn_lines_table([entry.value for entry in result.lines], run.robot.drawn_lines(), result.points)
    table |= score_table(result)
    table |= corner_scores(result.corners, result.truth)
    return replace(result, table=table)


def mission_rows(status: Entry[MissionStatus] | None) -> dict[str, float | int | str]:
    """Return how the mission ended, and when; no rows where nobody ever said how it stands."""
    if status is None:
        return {}
    rows: dict[str, float | int | str] = {"mission": status.value.state}
    if status.value.state != "underway":
        rows |= {"mission_ended_s": status.stamp_s, "mission_detail": status.value.detail}
    return {name: value for name, value in rows.items() if value != ""}


def points_of(board: Board) -> npt.NDArray[np.float64] | None:
    """Return the points of the newest batch, (n, 2) m; None where there was none."""
    batch = board.newest(SUPPORTED_POINTS)
    return batch.value.points.unpack().astype(np.float64) if batch is not None else None


def closing(path: CorrectedPath) -> dict[str, float | int | str]:
    """Return the rows that say whether a drive closed."""
    rows: dict[str, float | int | str] = {"loops_closed": path.closures}
    if not path.closed:
        rows |= {"map_closed": "not closed: do not trust it"}
    else:
        rows |= {"map_closed": "yes" if path.seen_again else "nothing was seen again: no loop to close"}
    if path.seen_again:
        rows |= {"contradicted_fraction": path.contradicted_fraction}
    return rows


def lines_of(board: Board) -> list[Entry[Line]]:
    """Return the lines to show: those of the model where one stands, else all that were observed."""
    model = [as_observed(entry) for entry in board.entries(MODEL_LINE)]
    return model or board.entries(LINE)


def as_observed(entry: Entry[ModelLine]) -> Entry[Line]:
    """Return a line of the model in the form of an observed one, with its observations as support."""
    start, end = entry.value.start, entry.value.end
    alpha_rad = atan2(end.y_m - start.y_m, end.x_m - start.x_m) + pi / 2  # of the normal
    rho_m = start.x_m * cos(alpha_rad) + start.y_m * sin(alpha_rad)
    line = Line(
        start=start,
        end=end,
        alpha_rad=wrap_angle(alpha_rad if rho_m >= 0.0 else alpha_rad + pi),
        rho_m=abs(rho_m),
        sigma_rho_m=entry.value.sigma_rho_m,
        support=entry.value.observations,
    )
    return Entry(
        key=entry.key,
        id=entry.id,
        revision=entry.revision,
        event=entry.event,
        stamp_s=entry.stamp_s,
        source=entry.source,
        value=line,
        supports=entry.supports,
        endorsements=entry.endorsements,
    )


class FrameCollector:
    """Takes snapshots of a run, evenly over its time, however long it turns out to be: between FRAMES and twice as many."""

    def __init__(self, run: SeenRun) -> None:
        self.frames: list[Frame] = []
        self._run = run
        self._next_s = self._between_s = 0.0

    def note(self, elapsed_s: float, total_s: float) -> None:
        """Take a snapshot if it is time for one."""
        trajectory = self._run.trajectory()
        if elapsed_s < self._next_s or not len(trajectory):
            return
        if len(self.frames) == 2 * FRAMES:  # it goes on for longer: from now on half as many
            self.frames = self.frames[::2]
            self._between_s = elapsed_s / len(self.frames)
        self._next_s = elapsed_s + self._between_s
        grid = Grid.from_tiles(entry.value for entry in self._run.board.entries(GRID))
        known = known_part(grid) if grid is not None else None
        stamp_s, x_m, y_m, heading_rad = (float(number) for number in trajectory[-1])
        self.frames.append(
            Frame(
                stamp_s=stamp_s,
                pose=Pose(x_m=x_m, y_m=y_m, heading_rad=heading_rad),
                trajectory=trajectory,
                grid=replace(known, cells=np.array(known.cells)) if known is not None else None,
                lines=[entry.value for entry in lines_of(self._run.board)],
            )
        )
