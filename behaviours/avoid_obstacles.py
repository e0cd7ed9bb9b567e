"""Pushes the robot away from what is near: each echo is the site of a force that falls with the square of its distance.

Reads  status/robot                     RobotDescription
       observations/signal/odometry     Odometry
       observations/signal/sonar_scan   SonarScan
       observations/signal/laser_scan   LaserScan
       observations/signal/bumper       Bumper

Bou-Ghannam 1992, section 4.2.1: F = -sum_i (1 / r_i)^2 e_i over the twelve sonars; the response is F where |F| exceeds a
threshold. Here r_i is measured from the robot's rim, where the thesis's ring sits, and i runs over as many sectors around
the robot, each with the nearest of what was heard there lately: a lost echo does not switch the force off, and a laser counts
like a ring.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import cos, hypot, pi, sin

from behaviours.near_echoes import READS, Near, NearEchoesParams, around_now, no_echoes, refresh
from blackboard.access import Access
from blackboard.component import Behaviour
from blackboard.kinds import ROBOT
from blackboard.messages.motion import Response
from blackboard.parameters import require

MEMORY = NearEchoesParams(reach_m=1.0)  # at this distance all sectors of one side together stay below the threshold
LONGEST = 20.0  # no response is longer, in full speeds


@dataclass(frozen=True, slots=True, kw_only=True)
class AvoidObstaclesParams:
    """Where the force begins, and where it outweighs the other behaviours."""

    threshold_m: float = 0.4  # responds where the force exceeds that of one echo at this distance from the rim
    balance_m: float = 0.2  # one echo at this distance outweighs full speed towards it
    nearest_m: float = 0.05  # closer echoes push no harder
    sectors: int = 12  # as many as the thesis's ring has sonars

    def __post_init__(self) -> None:
        require(0.05 <= self.balance_m <= 2.0, "balance_m", self.balance_m, "[0.05, 2]")
        require(self.balance_m <= self.threshold_m <= 10.0, "threshold_m", self.threshold_m, "[balance_m, 10]")
        require(0.01 <= self.nearest_m <= self.balance_m, "nearest_m", self.nearest_m, "[0.01, balance_m]")
        require(4 <= self.sectors <= 72, "sectors", self.sectors, "[4, 72]")


def repulsive_force(nears: Iterable[Near], radius_m: float, params: AvoidObstaclesParams) -> tuple[float, float]:
    """Return the resulting force (forward, left) in 1/m^2, robot frame, from the nearest echo of each sector."""
    width_rad = 2.0 * pi / params.sectors
    nearest: dict[int, tuple[float, float]] = {}
    for distance_m, bearing_rad, _, _, _ in nears:
        sector = round(bearing_rad / width_rad) % params.sectors  # the first sector lies straight ahead
        held = nearest.get(sector)
        if held is None or distance_m < held[0]:
            nearest[sector] = (distance_m, bearing_rad)
    forward, left = 0.0, 0.0
    for distance_m, bearing_rad in nearest.values():
        force = max(distance_m - radius_m, params.nearest_m) ** -2
        forward -= force * cos(bearing_rad)
        left -= force * sin(bearing_rad)
    return forward, left


def avoid_obstacles_response(nears: Iterable[Near], radius_m: float, params: AvoidObstaclesParams) -> Response | None:
    """Return the force, scaled so that one echo at `balance_m` gives a response of length 1; None below the threshold."""
    forward, left = repulsive_force(nears, radius_m, params)
    force = hypot(forward, left)
    if force < params.threshold_m**-2:
        return None
    scale = min(params.balance_m**2, LONGEST / force)
    return Response(forward=scale * forward, left=scale * left)


class AvoidObstacles(Behaviour[AvoidObstaclesParams]):
    """Moves away from what is near."""

    Params = AvoidObstaclesParams
    reads = READS

    def __init__(self, params: AvoidObstaclesParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._memory = no_echoes()

    def respond(self, board: Access) -> Response | None:
        self._memory = refresh(self._memory, board, MEMORY)
        robot = board.newest(ROBOT)
        if robot is None:
            return None
        nears = around_now(self._memory, board, MEMORY.reach_m)
        return avoid_obstacles_response(nears, robot.value.radius_m, self.params)
