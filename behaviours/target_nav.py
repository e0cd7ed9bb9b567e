"""Draws the robot towards a target: a vector from where it is to where it should be.

Motivated by  x_m, y_m                               the target, map frame
Reads  motivations/motivation/<its name>             Motivation
       hypotheses/feature/map_from_odom              Pose
       observations/feature/odom_from_robot          Pose

Bou-Ghannam 1992, section 4.2.4: V = (xt - xr) i + (yt - yr) j, normalised, with a maximum amplitude at which avoid-obstacles
outweighs it near an obstacle; it decreases near the target, which is reached below a threshold. It plans no way: some
places trap it, and then it says that it is blocked.
"""

from dataclasses import dataclass, replace
from math import atan2, cos, hypot, inf, sin

from behaviours.asked import numbers
from behaviours.whereabouts import POSE_READS, map_from_robot
from blackboard.access import Access
from blackboard.component import Behaviour, Progress
from blackboard.messages.geometry import Pose
from blackboard.messages.motion import Response
from blackboard.parameters import require

LONGEST_STEP_S = 0.5  # time in which it was silenced does not count as time without progress
SHORTEST = 0.3  # of the amplitude: near the target the robot still moves


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetNavParams:
    """How strongly it is drawn, when it has arrived, and when it is blocked."""

    amplitude: float = 0.8  # of full speed: avoid-obstacles answers one echo at its balance distance with 1
    slow_m: float = 0.5  # within this of the target the vector gets shorter
    reached_m: float = 0.2  # about as well as the pose is known, and inside the robot's own radius
    nearer_m: float = 0.25  # so much nearer than ever before is progress
    patience_s: float = 30.0  # without progress for so long it is blocked: twice what going round a chair takes

    def __post_init__(self) -> None:
        require(0.4 <= self.amplitude < 1.0, "amplitude", self.amplitude, "[0.4, 1)")
        require(0.01 <= self.slow_m <= 10.0, "slow_m", self.slow_m, "[0.01, 10]")
        require(0.02 <= self.reached_m <= 5.0, "reached_m", self.reached_m, "[0.02, 5]")
        require(0.05 <= self.nearer_m <= 10.0, "nearer_m", self.nearer_m, "[0.05, 10]")
        require(1.0 <= self.patience_s <= 3600.0, "patience_s", self.patience_s, "[1, 3600]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Approach:
    """How the way to a target goes: the nearest that it came, and for how long it came no nearer."""

    nearest_m: float = inf
    waited_s: float = 0.0
    asked_s: float | None = None  # when it was last asked
    remaining_m: float | None = None
    reached: bool = False

    def progress(self, patience_s: float) -> Progress:
        """Return how it fares."""
        if self.reached:
            return Progress("reached", remaining_m=0.0)
        if self.waited_s >= patience_s:
            return Progress("blocked", self.remaining_m, f"came no nearer for {patience_s:g} s")
        return Progress("underway", self.remaining_m)


def approached(approach: Approach, distance_m: float, now_s: float, reached_m: float, nearer_m: float) -> Approach:
    """Return the approach with one more look at how far the target is."""
    if approach.reached or distance_m <= reached_m:
        return replace(approach, reached=True)
    step_s = 0.0 if approach.asked_s is None else min(now_s - approach.asked_s, LONGEST_STEP_S)
    nearer = distance_m <= approach.nearest_m - nearer_m
    return Approach(
        nearest_m=distance_m if nearer else approach.nearest_m,
        waited_s=0.0 if nearer else approach.waited_s + step_s,
        asked_s=now_s,
        remaining_m=distance_m,
    )


def target_nav_response(pose: Pose, x_m: float, y_m: float, params: TargetNavParams) -> Response:
    """Return the vector from `pose` (map_from_robot) towards a place in the map."""
    dx, dy = x_m - pose.x_m, y_m - pose.y_m
    length = params.amplitude * max(SHORTEST, min(1.0, hypot(dx, dy) / params.slow_m))
    bearing_rad = atan2(dy, dx) - pose.heading_rad
    return Response(forward=length * cos(bearing_rad), left=length * sin(bearing_rad))


class TargetNav(Behaviour[TargetNavParams]):
    """Goes to a place, and tries on where it is blocked until another motivation stops it."""

    Params = TargetNavParams
    motivated = True
    parameters = ("x_m", "y_m")
    reads = POSE_READS

    def __init__(self, params: TargetNavParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._target: tuple[float, float] | None = None
        self._approach = Approach()

    def select(self, parameters: tuple[float | str, ...]) -> None:
        self._target = None
        x_m, y_m = numbers(self.name, self.parameters, parameters)
        self._target, self._approach = (x_m, y_m), Approach()

    def respond(self, board: Access) -> Response | None:
        pose = map_from_robot(board)
        if pose is None or self._target is None:
            return None
        x_m, y_m = self._target
        distance_m = hypot(x_m - pose.x_m, y_m - pose.y_m)
        params = self.params
        self._approach = approached(self._approach, distance_m, board.now_s, params.reached_m, params.nearer_m)
        return None if self._approach.reached else target_nav_response(pose, x_m, y_m, params)

    def progress(self) -> Progress:
        return Progress() if self._target is None else self._approach.progress(self.params.patience_s)

    def done(self) -> bool:
        return self._approach.reached
