"""Coordinates by switches of adjustable gain and threshold, then by superposition of what they let through.

Reads  control/switch/<behaviour>              Switch   the behaviour's own
       control/switch/<behaviour>.<another>    Switch   put into its line by another behaviour
       control/switch/<level>                  Switch   that of its competence level
Posts  commands/velocity                       Velocity

Bou-Ghannam 1992, section 4.3, Figures 4.5 and 4.6: output = gain (response - threshold) where the response exceeds the
threshold, else nothing; gain 0 or 1 with threshold 0 is a binary switch. A response is a vector: its length passes the
switch and its direction stays; a turn on the spot passes by the gain. A behaviour that a switch silences inhibits nobody.
"""

from collections.abc import Mapping
from math import hypot

from behaviours.superposition import SuperpositionParams, superposition_velocity
from blackboard.access import Access
from blackboard.component import Coordinator
from blackboard.entry import Entry
from blackboard.kinds import SWITCH
from blackboard.messages.motion import Response, Switch, Velocity
from blackboard.messages.sensing import RobotDescription

LONGEST, FASTEST_RADPS = 1000.0, 100.0  # the limits of a response


def switch_output(response: Response, switch: Switch) -> Response | None:
    """Return gain (response - threshold); None where nothing passes."""
    gain, threshold = switch.gain, switch.threshold
    if gain == 1.0 and threshold == 0.0:
        return response
    length = hypot(response.forward, response.left)
    if gain == 0.0 or (0.0 < threshold >= length and response.turn_radps == 0.0):
        return None
    scale = min(gain * (length - threshold), LONGEST) / length if length > threshold else 0.0
    turn_radps = max(-FASTEST_RADPS, min(FASTEST_RADPS, gain * response.turn_radps))
    return Response(forward=scale * response.forward, left=scale * response.left, turn_radps=turn_radps)


def line_of(behaviour: str, switches: Mapping[str, Entry[Switch]]) -> list[Entry[Switch]]:
    """Return the switches between a behaviour and the sum: its own, what others put into its line, its level's."""
    own = switches.get(behaviour)
    if own is None:
        return []
    others = [entry for entry in switches.values() if entry.id == f"{behaviour}.{entry.source}"]
    level = switches.get(own.value.level)
    return [own, *others, *([level] if level is not None else [])]


class ArbitrationNetwork(Coordinator[SuperpositionParams]):
    """Passes each response through its switches and follows the sum."""

    Params = SuperpositionParams
    reads = (SWITCH,)

    def __init__(self, params: SuperpositionParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._last_turn = 0

    def switched(self, behaviour: str, response: Response, board: Access) -> Response | None:
        passed: Response | None = response
        for entry in line_of(behaviour, {e.id or "": e for e in board.entries(SWITCH)}):
            if entry.value.gain != 1.0 or entry.value.threshold != 0.0:
                board.newest(SWITCH, entry.id)  # the command stands on it too
                passed = switch_output(passed, entry.value) if passed is not None else None
        return passed

    def combine(self, responses: Mapping[str, Response], robot: RobotDescription, board: Access) -> Velocity:
        self._last_turn, velocity = superposition_velocity(responses, robot, board.now_s, self._last_turn, self.params)
        return velocity
