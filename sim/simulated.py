"""A simulated robot in a simulated world.

Posts         observations/signal/odometry    Odometry   from the true start pose on: map and odometry frame agree at first
              observations/signal/bumper      Bumper     when it changes
              observations/signal/laser_scan  LaserScan
              observations/signal/sonar_scan  SonarScan
              observations/signal/blobs       BlobScan
              observations/signal/battery     Battery

Time goes in steps of 25 ms whatever steps are asked for, so that only the stamps of the commands matter. A sensor's
latency delays when its reading comes, not its stamp. Robots may share one world (`join`): each is a round body in the way of the
others and of what they sense.
"""

from collections.abc import Iterator
from math import floor, inf
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import UNNAMED, Reading, Robot, WorldTruth
from blackboard.errors import MissionError
from blackboard.kinds import BATTERY, BLOBS, BUMPER, LASER_SCAN, MAP_FROM_ODOM, ODOMETRY, SONAR_SCAN
from blackboard.messages.geometry import IDENTITY, Pose, wrap_angle
from blackboard.messages.motion import Drive
from blackboard.messages.sensing import (
    Battery,
    BlobScan,
    Bumper,
    LaserScan,
    Odometry,
    RobotDescription,
    SonarScan,
)
from sim.camera import camera_fan, look
from sim.disturbances import Disturber
from sim.dock import Charge
from sim.drive import Base
from sim.kept_state import as_record
from sim.laser import laser_sweep, sweep_ranges
from sim.odometer import Odometer, drawn
from sim.people import Walker
from sim.robot_file import load_robot
from sim.schedule import Schedule
from sim.sensor_models import TICKS_PER_S
from sim.shapes import Floats, Shapes
from sim.simulated_params import SimulatedRobotParams
from sim.sonar import fire, sonar_fans, true_echoes
from sim.starts import check_apart, check_same_world, start_pose
from sim.surroundings import Surroundings
from sim.together import Together
from sim.world_by_name import load_world

KEPT = (  # what outlives a process, beside what the parts keep
    *("_sonar_rng", "_laser_rng", "_camera_rng", "_echoes_lost", "_cross_talk"),
    *("_told_way_m", "_told_turn_rad", "_bumper", "_charge_fraction", "_charge"),
)


class SimulatedRobot(Robot[SimulatedRobotParams]):
    """Drives, touches, senses and errs as the robot's file says."""

    Params = SimulatedRobotParams

    def __init__(self, params: SimulatedRobotParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._model = load_robot(params.robot)
        self._first_world = load_world(params.world, params.world_seed)
        self._description = self._model.description(None if name == UNNAMED else name)
        self._start = self._start_pose()
        self._entropy = int(self.rng.integers(2**62))
        model = self._model
        self.provides = tuple(
            kind
            for kind, present in (
                (ODOMETRY, True),
                (BUMPER, model.body.bumper),
                (LASER_SCAN, bool(model.lasers)),
                (SONAR_SCAN, model.sonar is not None),
                (BLOBS, model.camera is not None),
                (BATTERY, True),
            )
            if present
        )
        self._fans = None if model.sonar is None else sonar_fans(model.sonar)
        self._view = None if model.camera is None else camera_fan(model.camera)
        self._sweeps = [laser_sweep(laser) for laser in model.lasers]
        self._together = Together([self])

    @property
    def description(self) -> RobotDescription:
        return self._description

    def join(self, other: Robot[Any]) -> None:
        if not isinstance(other, SimulatedRobot):
            raise MissionError(f"a simulated robot cannot share a world with '{other.name}', which is none")
        check_same_world(self.params, other.params, other.name)
        members = [member for member in other._together.members if isinstance(member, SimulatedRobot)]
        others = [(member.name, member._start, member._model.body.radius_m) for member in members]
        check_apart(self._first_world, self._start, self._model.body.radius_m, others)
        together = Together([*members, self])
        for member in [*members, self]:
            member._together = together

    def reset(self) -> None:
        """Begin anew: the same again, for all robots of the world."""
        self._together.begin()

    def surroundings(self) -> Surroundings:
        """Return the world as it is at first, without robots, with random numbers of this robot."""
        world = self._first_world
        people = world.people if self.params.people else ()
        walkers = [Walker(person, self._random(10 + i)) for i, person in enumerate(people)]
        disturber = None
        if self.params.disturbances:
            body = self._model.body
            disturber = Disturber(self.params.disturbances, world, body.radius_m, body.max_speed_mps, self._random(4))
        return Surroundings(world, walkers, disturber)

    def enter(self, around: Surroundings) -> None:
        """Stand at the start as if nothing had been."""
        model = self._model
        errors = model.odometry if self.params.odometry_errors else None
        if errors is not None and self.params.drawn_odometry:
            errors = drawn(errors, self._random(3))
        self._base = Base(model.body, around.world.shapes, self._start)
        self._around = around
        self._number = around.enter(self._base, model.reach_m)
        self._odometer = Odometer(self._start, errors, self._random(0))
        self._sonar_rng, self._laser_rng = self._random(1), self._random(2)
        self._camera_rng = self._random(5)
        self._schedule = Schedule()
        self._wanted = (0.0, 0.0)
        self._told_way_m = self._told_turn_rad = 0.0
        self._bumper: tuple[float, ...] | None = None
        self._charge_fraction = self.params.start_charge_fraction
        self._charge = Charge(given=self._charge_fraction - 1.0)
        self._echoes_lost = self._cross_talk = 0
        self._said_s: dict[
            type[Any], float
        ] = {}  # by what it is, the stamp of what a process before this one said last

    def state(self) -> object:
        return {
            "around": self._around.state(),
            "base": self._base.state(),
            "odometer": self._odometer.state(),
            "schedule": self._schedule.state(),
            "tick": self._together.tick,
            "own": {name: vars(self)[name] for name in KEPT},
        }

    def resume(self, state: object, board: Access) -> None:
        """Go on where the world was: what is true of it outlives the process. The wheels stand still until they are commanded."""
        if state is None:
            self._resume_by_board(board)
        else:
            record = as_record(state)
            self._around.resume(record["around"])
            self._base.resume(record["base"])
            self._odometer.resume(record["odometer"])
            self._schedule.resume(record["schedule"])
            self._together.tick = record["tick"]
            vars(self).update(record["own"])
        self._wanted = (0.0, 0.0)
        standing = [entry for kind in self.provides if (entry := board.newest(kind)) is not None]
        self._said_s = {type(entry.value): entry.stamp_s for entry in standing}

    def _resume_by_board(self, board: Access) -> None:
        """Nothing was kept: the robot stands where it is believed to be, if it can, and the wheels' account goes on."""
        odometry, correction = board.newest(ODOMETRY), board.newest(MAP_FROM_ODOM)
        if odometry is None:
            return
        self._base.put((correction.value if correction is not None else IDENTITY) @ odometry.value.pose)
        self._odometer.put(self._base.pose, odometry.value.pose)
        self._together.tick = max(self._together.tick, floor(odometry.stamp_s * TICKS_PER_S + 1e-6))
        self._schedule.skip(self._model.rates_hz(), self._together.tick)
        battery = board.newest(BATTERY)
        if battery is not None:
            self._charge_fraction = battery.value.charge_fraction
            used = odometry.stamp_s / self._model.battery.standing_s
            self._charge = Charge(given=self._charge_fraction - 1.0 + used)

    def drive(self, command: Drive) -> None:
        self._wanted = (command.forward_mps, command.turn_radps)

    def advance(self, until_s: float) -> Iterator[Reading[Any]]:
        readings = self._schedule.take(self._together.advance(until_s))
        return (r for r in readings if r.stamp_s > self._said_s.get(type(r.value), -inf))

    def true_pose(self) -> Pose:
        return self._base.pose

    def people_at(self) -> list[tuple[float, float, float]]:
        """Return where people stand, for pictures and scores: x m, y m, radius m."""
        return self._around.people_at()

    def truth(self) -> WorldTruth:
        return self._around.world.truth()

    def summary(self) -> dict[str, float | int | str]:
        contacts = self._base.contacts
        table: dict[str, float | int | str] = {
            "distance_m": round(self._base.distance_m, 3),
            "collisions": contacts.caused,
            "touched_by_others": contacts.by_others,
            "sonar_echoes_lost": self._echoes_lost,
            "sonar_cross_talk": self._cross_talk,
        }
        if len(self._together.members) > 1:
            table["met_robots"] = self._around.meetings[self._number]
        disturber = self._around.disturber
        return table if disturber is None else {**table, "disturbances": disturber.told()}

    def _start_pose(self) -> Pose:
        params, heading = self.params, self.params.start_heading_rad
        wanted = None
        if params.start_x_m is not None and params.start_y_m is not None:
            wanted = Pose(x_m=params.start_x_m, y_m=params.start_y_m, heading_rad=0.0)
        return start_pose(self._first_world, wanted, heading, self._model.body.radius_m, params.people)

    def _random(self, stream: int) -> np.random.Generator:
        """Return random numbers of their own for a part, so that one part's draws change no other's."""
        return np.random.default_rng([self._entropy, stream])

    def move(self, dt_s: float) -> None:
        """Drive as was commanded, as long as the battery lasts, and charge it at a dock."""
        forward, turn = self._wanted if self._charge_fraction > 0.0 else (0.0, 0.0)
        self._base.step(dt_s, forward, turn, self._around.others(self._number))
        self._around.meet(self._number)
        if self._first_world.docks:
            self._charge.stand(dt_s, self._base.pose, self._model.body.radius_m, self._first_world.docks)

    def sense(self, tick: int) -> None:
        """Take what comes now: what was delayed, then odometry, bumper, lasers, sonars, camera, battery."""
        stamp_s = tick / TICKS_PER_S
        model, schedule = self._model, self._schedule
        schedule.give_late(tick)
        if schedule.is_due("odometry", 0, model.odometry.rate_hz, tick):
            schedule.give(Reading(ODOMETRY, stamp_s, self._read_odometry()), tick, model.odometry.latency_s)
        if model.body.bumper:
            touched = self._read_bumper()
            if touched != self._bumper:
                self._bumper = touched
                schedule.give(Reading(BUMPER, stamp_s, Bumper(bearings_rad=touched)), tick)
        sensed: Shapes | None = None
        for number, laser in enumerate(model.lasers):
            if schedule.is_due("laser", number, laser.rate_hz, tick):
                sensed = sensed or self._around.seen_by(self._number)
                schedule.give(Reading(LASER_SCAN, stamp_s, self._read_laser(number, sensed)), tick, laser.latency_s)
        if model.sonar is not None and schedule.is_due("sonar", 0, model.sonar.rate_hz, tick):
            sensed = sensed or self._around.seen_by(self._number)
            schedule.give(Reading(SONAR_SCAN, stamp_s, self._read_sonar(sensed)), tick, model.sonar.latency_s)
        if model.camera is not None and schedule.is_due("camera", 0, model.camera.rate_hz, tick):
            sensed = sensed or self._around.seen_by(self._number)
            schedule.give(Reading(BLOBS, stamp_s, self._read_camera(sensed)), tick, model.camera.latency_s)
        if schedule.is_due("battery", 0, model.battery.rate_hz, tick):
            used = stamp_s / model.battery.standing_s + self._base.distance_m / model.battery.driving_m
            self._charge_fraction = self._charge.left(used)
            schedule.give(Reading(BATTERY, stamp_s, Battery(charge_fraction=round(self._charge_fraction, 5))), tick)

    def _read_odometry(self) -> Odometry:
        base = self._base
        way, turn = base.distance_m - self._told_way_m, base.turned_rad - self._told_turn_rad
        self._told_way_m, self._told_turn_rad = base.distance_m, base.turned_rad
        return Odometry(
            pose=self._odometer.read(base.pose, way, turn), forward_mps=base.forward_mps, turn_radps=base.turn_radps
        )

    def _read_bumper(self) -> tuple[float, ...]:
        """Return the switches that are pressed, by their bearings in the robot frame."""
        contacts = self._base.contacts.bearings_rad
        if not contacts:
            return ()
        step = self._model.body.bumper_step_rad
        return tuple(
            sorted({wrap_angle(step * round(wrap_angle(b - self._base.heading_rad) / step)) for b in contacts})
        )

    def _read_laser(self, number: int, shapes: Shapes) -> LaserScan:
        base, sweep = self._base, self._sweeps[number]
        ranges = sweep_ranges(
            sweep, base.x_m, base.y_m, base.heading_rad, shapes, self._model.lasers[number], self._laser_rng
        )
        return LaserScan(
            laser=number, angle_min_rad=sweep.first_rad, angle_step_rad=sweep.fans.step_rad, ranges_m=_told(ranges)
        )

    def _read_sonar(self, shapes: Shapes) -> SonarScan:
        base, model, fans = self._base, self._model.sonar, self._fans
        assert model is not None
        assert fans is not None
        here = fans.moved(base.x_m, base.y_m, base.heading_rad)
        echo, nearest = true_echoes(here, shapes, model)
        echoes = fire(echo, nearest, model, self._sonar_rng)
        self._echoes_lost += int(echoes.lost.sum())
        self._cross_talk += int(echoes.cross_talk.sum())
        return SonarScan(sensors=tuple(range(len(echo))), ranges_m=_told(echoes.ranges_m))

    def _read_camera(self, shapes: Shapes) -> BlobScan:
        base, model, view = self._base, self._model.camera, self._view
        assert model is not None
        assert view is not None
        here = view.moved(base.x_m, base.y_m, base.heading_rad)
        return BlobScan(blobs=look(here, shapes, self._around.world.coloured, model, self._camera_rng))


def _told(ranges_m: Floats) -> tuple[float | None, ...]:
    """Return ranges as they are told: to the millimetre, None for no echo."""
    return tuple(None if r == inf else r for r in np.round(ranges_m, 3).tolist())
