"""The robot's stage of a host: the robot in cycles of the mission's clock, and the safety layer with it.

Readings go out, and what comes in as a wanted velocity goes through the layer before it reaches the wheels. A velocity is good for
a few cycles only; then the robot stands.

Posts  status/robot, status/robot_summary, status/true_pose    RobotDescription, RobotSummary, Pose
       observations/signal/...                                 the robot's readings
       observations/signal/cycle                               CycleBeat
       commands/drive                                          Drive
"""

from collections.abc import Mapping
from typing import Any

from msgspec import json

from blackboard.access import Access
from blackboard.assembly import Assembly
from blackboard.board import Board
from blackboard.component import Robot
from blackboard.entry import Entry
from blackboard.kinds import CYCLE, DRIVE, MAP_FROM_ODOM, ROBOT, ROBOT_SUMMARY, TRUE_POSE, VELOCITY
from blackboard.link.mission_end import ends, mission_over
from blackboard.messages.hosts import CycleBeat, RobotSummary
from blackboard.messages.motion import Drive, Velocity
from blackboard.resumption import resume, state_of
from blackboard.safety_watch import SafetyWatch

COMMAND_GOOD_S = (
    0.35  # three cycles and a little: the wheels are told to stand within half a second of the last command
)
SUMMARY_S = 1.0


class RobotStage:
    """The robot and its safety layer, in cycles of the mission's clock."""

    def __init__(self, board: Board, assembly: Assembly, *, strict: bool = False) -> None:
        self.board = board
        self.robot: Robot[Any] = assembly.robot
        self.step_s = assembly.mission.params.step_s
        self._ends = ends(assembly)
        self._safety = (
            SafetyWatch(board, assembly.safety, strict=strict) if assembly.safety and assembly.robot.moves else None
        )
        self._cycle = 0
        self._told_s = float("-inf")
        self._velocity: Entry[Velocity] | None = None

    def states(self) -> dict[str, object]:
        """Return what has to outlive the process: above all where a simulated world stands."""
        return {self.robot.name: state_of(self.robot), **(self._safety.states() if self._safety is not None else {})}

    def resume(self, states: Mapping[str, object]) -> None:
        """Go on after a restart, the wheels standing."""
        resume(
            self.robot,
            states,
            Access(self.board, self.robot.name, (*self.robot.provides, MAP_FROM_ODOM), ()),
            self.board,
        )
        if self._safety is not None:
            self._safety.resume(states)

    def begin(self, now_s: float) -> None:
        """Show the robot; its cycles go on from `now_s`, before which the world stood still or went on without commands."""
        standing = self.board.newest(ROBOT)
        if standing is None or standing.value != self.robot.description:
            self.board.post(ROBOT, self.robot.description, source=self.robot.name)
        self._cycle = max(0, round((now_s - self.robot.start_s) / self.step_s))

    @property
    def next_s(self) -> float:
        """When the next cycle is due, on the mission's clock."""
        return self.robot.start_s + self._cycle * self.step_s

    def cycle(self) -> None:
        """Run the cycle that is due: readings come, the safety layer looks again, the wheels obey."""
        board = self.board
        now_s = self.next_s
        self._cycle += 1
        if self._ends and mission_over(board):
            self.robot.drive(_stand())
            return
        source = self.robot.name
        for reading in self.robot.advance(now_s):
            board.now_s = max(board.now_s, reading.stamp_s)
            board.post(reading.kind, reading.value, source=source, stamp_s=reading.stamp_s)
        board.now_s = max(board.now_s, now_s)
        true_pose = self.robot.true_pose()
        if true_pose is not None:
            board.post(TRUE_POSE, true_pose, source=source)
        if now_s - self._told_s >= SUMMARY_S:
            self._told_s = now_s
            self.tell_summary()
        board.post(CYCLE, CycleBeat(number=self._cycle), source=source)
        self.obey()

    def tell_summary(self) -> None:
        """Post the robot's own figures."""
        figures = json.encode(self.robot.summary()).decode()
        standing = self.board.newest(ROBOT_SUMMARY)
        if standing is None or standing.value.figures != figures:
            self.board.post(ROBOT_SUMMARY, RobotSummary(figures=figures), source=self.robot.name)

    def obey(self) -> None:
        """Let the newest wanted velocity through the safety layer to the wheels, while it is good."""
        if self._safety is None:
            return
        wanted = self._velocity = self.board.newest(VELOCITY)
        if wanted is not None and self.board.now_s - wanted.stamp_s > COMMAND_GOOD_S:
            wanted = None
        self.robot.drive(self._safety.limit(wanted))

    @property
    def commanded_anew(self) -> bool:
        """Say whether a velocity has come since it last obeyed."""
        return self.board.newest(VELOCITY) is not self._velocity

    def stop(self) -> None:
        """Stand still, and say so."""
        self.robot.drive(_stand())
        if self._safety is not None and self.board.newest(DRIVE) is not None:
            self.board.post(DRIVE, _stand(), source="safety")
        self.tell_summary()


def _stand() -> Drive:
    return Drive(forward_mps=0.0, turn_radps=0.0, limited_by="no command")
