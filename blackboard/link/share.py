"""What a host runs on one robot's board: its replica, the stages that were placed there, and what they keep."""

from pathlib import Path
from queue import SimpleQueue

from blackboard.assembly import Assembly
from blackboard.link.kept_states import KeptStates
from blackboard.link.lanes import Lane
from blackboard.link.replica import Item, Replica
from blackboard.link.session import Session
from blackboard.link.stages import Stages
from blackboard.placement import HostPlan


class Share:
    """One robot's part of a host; what comes for it stands in the queue that it is given."""

    def __init__(
        self,
        session: Session,
        assembly: Assembly,
        plan: HostPlan,
        queue: "SimpleQueue[Item]",
        *,
        seed: int = 0,
        state: Path | None = None,
        strict: bool = False,
    ) -> None:
        self.robot = assembly.robot
        newest: tuple[Lane, ...] = ("signal",) if plan.behaviours or plan.robot else ()
        self.replica = Replica(
            session,
            assembly.vocabulary,
            assembly.robot.description.name,
            plan.name,
            state=state,
            history=assembly.mission.history,
            newest=newest,
            queue=queue,
        )
        self.stages = Stages(self.replica.board, assembly, plan, strict=strict)
        self._kept = KeptStates(
            state, assembly.mission, seed, self.replica.boot, self.replica.board, self.replica.clock
        )

    def join(self, pace: float, begin_s: float | None = None, *, timeout_s: float) -> None:
        """Join the board, and go on from what was kept; raise LinkError where no keeper answers within `timeout_s`.

        Where nobody has begun the robot's clock it begins at `begin_s` (a world that runs already), else where the robot starts.
        """
        replica, robot = self.replica, self.stages.robot
        if robot is not None:
            replica.join(begin_s=self.robot.start_s if begin_s is None else begin_s, pace=pace, timeout_s=timeout_s)
        else:
            replica.join(pace=pace, timeout_s=timeout_s)
        replica.board.now_s = max(replica.board.now_s, replica.now_s())
        self.stages.resume(self._kept.restored())
        if robot is not None:
            robot.begin(replica.now_s())

    def beat(self, machine: str, version: str, *, leaving: bool = False) -> None:
        """Tell that the loop goes round, and mend what was lost on the way."""
        self.replica.beat(self.stages.components, machine, version, leaving=leaving)
        if not leaving:
            self.replica.tend()

    @property
    def until_due_s(self) -> float:
        """How long nothing is due here but what comes, in seconds of this machine."""
        if not self.replica.clock.running:
            return float("inf")
        return max(0.0, (self.stages.next_s - self.replica.now_s()) / self.replica.clock.pace)

    def work(self) -> bool:
        """Do what is due, one cycle of the robot at most; say whether something is left that should go on at once."""
        board, now_s = self.replica.board, self.replica.now_s()
        behind = self._cycle(now_s)
        if not behind:
            board.now_s = max(board.now_s, now_s)
        more = self.stages.work()
        self._kept.keep(board.now_s, self.stages)
        return more or behind

    def _cycle(self, now_s: float) -> bool:
        """Run the robot's cycle if one is due; say whether another is."""
        robot = self.stages.robot
        if robot is None or not self.replica.clock.running or robot.next_s > now_s:
            return False
        robot.cycle()
        if self.stages.behaviours is not None:
            self.stages.behaviours.answer()
            robot.obey()
        self._kept.keep_robot(self.replica.board.now_s, robot)
        return robot.next_s <= now_s

    def close(self) -> None:
        """Let go of outbox and robot."""
        self.replica.close()
        self.robot.close()
