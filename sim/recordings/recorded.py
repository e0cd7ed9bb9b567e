"""A recording as a robot: a CARMEN log or ROS bag whose readings come as if they were being taken now.

Posts  observations/signal/odometry    Odometry
       observations/signal/sonar_scan  SonarScan (the recording's sonars, or a laser thinned to cones)
       observations/signal/laser_scan  LaserScan

The mission's clock is the recording's own. A reading comes at its stamp in the recording and bears the time at which it was
taken: that stamp less the sensor's latency.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

from blackboard.component import Reading, Robot
from blackboard.errors import RecordingError
from blackboard.kinds import LASER_SCAN, ODOMETRY, SONAR_SCAN, Kind
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import (
    LaserScan,
    LaserSensor,
    Odometry,
    RobotDescription,
    SonarScan,
    SonarSensor,
)
from blackboard.parameters import require
from sim.recordings.cones import Fan, cone_of_beams, cone_sensors, thin
from sim.recordings.formats import open_recording
from sim.recordings.ranges import Ranges, as_echoes, fit_echoes
from sim.recordings.recording import Echoes, Heard, Sweep
from sim.robot_file import RobotModel, load_robot

S = TypeVar("S", SonarSensor, LaserSensor)

MAX_CONES = 256
APART_S = 1e-6  # between poses of one stamp: the least that trajectory files tell apart
STANDING = Odometry(pose=Pose(x_m=0.0, y_m=0.0, heading_rad=0.0))
BODY = RobotDescription(  # for what recordings do not tell; a robot file tells it
    name="recorded", radius_m=0.25, max_speed_mps=1.0, max_turn_radps=2.0, max_acceleration_mps2=1.0
)


@dataclass(frozen=True)
class RecordedRobotParams:
    """Which recording, and how its sensors are to be taken."""

    path: Path  # a CARMEN log, a bag file, or a bag folder
    robot: Path | None = None  # robot file whose body and sensor ranges go over those of the recording
    cones: int = 0  # 0: the laser stays; N: each laser becomes N sonar cones, and the only sonars are these
    leave_out: str = ""  # "laser" or "sonar": as if the recording had none
    radius_m: float | None = None  # None: the robot file's, else 0.25, between a Pioneer (0.26) and a Roomba (0.17)
    max_range_m: float | None = None  # nothing came back from beyond it; None: what recording and robot file say
    # how late a stamp is after the moment at which the reading was taken; None: the robot file's, else 0
    odometry_latency_s: float | None = None
    sonar_latency_s: float | None = None
    laser_latency_s: float | None = None  # and that of the cones that a laser is thinned to
    odometry_topic: str = ""  # in a bag with several; empty: /odom, else the one with most messages
    skip_s: float = 0.0  # so much of the beginning is left out: the run starts there, at the odometry's pose

    def __post_init__(self) -> None:
        require(0 <= self.cones <= MAX_CONES, "cones", self.cones, f"[0, {MAX_CONES}]")
        require(self.leave_out in ("", "laser", "sonar"), "leave_out", self.leave_out, "'laser', 'sonar' or nothing")
        limit = "nothing: cones are made of the laser, and are then the only sonars"
        require(not (self.cones and self.leave_out), "leave_out", self.leave_out, limit)
        require(0 <= self.skip_s <= 1e7, "skip_s", self.skip_s, "[0, 1e7] s")
        for name in ("odometry_latency_s", "sonar_latency_s", "laser_latency_s"):
            value = getattr(self, name)
            require(value is None or 0 <= value <= 10, name, value, "[0, 10] s")
        for name in ("radius_m", "max_range_m"):
            value = getattr(self, name)
            require(value is None or 0 < value <= 100, name, value, "(0, 100] m")


class RecordedRobot(Robot[RecordedRobotParams]):
    """Plays a recording; it obeys no command. Raises RecordingError where the recording cannot be used."""

    Params = RecordedRobotParams

    def __init__(self, params: RecordedRobotParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._recording = open_recording(params.path, params.odometry_topic)
        self._cones = params.cones
        self._notes = list(self._recording.notes)
        model = load_robot(params.robot) if params.robot is not None else None
        self._left_out = {"laser": Sweep, "sonar": Echoes, "": Echoes if self._cones else None}[params.leave_out]
        self._description = self._describe(model)
        self._latencies_s = _latencies(params, model)
        self._standing = Odometry not in self._recording.first_s
        if self._standing:
            self._notes.append("no odometry in the recording: the robot is taken to stand still")
        self._cone_of_beams: dict[tuple[int, Fan], npt.NDArray[np.intp]] = {}
        self._newest_s: dict[str, tuple[float, float]] = {}  # of each kind: as told, as given
        self._held: Iterator[Heard] = iter(())
        self._replay = self._recording.replay()
        self._now_s = -np.inf
        kinds: dict[type[Any], Kind[Any]] = {
            Odometry: ODOMETRY,
            Echoes: SONAR_SCAN,
            Sweep: SONAR_SCAN if self._cones else LASER_SCAN,
        }
        heard = [t for t in kinds if t in self._recording.first_s and t is not self._left_out]
        self.provides = tuple(dict.fromkeys([*([ODOMETRY] if self._standing else []), *(kinds[t] for t in heard)]))
        first_s = min(self._recording.first_s[t] - self._latencies_s[t] for t in heard)
        self._start_s = first_s + params.skip_s
        self._end_s = max(self._recording.last_s[t] for t in heard)
        if self._start_s > self._end_s:
            raise RecordingError(
                f"{params.path}: skip_s = {params.skip_s:g} leaves nothing of {self._end_s - first_s:.1f} s; skip less"
            )

    @property
    def description(self) -> RobotDescription:
        return self._description

    @property
    def start_s(self) -> float:
        return self._start_s

    @property
    def end_s(self) -> float:
        return self._end_s

    @property
    def moves(self) -> bool:
        return False

    def advance(self, until_s: float) -> Iterator[Reading[Any]]:
        """Yield what was recorded up to `until_s`, in the file's order."""
        for heard in chain(self._held, self._replay):
            self._now_s = max(self._now_s, heard.stamp_s)
            if self._now_s > until_s:
                self._held = iter((heard,))
                return
            yield from self._readings(heard)
        self._held = iter(())

    def close(self) -> None:
        self._held = iter(())
        self._replay.close()

    def summary(self) -> dict[str, float | int | str]:
        """Return what was read, left out and repaired, and what a user should know of how the file was taken."""
        figures: dict[str, float | int | str] = dict(sorted(self._recording.counts.items()))
        if self._notes:
            figures["notes"] = "; ".join(self._notes)
        return figures

    def _describe(self, model: RobotModel | None) -> RobotDescription:
        """Return the body that the robot file or the parameters give, with the recording's sensors."""
        params, recording = self.params, self._recording
        sonars = recording.sonars if params.leave_out != "sonar" else ()
        lasers = recording.lasers if params.leave_out != "laser" else ()
        if self._cones:
            if not lasers:
                raise RecordingError(
                    f"{params.path}: cones = {self._cones}, but there is no laser to thin; leave cones out"
                )
            beams = min(fan.beams for fan in recording.fans)
            if self._cones > beams or self._cones * len(lasers) > MAX_CONES:
                raise RecordingError(
                    f"{params.path}: cones = {self._cones} is more than {min(beams, MAX_CONES // len(lasers))}, "
                    f"all that {len(lasers)} laser(s) of {beams} beams give"
                )
            if sonars:
                self._notes.append(f"the recording's own {len(sonars)} sonars are left out beside the cones")
            sonars = tuple(
                cone
                for fan, laser in zip(recording.fans, lasers, strict=True)
                for cone in cone_sensors(fan, self._cones, laser)
            )
            lasers = ()
        body, sonar_reach_m, laser_reach_m = BODY, params.max_range_m, params.max_range_m
        if model is not None:
            body = model.description()
            sonar_reach_m = sonar_reach_m or (model.sonar.max_range_m if model.sonar else None)
            laser_reach_m = laser_reach_m or max((laser.max_range_m for laser in model.lasers), default=None)
        return RobotDescription(
            name=re.sub(r"[^A-Za-z0-9_-]", "_", params.path.name.split(".")[0]) or BODY.name,
            radius_m=params.radius_m or body.radius_m,
            max_speed_mps=body.max_speed_mps,
            max_turn_radps=body.max_turn_radps,
            max_acceleration_mps2=body.max_acceleration_mps2,
            sonars=tuple(_within(sonar, sonar_reach_m) for sonar in sonars),
            lasers=tuple(_within(laser, laser_reach_m) for laser in lasers),
        )

    def _readings(self, heard: Heard) -> Iterator[Reading[Any]]:
        value, stamp_s = heard.value, heard.stamp_s - self._latencies_s[type(heard.value)]
        if stamp_s < self._start_s:
            return
        if isinstance(value, Odometry):
            yield self._reading(ODOMETRY, stamp_s, value)
            return
        if type(value) is self._left_out:
            return
        if self._standing:
            yield self._reading(ODOMETRY, stamp_s, STANDING)
        if isinstance(value, Sweep) and not self._cones:
            yield self._reading(LASER_SCAN, stamp_s, self._laser_scan(value))
            return
        scan = self._sonar_scan(*((value.sensors, value.ranges) if isinstance(value, Echoes) else self._thinned(value)))
        if scan.sensors:
            yield self._reading(SONAR_SCAN, stamp_s, scan)

    def _reading(self, kind: Kind[Any], stamp_s: float, value: Any) -> Reading[Any]:
        """Return a reading whose stamp does not run back: several sensors of a kind may come with different delays.

        Poses that bear one stamp are told apart in the file's order, and what came with one of them bears the stamp given to it.
        """
        told_s, given_s = self._newest_s.get(kind.path, (stamp_s, -np.inf))
        if stamp_s < told_s and value is not STANDING:
            self._recording.counts["stamps_repaired"] += 1
        moves = kind is ODOMETRY and value is not STANDING
        posed_told_s, posed_given_s = self._newest_s.get(ODOMETRY.path, (-np.inf, -np.inf))
        least_s = posed_given_s if stamp_s == posed_told_s else stamp_s
        newest_s = max(stamp_s, given_s + APART_S if moves else max(given_s, least_s))
        self._newest_s[kind.path] = (max(stamp_s, told_s), newest_s)
        return Reading(kind, newest_s, value)

    def _laser_scan(self, sweep: Sweep) -> LaserScan:
        ranges = _cut(sweep.ranges, self._description.lasers[sweep.laser].max_range_m)
        return LaserScan(
            laser=sweep.laser,
            angle_min_rad=sweep.fan.angle_min_rad,
            angle_step_rad=sweep.fan.angle_step_rad,
            ranges_m=as_echoes(ranges),
        )

    def _sonar_scan(self, sensors: tuple[int, ...], ranges: Ranges) -> SonarScan:
        reach_m = np.array([self._description.sonars[sensor].max_range_m for sensor in sensors])
        fit, echoes = fit_echoes(sensors, _cut(ranges, reach_m))
        return SonarScan(sensors=fit, ranges_m=echoes)

    def _thinned(self, sweep: Sweep) -> tuple[tuple[int, ...], Ranges]:
        key = (sweep.laser, sweep.fan)
        if key not in self._cone_of_beams:
            self._cone_of_beams[key] = cone_of_beams(sweep.fan, self._recording.fans[sweep.laser], self._cones)
        first = sweep.laser * self._cones
        return tuple(range(first, first + self._cones)), thin(sweep.ranges, self._cone_of_beams[key], self._cones)


def _latencies(params: RecordedRobotParams, model: RobotModel | None) -> dict[type[Any], float]:
    """Return by how much each type of value is stamped late: the parameters over the robot file over nothing."""
    told: dict[type[Any], float | None] = {Odometry: None, Echoes: None, Sweep: None}
    if model is not None:
        told = {
            Odometry: model.odometry.latency_s,
            Echoes: model.sonar.latency_s if model.sonar is not None else None,
            Sweep: max((laser.latency_s for laser in model.lasers), default=None),
        }
    given = {
        Odometry: params.odometry_latency_s,
        Echoes: params.sonar_latency_s,
        Sweep: params.laser_latency_s,
    }
    return {type_: next((s for s in (given[type_], told[type_]) if s is not None), 0.0) for type_ in told}


def _cut(ranges: Ranges, reach_m: float | npt.NDArray[np.float64]) -> Ranges:
    """Return ranges in which nothing came back from `reach_m` or beyond."""
    return np.where(ranges >= reach_m, np.inf, ranges)


def _within(sensor: S, reach_m: float | None) -> S:
    """Return a sensor that hears no further than `reach_m`."""
    if reach_m is None or reach_m >= sensor.max_range_m:
        return sensor
    return msgspec.structs.replace(sensor, max_range_m=reach_m)
