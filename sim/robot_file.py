"""Robots in TOML: body, drive and sensors, and how each of them errs."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from blackboard.errors import MissionError, did_you_mean
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.sensing import CameraSensor, LaserSensor, RobotDescription, SonarSensor
from blackboard.parameters import parse_parameters
from blackboard.toml_file import TomlFile, read_toml
from sim.sensor_models import BatteryModel, Body, CameraModel, LaserModel, OdometryModel, SonarModel
from sim.shipped import find_file

T = TypeVar("T")

TABLES = ("body", "odometry", "battery", "sonar", "laser", "camera")
MAX_LASERS = 16


@dataclass(frozen=True)
class RobotModel:
    """All that a robot's file says."""

    body: Body
    odometry: OdometryModel = field(default_factory=OdometryModel)
    battery: BatteryModel = field(default_factory=BatteryModel)
    sonar: SonarModel | None = None
    lasers: tuple[LaserModel, ...] = ()
    camera: CameraModel | None = None

    @property
    def reach_m(self) -> float:
        """How far from its middle a sensor of the robot can meet anything."""
        ranges = [laser.max_range_m for laser in self.lasers]
        ranges += [sensor.max_range_m for sensor in (self.sonar, self.camera) if sensor is not None]
        return self.body.radius_m + max(ranges, default=0.0)

    def rates_hz(self) -> dict[tuple[str, int], float]:
        """Return how often each sensor is read, by its kind and number."""
        rates = {("odometry", 0): self.odometry.rate_hz, ("battery", 0): self.battery.rate_hz}
        rates |= {("laser", number): laser.rate_hz for number, laser in enumerate(self.lasers)}
        single = {("sonar", 0): self.sonar, ("camera", 0): self.camera}
        return rates | {sensor: model.rate_hz for sensor, model in single.items() if model is not None}

    def description(self, name: str | None = None) -> RobotDescription:
        """Return what the robot tells of itself, called `name` or as its file says: no word of its errors."""
        sonar, camera = self.sonar, self.camera
        return RobotDescription(
            name=name or self.body.name,
            radius_m=self.body.radius_m,
            max_speed_mps=self.body.max_speed_mps,
            max_turn_radps=self.body.max_turn_radps,
            max_acceleration_mps2=self.body.max_acceleration_mps2,
            sonars=()
            if sonar is None
            else tuple(
                SonarSensor(mount=place, cone_rad=sonar.cone_rad, max_range_m=sonar.max_range_m)
                for place in sonar.places()
            ),
            lasers=tuple(
                LaserSensor(
                    mount=Pose(x_m=laser.x_m, y_m=laser.y_m, heading_rad=wrap_angle(laser.heading_rad)),
                    max_range_m=laser.max_range_m,
                )
                for laser in self.lasers
            ),
            cameras=()
            if camera is None
            else (
                CameraSensor(
                    mount=Pose(x_m=camera.x_m, y_m=camera.y_m, heading_rad=wrap_angle(camera.heading_rad)),
                    field_rad=camera.field_rad,
                    max_range_m=camera.max_range_m,
                ),
            ),
            bumper=self.body.bumper,
        )


def load_robot(name: Path) -> RobotModel:
    """Return a shipped robot, or one from a file; raise MissionError where it is wrong."""
    file = read_toml(find_file(name, "robots"))
    for key in file.data:
        if key not in TABLES:
            place = file.place(key) if isinstance(file.data[key], dict | list) else file.place()
            raise MissionError(f"{place.at(key)}: unknown table '{key}'{did_you_mean(key, TABLES)}")
    if "body" not in file.data:
        raise MissionError(f"{file.path}: table [body] is missing; add it")
    lasers = file.data.get("laser", [])
    if not isinstance(lasers, list) or not all(isinstance(laser, dict) for laser in lasers):
        raise MissionError(f"{file.place().at('laser')}: write each laser as [[laser]]")
    if len(lasers) > MAX_LASERS:
        raise MissionError(f"{file.path}: {len(lasers)} lasers are over the limit of {MAX_LASERS}")
    return RobotModel(
        body=_part(Body, file, "body"),
        odometry=_part(OdometryModel, file, "odometry"),
        battery=_part(BatteryModel, file, "battery"),
        sonar=_part(SonarModel, file, "sonar") if "sonar" in file.data else None,
        lasers=tuple(parse_parameters(LaserModel, laser, file.place("laser", i)) for i, laser in enumerate(lasers)),
        camera=_part(CameraModel, file, "camera") if "camera" in file.data else None,
    )


def _part(type_: type[T], file: TomlFile, key: str) -> T:
    table = file.data.get(key, {})
    if not isinstance(table, dict):
        raise MissionError(f"{file.place().at(key)}: write '{key}' as a table [{key}]")
    return parse_parameters(type_, table, file.place(key))
