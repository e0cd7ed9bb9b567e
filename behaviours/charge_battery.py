"""Brings the robot before a charging station, and the nearer it comes the less avoid-obstacles has to say.

Motivated by  x_m, y_m, heading_rad                  the station, map frame; and the heading of a robot that charges there
Reads  motivations/motivation/<its name>             Motivation
       status/robot                                  RobotDescription
       hypotheses/feature/map_from_odom              Pose
       observations/feature/odom_from_robot          Pose
Posts  control/switch/avoid_obstacles.<its name>     Switch   while it answers near the station

Bou-Ghannam 1992, section 4.2.1: a charge-battery behaviour may tune down the effect of avoid-obstacles by raising its threshold as
the robot approaches the station. Here a switch in the line of avoid-obstacles does that, whose threshold grows linearly; it goes
when this behaviour has done its part. The last piece is docking's.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import atan2, cos, floor, hypot, sin

from behaviours.asked import numbers
from behaviours.target_nav import Approach, approached
from behaviours.whereabouts import POSE_READS, map_from_robot
from blackboard.access import Access
from blackboard.component import Behaviour, Progress
from blackboard.kinds import ROBOT
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.motion import Response, Switch
from blackboard.parameters import require

THRESHOLD_STEP = 0.1  # the threshold is told in such steps: it is news, not a stream
SHORTEST = 0.3  # of the amplitude
TURN_GAIN_PER_S = 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ChargeBatteryParams:
    """Where it stops, and how far it tunes avoid-obstacles down."""

    tunes: str = "avoid_obstacles"  # the behaviour whose threshold it raises
    near_m: float = 2.0  # from so far before the place on
    threshold: float = 1.0  # at the place: that of one echo at avoid-obstacles' balance distance
    before_m: float = 0.5  # the place lies so far before the station, from the robot's rim: room to turn
    amplitude: float = 0.8  # of full speed, as target-nav's
    slow_m: float = 0.5
    reached_m: float = 0.15
    facing_rad: float = 0.1
    turn_radps: float = 0.6
    nearer_m: float = 0.25  # so much nearer than ever before is progress
    patience_s: float = 30.0  # without it it is blocked

    def __post_init__(self) -> None:
        require(0.1 <= self.near_m <= 20.0, "near_m", self.near_m, "[0.1, 20]")
        require(0.0 <= self.threshold <= 1000.0, "threshold", self.threshold, "[0, 1000]")
        require(0.0 <= self.before_m <= 5.0, "before_m", self.before_m, "[0, 5]")
        require(0.4 <= self.amplitude < 1.0, "amplitude", self.amplitude, "[0.4, 1)")
        for name in ("slow_m", "reached_m", "nearer_m"):
            require(0.02 <= getattr(self, name) <= 5.0, name, getattr(self, name), "[0.02, 5]")
        require(0.02 <= self.facing_rad <= 1.0, "facing_rad", self.facing_rad, "[0.02, 1]")
        require(0.05 <= self.turn_radps <= 3.0, "turn_radps", self.turn_radps, "[0.05, 3]")
        require(1.0 <= self.patience_s <= 3600.0, "patience_s", self.patience_s, "[1, 3600]")


def place_before(pose: Pose, station: tuple[float, ...], radius_m: float, before_m: float) -> Pose:
    """Return where to stand before a station (x m, y m, and the heading, if any), and how to face it; map frame.

    Without a heading that is on the straight way there from `pose`.
    """
    x_m, y_m = station[:2]
    heading_rad = station[2] if len(station) > 2 else atan2(y_m - pose.y_m, x_m - pose.x_m)
    away_m = radius_m + before_m
    x_m, y_m = x_m - away_m * cos(heading_rad), y_m - away_m * sin(heading_rad)
    return Pose(x_m=x_m, y_m=y_m, heading_rad=wrap_angle(heading_rad))


def raised_threshold(distance_m: float, params: ChargeBatteryParams) -> float:
    """Return the threshold at this distance from the place: nothing at `near_m`, all of it there, in steps."""
    share = max(0.0, min(1.0, 1.0 - distance_m / params.near_m))
    return floor(share * params.threshold / THRESHOLD_STEP + 1e-9) * THRESHOLD_STEP


def approach_response(pose: Pose, place: Pose, params: ChargeBatteryParams) -> Response:
    """Return the vector towards the place, shorter near it."""
    dx, dy = place.x_m - pose.x_m, place.y_m - pose.y_m
    length = params.amplitude * max(SHORTEST, min(1.0, hypot(dx, dy) / params.slow_m))
    bearing_rad = atan2(dy, dx) - pose.heading_rad
    return Response(forward=length * cos(bearing_rad), left=length * sin(bearing_rad))


def facing_response(error_rad: float, turn_radps: float) -> Response:
    """Return the turn on the spot that takes an angle away."""
    return Response(turn_radps=max(-turn_radps, min(turn_radps, TURN_GAIN_PER_S * error_rad)))


class ChargeBattery(Behaviour[ChargeBatteryParams]):
    """Goes before a charging station and faces it."""

    Params = ChargeBatteryParams
    motivated = True
    parameters = ("x_m", "y_m", "heading_rad")
    optional = 1
    reads = (*POSE_READS, ROBOT)

    def __init__(self, params: ChargeBatteryParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._station: tuple[float, ...] = ()
        self._approach = Approach()
        self._threshold = 0.0
        self._faces = False

    def select(self, parameters: tuple[float | str, ...]) -> None:
        self._station = ()
        self._station = numbers(self.name, self.parameters, parameters, self.optional)
        self._approach, self._threshold, self._faces = Approach(), 0.0, False

    def respond(self, board: Access) -> Response | None:
        pose, robot, params = map_from_robot(board), board.newest(ROBOT), self.params
        if pose is None or robot is None or not self._station or self._faces:
            return None
        place = place_before(pose, self._station, robot.value.radius_m, params.before_m)
        distance_m = pose.distance_m(place)
        self._threshold = raised_threshold(distance_m, params)
        self._approach = approached(self._approach, distance_m, board.now_s, params.reached_m, params.nearer_m)
        if not self._approach.reached:
            return approach_response(pose, place, params)
        error_rad = wrap_angle(place.heading_rad - pose.heading_rad)
        self._faces = abs(error_rad) <= params.facing_rad
        return None if self._faces else facing_response(error_rad, params.turn_radps)

    def adjusts(self) -> Mapping[str, Switch]:
        return {self.params.tunes: Switch(threshold=self._threshold)} if self._threshold else {}

    def progress(self) -> Progress:
        if not self._station:
            return Progress()
        if self._approach.reached and not self._faces:
            return Progress("underway", 0.0, "turns to the station")
        return self._approach.progress(self.params.patience_s)

    def done(self) -> bool:
        return self._faces
