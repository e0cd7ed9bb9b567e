"""Leads the robot at random: a random heading, held for a while.

Reads  observations/signal/odometry     Odometry

Bou-Ghannam 1992, section 4.2.2. Together with avoid-obstacles: wander at random without bumping into things; also a way
out of traps.
"""

from dataclasses import dataclass
from math import cos, pi, sin

from numpy.random import Generator

from blackboard.access import Access
from blackboard.component import Behaviour
from blackboard.kinds import ODOMETRY
from blackboard.messages.geometry import wrap_angle
from blackboard.messages.motion import Response
from blackboard.parameters import require


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomWanderParams:
    """How far a new heading may lie from the present one, and how long it is held."""

    widest_turn_rad: float = pi  # the thesis's heading is any
    hold_min_s: float = 4.0  # long enough to turn about and go a metre
    hold_max_s: float = 10.0  # crosses a room of a few metres
    strength: float = 0.8  # of full speed, so that avoiding outweighs it earlier than the other behaviours

    def __post_init__(self) -> None:
        require(0.0 < self.widest_turn_rad <= pi, "widest_turn_rad", self.widest_turn_rad, "(0, pi]")
        require(0.5 <= self.hold_min_s <= 600.0, "hold_min_s", self.hold_min_s, "[0.5, 600]")
        require(self.hold_min_s <= self.hold_max_s <= 600.0, "hold_max_s", self.hold_max_s, "[hold_min_s, 600]")
        require(0.0 < self.strength <= 1.0, "strength", self.strength, "(0, 1]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Heading:
    """A heading in the odometry frame, and until when it is held."""

    heading_rad: float
    until_s: float


def random_wander_response(
    held: Heading | None, heading_rad: float, now_s: float, rng: Generator, params: RandomWanderParams
) -> tuple[Heading, Response]:
    """Return the heading held from now on, and the response towards it; `heading_rad` is the robot's own."""
    if held is None or now_s >= held.until_s:
        turn_rad = float(rng.uniform(-params.widest_turn_rad, params.widest_turn_rad))
        hold_s = float(rng.uniform(params.hold_min_s, params.hold_max_s))
        held = Heading(heading_rad=wrap_angle(heading_rad + turn_rad), until_s=now_s + hold_s)
    bearing_rad = held.heading_rad - heading_rad
    return held, Response(forward=params.strength * cos(bearing_rad), left=params.strength * sin(bearing_rad))


class RandomWander(Behaviour[RandomWanderParams]):
    """Goes one random way after another."""

    Params = RandomWanderParams
    reads = (ODOMETRY,)

    def __init__(self, params: RandomWanderParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._held: Heading | None = None

    def select(self, parameters: tuple[float | str, ...]) -> None:
        self._held = None

    def respond(self, board: Access) -> Response | None:
        odometry = board.newest(ODOMETRY)
        if odometry is None:
            return None
        heading_rad = odometry.value.pose.heading_rad
        self._held, response = random_wander_response(self._held, heading_rad, board.now_s, self.rng, self.params)
        return response
