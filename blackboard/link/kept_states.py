"""The checkpoints of a host: of its robot every cycle, since the world does not wait, and of the rest every second."""

import sys
from collections.abc import Mapping
from pathlib import Path

from blackboard.board import Board
from blackboard.checkpoint import SUFFIX, Checkpoint, Checkpointer, mission_identity, packages_of, read_checkpoint
from blackboard.errors import CheckpointError
from blackboard.link.clock import MissionClock
from blackboard.link.robot_stage import RobotStage
from blackboard.link.stages import Stages
from blackboard.mission import Mission
from blackboard.resumption import show_anew

SAME_RUN_S = 0.1  # the keeper tells when the clock began to the microsecond, after a restart too
EVERY_S = 1.0  # on the mission's clock


class KeptStates:
    """What the components of one host must remember, in `folder`; without one nothing is kept."""

    def __init__(
        self, folder: Path | None, mission: Mission, seed: int, boot: str, board: Board, clock: MissionClock
    ) -> None:
        self._board = board
        self._clock = clock
        self._identity = identity = mission_identity(mission, seed)
        self._packages = packages_of(mission)
        self._paths: dict[str, Path] = {}
        self._writers: dict[str, Checkpointer] = {}
        self._said: set[str] = set()
        if folder is not None:
            for name, every_s in (("robot", 0.0), ("components", EVERY_S)):
                self._paths[name] = folder / f"{name}{SUFFIX}"
                self._writers[name] = Checkpointer(self._paths[name], identity, boot=boot, every_s=every_s)

    def restored(self) -> Mapping[str, object]:
        """Return what was kept before, by component; what cannot be used is told and left."""
        states: dict[str, object] = {}
        for path in self._paths.values():
            try:
                checkpoint = read_checkpoint(path, self._identity)
                if checkpoint is not None and not self._is_of_this_run(checkpoint):
                    raise CheckpointError(f"{path}: of another run of this mission; its components begin anew")
            except CheckpointError as error:
                sys.stderr.write(f"ski: {error}\n")
                continue
            if checkpoint is not None:
                found, lost = checkpoint.states(self._board.vocabulary, self._packages)
                states |= found
                for name, why in lost.items():
                    sys.stderr.write(f"ski: {name} begins anew: {why}\n")
        return states

    def _is_of_this_run(self, checkpoint: Checkpoint) -> bool:
        began_s = self._clock.began_wall_s
        return began_s is not None and checkpoint.run_s is not None and abs(checkpoint.run_s - began_s) < SAME_RUN_S

    def keep_robot(self, now_s: float, robot: RobotStage) -> None:
        """Write down where the robot and its world stand."""
        writer = self._writers.get("robot")
        if writer is not None:
            self._write(writer, now_s, robot.states())

    def keep(self, now_s: float, stages: Stages) -> None:
        """Write down the states of the other components, if it is time."""
        writer = self._writers.get("components")
        if writer is not None and (writer.is_due(now_s) or stages.acted):
            self._write(writer, now_s, stages.states())

    def _write(self, writer: Checkpointer, now_s: float, states: Mapping[str, object]) -> None:
        """Write, and say what cannot be kept; a full disk stops nobody, and is said once."""
        try:
            for name, why in writer.write(now_s, states, self._clock.began_wall_s).items():
                show_anew(self._board, name, why)
        except CheckpointError as error:
            if str(error) not in self._said:
                self._said.add(str(error))
                sys.stderr.write(f"ski: {error}\n")
