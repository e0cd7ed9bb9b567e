"""The robots whose boards are kept: brought back from the folder, or opened when somebody posts something fit for one."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

from blackboard.errors import MessageError, SkiError
from blackboard.keeper.board_folder import robots_in
from blackboard.keeper.checking import Checker, Refusals, Refused
from blackboard.keeper.clocks import Clocks
from blackboard.keeper.params import KeeperParams
from blackboard.keeper.robot_desk import RobotDesk
from blackboard.key_expressions import is_chunk
from blackboard.link.envelope import read_origin
from blackboard.link.session import Arrived

Tell = Callable[[str], None]


class Desks:
    """A desk for each robot. What belongs to none of them is counted in `refusals` and told."""

    def __init__(
        self, folder: Path, checker: Checker, params: KeeperParams, clocks: Clocks, boot: str, tell: Tell
    ) -> None:
        self.refusals = Refusals()
        self._folder = folder
        self._checker = checker
        self._params = params
        self._clocks = clocks
        self._boot = boot
        self._tell = tell
        self._desks: dict[str, RobotDesk] = {}
        for robot in robots_in(folder):
            clocks.ask(robot)
            self._open(robot)

    def __iter__(self) -> Iterator[RobotDesk]:
        return iter(list(self._desks.values()))

    def find(self, robot: str) -> RobotDesk | None:
        """Return a robot's desk; None where there is none."""
        return self._desks.get(robot)

    def opened(self, robot: str) -> RobotDesk | None:
        """Return a robot's desk, opened where there is none yet; None where there are too many robots."""
        desk = self._desks.get(robot)
        if desk is not None:
            return desk
        if not is_chunk(robot) or len(self._desks) >= self._params.robots:
            self.refuse("robots", f"'{robot}' would be one robot more than {self._params.robots}, or is no name")
            return None
        try:
            return self._open(robot)
        except SkiError as error:
            self.refuse("folder", str(error))
            return None

    def opened_for(self, robot: str, arrived: list[Arrived]) -> RobotDesk | None:
        """Return the desk of a robot for which something came; a new one only where something is fit to stand on a board."""
        desk = self._desks.get(robot)
        if desk is not None:
            return desk
        for message in arrived:
            try:
                self._checker.check(message.key, message.payload, read_origin(message.attachment))
            except Refused as refused:
                self.refuse(refused.reason, str(refused))
            except MessageError as error:
                self.refuse("attachment", f"{message.key}: {error}")
            else:
                return self.opened(robot)
        return None

    def opened_for_host(self, key: str, boot: str) -> RobotDesk | None:
        """Return the desk that a host's beat or token is for; None where the key or the boot is malformed."""
        chunks = key.split("/")
        if len(chunks) < 5 or not is_chunk(chunks[3]) or not is_chunk(boot):
            self.refuse("host", f"{key}: host and boot must be names, not {boot[:80]!r}")
            return None
        desk = self.opened(chunks[1])
        if desk is not None and not desk.hosts.takes(chunks[3]):
            self.refuse("host", f"{key}: more hosts than anybody has")
            return None
        return desk

    def refuse(self, reason: str, text: str) -> None:
        """Count what belongs to no board, and tell it once for each reason."""
        said = self.refusals.note(reason, text, "?")
        if said is not None:
            self._tell(said)

    def _open(self, robot: str) -> RobotDesk:
        desk = self._desks[robot] = RobotDesk(
            robot,
            self._folder / robot,
            self._checker,
            self._params,
            lambda: self._clocks.now_s(robot),
            self._boot,
            time.monotonic(),
        )
        return desk
