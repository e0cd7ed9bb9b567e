"""Coordinates by superposition: the responses are summed into one vector, and the robot turns towards it while it goes.

Posts  commands/velocity                Velocity

Bou-Ghannam 1992, section 4.3: the outputs of the behaviours that are not inhibited are superimposed; avoid-obstacles
outweighs the others near an obstacle by the length of its vector.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import atan2, cos, hypot, pi

from blackboard.access import Access
from blackboard.component import Coordinator
from blackboard.messages.motion import Response, Velocity
from blackboard.messages.sensing import RobotDescription
from blackboard.parameters import require

STALEMATE = 0.5  # a vector longer than this does not come to nothing by chance


@dataclass(frozen=True, slots=True, kw_only=True)
class SuperpositionParams:
    """How a vector becomes speeds."""

    cruise_mps: float = 0.4  # full speed; slow enough for a sonar ring at 5 Hz
    turn_radps: float = (
        0.8  # fastest turn: 9 degrees a scan at 5 Hz, so that no direction is skipped by cones of 12 degrees
    )
    turn_gain_per_s: float = 2.0  # turn rate for each radian to the vector
    weave_rad: float = (
        0.2  # swings its heading so far to either side on the way, so that cones sweep the gaps between them
    )
    weave_period_s: float = 3.0  # a thing in a gap is heard at the latest after half of this: 0.6 m on
    silence: float = 0.1  # a shorter sum means: go nowhere
    about_rad: float = 2.6  # a vector further behind than this keeps the side of the turn that has begun
    valid_for_s: float = 0.5  # five control cycles

    def __post_init__(self) -> None:
        require(0.01 <= self.cruise_mps <= 5.0, "cruise_mps", self.cruise_mps, "[0.01, 5]")
        require(0.05 <= self.turn_radps <= 5.0, "turn_radps", self.turn_radps, "[0.05, 5]")
        require(0.1 <= self.turn_gain_per_s <= 20.0, "turn_gain_per_s", self.turn_gain_per_s, "[0.1, 20]")
        require(0.0 <= self.weave_rad <= 0.5, "weave_rad", self.weave_rad, "[0, 0.5]")
        require(1.0 <= self.weave_period_s <= 60.0, "weave_period_s", self.weave_period_s, "[1, 60]")
        require(0.0 <= self.silence <= 0.5, "silence", self.silence, "[0, 0.5]")
        require(pi / 2 <= self.about_rad <= pi, "about_rad", self.about_rad, "[pi/2, pi]")
        require(0.05 <= self.valid_for_s <= 1.0, "valid_for_s", self.valid_for_s, "[0.05, 1]")


def summed(responses: Mapping[str, Response]) -> Response:
    """Return the sum of the responses' vectors and turns."""
    forward, left, turn_radps = 0.0, 0.0, 0.0
    for response in responses.values():
        forward += response.forward
        left += response.left
        turn_radps += response.turn_radps
    return Response(forward=forward, left=left, turn_radps=turn_radps)


def superposition_velocity(
    responses: Mapping[str, Response],
    robot: RobotDescription,
    now_s: float,
    last_turn: int,
    params: SuperpositionParams,
) -> tuple[int, Velocity]:
    """Return the speeds, and the side that it turns to (1 left, -1 right, 0 neither), to be passed in next time.

    Where strong vectors cancel each other the robot turns on the spot, to the side that it turned to last.
    """
    total = summed(responses)
    length = hypot(total.forward, total.left)
    fastest_radps = min(params.turn_radps, robot.max_turn_radps)
    cruise_mps = min(params.cruise_mps, robot.max_speed_mps)
    forward_mps, turn_radps, side = 0.0, total.turn_radps, 0
    if length > params.silence:
        bearing_rad = atan2(total.left, total.forward)
        if abs(bearing_rad) > params.about_rad and last_turn * bearing_rad < 0:
            bearing_rad += 2.0 * pi * last_turn
        side = 1 if bearing_rad > 0 else -1
        forward_mps = cruise_mps * min(1.0, length) * max(0.0, cos(bearing_rad))
        turn_radps += params.turn_gain_per_s * bearing_rad * min(1.0, length)
        swing_per_s = 2.0 * pi / params.weave_period_s
        turn_radps += forward_mps / cruise_mps * params.weave_rad * swing_per_s * cos(swing_per_s * now_s)
    elif max((hypot(r.forward, r.left) for r in responses.values()), default=0.0) > STALEMATE:
        side = last_turn or 1
        turn_radps += 0.5 * fastest_radps * side
    turn_radps = max(-fastest_radps, min(fastest_radps, turn_radps))
    return side, Velocity(forward_mps=forward_mps, turn_radps=turn_radps, valid_until_s=now_s + params.valid_for_s)


class Superposition(Coordinator[SuperpositionParams]):
    """Sums the responses and follows the sum."""

    Params = SuperpositionParams

    def __init__(self, params: SuperpositionParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._last_turn = 0

    def combine(self, responses: Mapping[str, Response], robot: RobotDescription, board: Access) -> Velocity:
        self._last_turn, velocity = superposition_velocity(responses, robot, board.now_s, self._last_turn, self.params)
        return velocity
