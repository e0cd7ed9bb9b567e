"""What one host process runs of a mission: the same stages as in an embedded run, each where it was placed."""

from collections.abc import Mapping

from blackboard.assembly import Assembly
from blackboard.board import Board
from blackboard.control import Control
from blackboard.link.behaviour_stage import BehaviourStage
from blackboard.link.robot_stage import RobotStage
from blackboard.link.rules_stage import RulesStage
from blackboard.placement import HostPlan


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
            RulesStage(board, assembly, assembly.planner, strict=strict)
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
