"""Looks around: turns once about itself while the sensors listen, and is done.

Reads  observations/signal/odometry     Odometry

A motivation may ask for another angle than a whole turn: with a ring of sonars a part of it shows all directions.

Bou-Ghannam 1992, section 6.1 (the start of an exploration, and at each target). The turn is measured on the odometry: the sum of
its changes. Where avoid-obstacles keeps turning the robot another way, curiosity gives up after a while.
"""

from dataclasses import dataclass
from math import pi

from blackboard.access import Access
from blackboard.component import Behaviour, Progress
from blackboard.errors import MissionError
from blackboard.kinds import ODOMETRY
from blackboard.messages.geometry import wrap_angle
from blackboard.messages.motion import Response
from blackboard.parameters import require

MOST_RAD = 20.0 * pi


@dataclass(frozen=True, slots=True, kw_only=True)
class CuriosityParams:
    """How far and how fast it turns."""

    angle_rad: float = 2.0 * pi
    rate_radps: float = 0.5  # 6 degrees a scan at 5 Hz: every direction comes under a cone of 12 degrees twice
    patience_s: float = 60.0  # gives up after this: several times what the whole turn takes

    def __post_init__(self) -> None:
        require(0.0 < self.angle_rad <= MOST_RAD, "angle_rad", self.angle_rad, "(0, 20 pi]")
        require(0.05 <= abs(self.rate_radps) <= 3.0, "rate_radps", self.rate_radps, "+/- [0.05, 3]")
        require(1.0 <= self.patience_s <= 3600.0, "patience_s", self.patience_s, "[1, 3600]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Spin:
    """How far it has turned so far, counted in the direction of the spin, and the heading at the last reading."""

    turned_rad: float = 0.0
    heading_rad: float | None = None
    until_s: float | None = None  # when it gives up
    done: bool = False


def curiosity_response(
    spin: Spin, heading_rad: float, now_s: float, params: CuriosityParams, angle_rad: float | None = None
) -> tuple[Spin, Response | None]:
    """Return the spin with this reading added, and a turn on the spot; None once it is done.

    `angle_rad` is how far it turns, that of the parameters unless given; it is as patient as the angle is large.
    """
    wanted_rad = params.angle_rad if angle_rad is None else angle_rad
    turned_rad = spin.turned_rad
    if spin.heading_rad is not None:
        change_rad = wrap_angle(heading_rad - spin.heading_rad)
        turned_rad += change_rad if params.rate_radps > 0 else -change_rad
    until_s = spin.until_s if spin.until_s is not None else now_s + params.patience_s * wanted_rad / params.angle_rad
    done = spin.done or turned_rad >= wanted_rad or now_s >= until_s
    spin = Spin(turned_rad=turned_rad, heading_rad=heading_rad, until_s=until_s, done=done)
    return spin, None if done else Response(turn_radps=params.rate_radps)


class Curiosity(Behaviour[CuriosityParams]):
    """Turns once about itself."""

    Params = CuriosityParams
    reads = (ODOMETRY,)
    parameters = ("angle_rad",)
    optional = 1

    def __init__(self, params: CuriosityParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._spin = Spin()
        self._angle_rad = params.angle_rad

    def select(self, parameters: tuple[float | str, ...]) -> None:
        angle_rad = parameters[0] if parameters else self.params.angle_rad
        if not isinstance(angle_rad, float) or not 0.0 < angle_rad <= MOST_RAD:
            raise MissionError(f"{self.name}: angle_rad = {angle_rad!r} is outside (0, 20 pi]")
        self._angle_rad = angle_rad
        self._spin = Spin()

    def progress(self) -> Progress:
        return Progress("reached" if self._spin.done else "underway")

    def respond(self, board: Access) -> Response | None:
        odometry = board.newest(ODOMETRY)
        if odometry is None:
            return None
        self._spin, response = curiosity_response(
            self._spin, odometry.value.pose.heading_rad, board.now_s, self.params, self._angle_rad
        )
        return response

    def done(self) -> bool:
        return self._spin.done
