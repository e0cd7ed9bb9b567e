"""What a mission may say of a simulated robot."""

from dataclasses import dataclass
from math import pi
from pathlib import Path

from blackboard.errors import MissionError
from blackboard.parameters import require
from sim.disturbances import Disturbance


@dataclass(frozen=True)
class SimulatedRobotParams:
    """Which robot, in which world, and what is true to life in it."""

    world: Path = Path(
        "lab"
    )  # a shipped world, a world's .toml, a ROS map's .yaml, or "random": a floor plan drawn from ...
    world_seed: int = 0
    robot: Path = Path("k2a")
    people: bool = False  # those whom the world knows walk in it
    odometry_errors: bool = True  # off: the wheels tell the truth
    disturbances: tuple[
        Disturbance, ...
    ] = ()  # of "chair", "person", "door": what gets in its way, drawn with the seed
    drawn_odometry: bool = False  # each run has wheels of its own: the robot's scales and drift are sigmas to draw from
    start_x_m: float | None = None  # together with start_y_m; else the world's start, else where there is most room
    start_y_m: float | None = None
    start_heading_rad: float | None = None
    start_charge_fraction: float = 1.0  # of its battery

    def __post_init__(self) -> None:
        if (self.start_x_m is None) != (self.start_y_m is None):
            raise MissionError("start_x_m and start_y_m belong together; give both or none")
        require(0 <= self.world_seed < 2**31, "world_seed", self.world_seed, "[0, 2147483647]")
        require(0.0 <= self.start_charge_fraction <= 1.0, "start_charge_fraction", self.start_charge_fraction, "[0, 1]")
        if self.start_heading_rad is not None:
            require(abs(self.start_heading_rad) <= 2 * pi, "start_heading_rad", self.start_heading_rad, "[-2 pi, 2 pi]")
