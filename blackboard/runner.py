"""One run of a mission on the local link: everything in one process, in lock-step, on the mission's clock.

Each cycle: readings arrive, reflexes answer, the control module spends its budget on knowledge sources, the planner decides.
The same mission, seed and readings give the same board, byte for byte.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from blackboard.access import Access
from blackboard.assembly import assemble
from blackboard.board import Board
from blackboard.component import Robot
from blackboard.control import Control
from blackboard.entry import Entry
from blackboard.kinds import MISSION, ROBOT
from blackboard.mission import Mission
from blackboard.planning import Planning
from blackboard.reflexes import Reflexes
from blackboard.resumption import resume, state_of
from blackboard.safety_watch import SafetyWatch
from blackboard.track import Track, believed_track

Progress = Callable[[float, float], None]  # elapsed and total seconds on the mission's clock


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """What differs from run to run of one mission."""

    seed: int = 0
    strict: bool = False


class Run:
    """A mission with its components built and wired. Raises MissionError where they do not fit together."""

    def __init__(self, mission: Mission, options: RunOptions | None = None) -> None:
        options = options or RunOptions()
        assembly = assemble(mission, options.seed)
        self.mission = mission
        self.robot: Robot[Any] = assembly.robot
        self.sources = assembly.sources
        description = self.robot.description
        self.board = Board(assembly.vocabulary, robot=description.name, history=mission.history)
        self.board.now_s = self.robot.start_s
        self.control = Control(self.board, self.sources, mission.control, strict=options.strict)
        self._reflexes: Reflexes | None = None
        self._safety: SafetyWatch | None = None
        if self.robot.moves and assembly.safety is not None:
            self._reflexes = Reflexes(
                self.board,
                assembly.behaviours,
                assembly.coordinator,
                description,
                switches_of=assembly.switches_of,
                strict=options.strict,
            )
            self._safety = SafetyWatch(self.board, assembly.safety, strict=options.strict)
        self.planning: Planning | None = None
        if assembly.planner is not None:
            self.planning = Planning(self.board, assembly.planner, assembly.parts(), strict=options.strict)
        self._track = believed_track(self.board)
        self._truth = Track()
        self._cycle = 0

    @property
    def duration_s(self) -> float:
        """How long the run will take on the mission's clock."""
        end_s = self.robot.end_s
        return self.mission.params.duration_s if end_s is None else end_s - self.robot.start_s

    def run(self, duration_s: float | None = None, progress: Progress | None = None) -> None:
        """Run for `duration_s` (to the mission's or the recording's end unless given), then let the sources finish."""
        total_s = self.duration_s if duration_s is None else min(duration_s, self.duration_s_limit)
        cycles = int(np.ceil(total_s / self.mission.params.step_s - 1e-9)) + 1
        for cycle in range(cycles):
            self.cycle()
            if progress is not None and cycle % 50 == 0:
                progress(cycle * self.mission.params.step_s, total_s)
            if self.over:
                break
        self.control.finish()
        if progress is not None:
            progress(total_s, total_s)

    @property
    def duration_s_limit(self) -> float:
        """How long the run can last at most: a recording's length, else no limit."""
        return float("inf") if self.robot.end_s is None else self.duration_s

    def cycle(self) -> None:
        """Run one control cycle."""
        board = self.board
        if self._cycle == 0:
            board.post(ROBOT, self.robot.description, source=self.robot.name)
        now_s = self.robot.start_s + self._cycle * self.mission.params.step_s
        self._cycle += 1
        for reading in self.robot.advance(now_s):
            board.now_s = max(board.now_s, reading.stamp_s)
            board.post(reading.kind, reading.value, source=self.robot.name, stamp_s=reading.stamp_s)
        board.now_s = max(board.now_s, now_s)
        true_pose = self.robot.true_pose()
        if true_pose is not None:
            self._truth.add(now_s, true_pose)
        if self._reflexes is not None and self._safety is not None:
            self.robot.drive(self._safety.limit(self._reflexes.respond()))
        self.control.run_cycle()
        if self.planning is not None:
            self.planning.decide()

    def states(self) -> dict[str, object]:
        """Return what has to outlive the run, by component, to be pickled at once."""
        modules = (self.control, self._reflexes, self._safety, self.planning)
        states: dict[str, object] = {self.robot.name: state_of(self.robot)}
        return states | {name: state for part in modules if part is not None for name, state in part.states().items()}

    def resume(self, board: Iterable[Entry[Any]], states: Mapping[str, object], now_s: float) -> None:
        """Go on in the place of a run that was lost at `now_s`: with the entries of its board, each component from its state."""
        self.board.load(board)
        self.board.now_s = now_s
        self._cycle = round((now_s - self.robot.start_s) / self.mission.params.step_s) + 1
        resume(self.robot, states, Access(self.board, self.robot.name, self.board.vocabulary, ()), self.board)
        for part in (self._safety, self._reflexes, self.control, self.planning):
            if part is not None:
                part.resume(states)

    @property
    def over(self) -> bool:
        """Say whether the mission has come to its end by its own word."""
        status = self.board.newest(MISSION)
        return status is not None and status.value.state != "underway"

    def close(self) -> None:
        """Let go of what robot and planner hold."""
        self.robot.close()
        if self.planning is not None:
            self.planning.close()

    def trajectory(self) -> npt.NDArray[np.float64]:
        """Return where the robot believed to be, (n, 4): stamp_s, x_m, y_m, heading_rad, map frame, each as of its time."""
        return self._track.rows()

    def true_trajectory(self) -> npt.NDArray[np.float64] | None:
        """Return where it really was, likewise; None where nobody knows."""
        return self._truth.rows() if len(self._truth) else None
