"""What one host process runs of a mission, stage by stage: the same stages as in an embedded run, each where it was placed.

The robot's stage has the safety layer with it: readings go out, and what comes in as a wanted velocity goes through the layer
before it reaches the wheels. A velocity is good for a few cycles only; then the robot stands.
"""

from collections.abc import Mapping
from typing import Any

from msgspec import json

from blackboard.access import Access
from blackboard.assembly import Assembly
from blackboard.board import Board
from blackboard.component import Robot
from blackboard.control import Control
from blackboard.entry import Entry
from blackboard.kinds import CYCLE, DRIVE, MAP_FROM_ODOM, MISSION, ROBOT, ROBOT_SUMMARY, TRUE_POSE, VELOCITY
from blackboard.messages.hosts import CycleBeat, RobotSummary
from blackboard.messages.motion import Drive, Velocity
from blackboard.placement import HostPlan
from blackboard.planning import Planning
from blackboard.reflexes import Reflexes
from blackboard.resumption import resume, state_of
from blackboard.safety_watch import SafetyWatch

COMMAND_GOOD_S = 0.35  # three cycles and a little: the robot stands within half a second of the last command
SUMMARY_S = 1.0


def mission_over(board: Board) -> bool:
    """Say whether the mission has come to its end by its own word."""
    status = board.newest(MISSION)
    return status is not None and status.value.state != "underway"


def _ends(assembly: Assembly) -> bool:
    """Say whether everything stands still when the robot's mission is over: one of several robots keeps out of the others' way."""
    return not assembly.mission.robot.of


class RobotStage:
    """The robot and its safety layer, in cycles of the mission's clock."""

    def __init__(self, board: Board, assembly: Assembly, *, strict: bool = False) -> None:
        self.board = board
        self.robot: Robot[Any] = assembly.robot
        self.step_s = assembly.mission.params.step_s
        self._ends = _ends(assembly)
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


class BehaviourStage:
    """Behaviours and coordinator: they answer each cycle of the robot, and by their own clock where none comes."""

    def __init__(self, board: Board, assembly: Assembly, *, strict: bool = False) -> None:
        self.board = board
        self._reflexes = Reflexes(
            board,
            assembly.behaviours,
            assembly.coordinator,
            assembly.robot.description,
            switches_of=assembly.switches_of,
            strict=strict,
        )
        self._step_s = assembly.mission.params.step_s
        self._ends = _ends(assembly)
        self._answered: Entry[CycleBeat] | None = None
        self._answered_s = float("-inf")

    def states(self) -> dict[str, object]:
        """Return what has to outlive the process."""
        return self._reflexes.states()

    def resume(self, states: Mapping[str, object]) -> None:
        """Take up the motivations that stand, where this host ran before."""
        self._reflexes.resume(states)

    @property
    def next_s(self) -> float:
        """When it answers by itself."""
        return self._answered_s + 2.5 * self._step_s

    def due(self) -> bool:
        """Say whether a cycle of the robot waits for an answer, or should have come long ago."""
        return self.board.newest(CYCLE) is not self._answered or self.board.now_s >= self.next_s

    def answer(self) -> None:
        """Answer the newest readings."""
        self._answered = self.board.newest(CYCLE)
        self._answered_s = self.board.now_s
        if self._ends and mission_over(self.board):
            return
        standing = self.board.newest(VELOCITY)
        wanted = self._reflexes.respond()
        if wanted is None and standing is not None:
            self.board.retract(VELOCITY, source=standing.source)


class Stages:
    """The stages of one host on its replica."""

    def __init__(self, board: Board, assembly: Assembly, plan: HostPlan, *, strict: bool = False) -> None:
        self.board = board
        self.plan = plan
        self.robot = RobotStage(board, assembly, strict=strict) if plan.robot else None
        self.behaviours = BehaviourStage(board, assembly, strict=strict) if plan.behaviours else None
        sources = [source for source in assembly.sources if source.name in plan.sources]
        self.control = Control(board, sources, assembly.mission.control, strict=strict) if sources else None
        self.planning = (
            Planning(board, assembly.planner, assembly.parts(), strict=strict)
            if plan.rules and assembly.planner is not None
            else None
        )
        names = [source.name for source in sources]
        self.components = [
            *([assembly.robot.name, "safety"] if plan.robot else []),
            *((b.name for b, _ in assembly.behaviours) if plan.behaviours else []),
            *names,
            *([assembly.planner.name] if self.planning is not None and assembly.planner is not None else []),
        ]

    def states(self) -> dict[str, object]:
        """Return what has to outlive the process, by component; the robot is asked for its own more often."""
        states: dict[str, object] = {}
        for stage in (self.behaviours, self.control, self.planning):
            if stage is not None:
                states |= stage.states()
        return states

    def resume(self, states: Mapping[str, object]) -> None:
        """Go on from what a process before this one kept, on the board as it stands."""
        for stage in (self.robot, self.behaviours, self.control, self.planning):
            if stage is not None:
                stage.resume(states)

    @property
    def acted(self) -> bool:
        """Say whether something was done that should be kept at once."""
        return self.planning is not None and self.planning.acted

    def work(self) -> bool:
        """Do what is due now; say whether something is left that should go on at once."""
        if self.behaviours is not None and self.behaviours.due():
            self.behaviours.answer()
        if self.robot is not None and self.robot.commanded_anew:
            self.robot.obey()
        if self.control is not None and self.control.waiting:
            self.control.run_cycle()
        if self.planning is not None:
            self.planning.decide()
        return self.control is not None and self.control.waiting > 0

    @property
    def next_s(self) -> float:
        """When something is due by the mission's clock, if nothing comes before."""
        due = [stage.next_s for stage in (self.robot, self.behaviours) if stage is not None]
        if self.planning is not None:
            due.append(self.board.now_s + 0.1)  # the planner's clock and patience
        return min(due, default=float("inf"))

    def finish(self) -> None:
        """End: wheels stand, sources post what they hold back, the planner lets go."""
        if self.robot is not None:
            self.robot.stop()
        if self.control is not None:
            self.control.finish()
        if self.planning is not None:
            self.planning.close()


def _stand() -> Drive:
    return Drive(forward_mps=0.0, turn_radps=0.0, limited_by="no command")
