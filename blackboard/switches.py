"""The switches of the arbitration network on the board: as the mission wires them, and as behaviours adjust each other's.

Posts  control/switch/<behaviour or level>     Switch   once, as wired; rules set it from then on
       control/switch/<behaviour>.<another>    Switch   while that other behaviour wants it: a second switch in the same line
"""

from collections.abc import Mapping

from blackboard.board import Board
from blackboard.entry import Support
from blackboard.errors import MissionError, did_you_mean
from blackboard.kinds import SWITCH
from blackboard.messages.motion import Switch
from blackboard.mission import Wiring


class Switches:
    """The switches between behaviours and coordinator; what the mission wires belongs to `owner`, who may set it."""

    def __init__(self, board: Board, owner: str) -> None:
        self._board = board
        self._owner = owner
        self._behaviours: tuple[str, ...] = ()
        self._resumed = False
        self._adjusted: dict[str, dict[str, Switch]] = {}  # by who adjusts, then by whose line it is in

    def wire(self, wirings: Mapping[str, Wiring]) -> None:
        """Put a switch on the board for each behaviour and for each level."""
        self._behaviours = tuple(wirings)
        for behaviour, wiring in wirings.items():
            self._wire(behaviour, Switch(gain=wiring.gain, threshold=wiring.threshold, level=wiring.level))
        for level in dict.fromkeys(wiring.level for wiring in wirings.values() if wiring.level):
            self._wire(level, Switch())

    def resume(self) -> None:
        """Go on after a restart with the switches as they stand: those wired, and those that behaviours put in."""
        self._resumed = True
        for entry in self._board.entries(SWITCH):
            behaviour, dot, by = str(entry.id).rpartition(".")
            if dot and by == entry.source:
                self._adjusted.setdefault(by, {})[behaviour] = entry.value

    def _wire(self, name: str, switch: Switch) -> None:
        if not self._resumed or self._board.newest(SWITCH, name) is None:
            self._board.post(SWITCH, switch, id=name, source=self._owner)

    def adjust(self, by: str, wanted: Mapping[str, Switch], supports: tuple[Support, ...]) -> None:
        """Let the behaviour `by` have just these switches in the lines of others, by their names; raise MissionError for others."""
        held = self._adjusted.get(by)
        if not held and not wanted:
            return
        for behaviour in wanted:
            if behaviour not in self._behaviours:
                hint = did_you_mean(behaviour, self._behaviours)
                raise MissionError(f"{by} adjusts the switch of '{behaviour}', which this mission does not have{hint}")
        held = held or {}
        for behaviour, switch in wanted.items():
            if held.get(behaviour) != switch:
                self._board.post(SWITCH, switch, id=f"{behaviour}.{by}", source=by, supports=supports)
        for behaviour in held:
            if behaviour not in wanted:
                self._board.retract(SWITCH, f"{behaviour}.{by}", source=by)
        self._adjusted[by] = dict(wanted)
