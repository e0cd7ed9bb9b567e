"""How each part of a simulated robot works and errs: body, odometry, sonars, laser, battery."""

from dataclasses import dataclass
from math import cos, pi, radians, sin

from blackboard.errors import MissionError
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.sensing import MAX_BEAMS, MAX_BLOBS, MAX_SONARS
from blackboard.parameters import require

TICKS_PER_S = 40  # the simulator's time step is 25 ms; no sensor is faster


def _fraction(value: float, name: str) -> None:
    require(0.0 <= value <= 1.0, name, value, "[0, 1]")


def _not_negative(value: float, name: str) -> None:
    require(value >= 0.0, name, value, "[0, inf)")


def _rate(value: float) -> None:
    require(0.0 < value <= TICKS_PER_S, "rate_hz", value, f"(0, {TICKS_PER_S}]")


def _latency(value: float) -> None:
    require(0.0 <= value <= 10.0, "latency_s", value, "[0, 10]")


@dataclass(frozen=True)
class Body:
    """A round body on two driven wheels."""

    name: str
    radius_m: float
    max_speed_mps: float
    max_turn_radps: float
    max_acceleration_mps2: float
    max_turn_acceleration_radps2: float
    bumper: bool = True
    bumper_step_rad: float = radians(15.0)  # bearings of contact come in steps, as from a ring of switches

    def __post_init__(self) -> None:
        require(self.name != "", "name", self.name, "any name")
        for key in ("radius_m", "max_speed_mps", "max_turn_radps"):
            require(0.0 < getattr(self, key) <= 100.0, key, getattr(self, key), "(0, 100]")
        for key in ("max_acceleration_mps2", "max_turn_acceleration_radps2"):
            require(0.0 < getattr(self, key) <= 1000.0, key, getattr(self, key), "(0, 1000]")
        require(0.0 < self.bumper_step_rad <= pi, "bumper_step_rad", self.bumper_step_rad, "(0, pi]")


@dataclass(frozen=True)
class OdometryModel:
    """How the wheels' account differs from the truth: systematically, and at random."""

    rate_hz: float = 10.0
    latency_s: float = 0.0
    distance_scale: float = 1.0  # told distance / true distance
    turn_scale: float = 1.0
    drift_rad_per_m: float = 0.0  # heading told in excess for each metre driven: unequal wheels
    distance_noise_m: float = 0.0  # standard deviation after 1 m; grows with the root of the distance
    heading_noise_rad: float = 0.0  # standard deviation after 1 m driven
    turn_noise_rad: float = 0.0  # standard deviation after turning by 1 rad

    def __post_init__(self) -> None:
        _rate(self.rate_hz)
        _latency(self.latency_s)
        for key in ("distance_scale", "turn_scale"):
            require(0.5 <= getattr(self, key) <= 2.0, key, getattr(self, key), "[0.5, 2]")
        require(abs(self.drift_rad_per_m) <= 1.0, "drift_rad_per_m", self.drift_rad_per_m, "[-1, 1]")
        for key in ("distance_noise_m", "heading_noise_rad", "turn_noise_rad"):
            _not_negative(getattr(self, key), key)


@dataclass(frozen=True)
class SonarModel:
    """A ring of sonars that fire together. Their places: `bearings_deg` on a ring, or `mounts` (x m, y m, heading degrees)."""

    cone_rad: float
    max_range_m: float
    bearings_deg: tuple[float, ...] = ()
    ring_radius_m: float = 0.0
    mounts: tuple[tuple[float, ...], ...] = ()
    rate_hz: float = 5.0
    latency_s: float = 0.0
    noise_m: float = 0.01  # standard deviation near by
    noise_fraction: float = 0.002  # and what each metre of range adds
    missed_fraction: float = 0.02  # echoes that are not heard for no reason
    cross_talk_fraction: float = 0.002  # readings that take another sonar's sound for their own
    critical_incidence_rad: float = radians(30.0)  # beyond it a smooth wall throws the sound away
    rough_incidence_rad: float = radians(60.0)  # beyond it a rough surface does too
    ray_step_rad: float = radians(1.0)  # the cone's edge is always met; thin things are found whatever this is

    def __post_init__(self) -> None:
        require(0.0 < self.cone_rad <= pi, "cone_rad", self.cone_rad, "(0, pi]")
        require(0.0 < self.max_range_m <= 1000.0, "max_range_m", self.max_range_m, "(0, 1000]")
        require(0.0 < self.ray_step_rad <= pi, "ray_step_rad", self.ray_step_rad, "(0, pi]")
        for key in ("critical_incidence_rad", "rough_incidence_rad"):
            require(0.0 < getattr(self, key) <= pi / 2, key, getattr(self, key), "(0, pi/2]")
        _rate(self.rate_hz)
        _latency(self.latency_s)
        for key in ("noise_m", "noise_fraction", "ring_radius_m"):
            _not_negative(getattr(self, key), key)
        for key in ("missed_fraction", "cross_talk_fraction"):
            _fraction(getattr(self, key), key)
        if bool(self.bearings_deg) == bool(self.mounts):
            raise MissionError("give the sonars' places as 'bearings_deg' or as 'mounts', one of the two")
        count = len(self.bearings_deg) + len(self.mounts)
        require(count <= MAX_SONARS, "number of sonars", count, f"[1, {MAX_SONARS}]")
        for mount in self.mounts:
            require(len(mount) == 3, "mounts", list(mount), "the form [x_m, y_m, heading_deg]")

    def places(self) -> tuple[Pose, ...]:
        """Return robot_from_sonar for each sonar."""
        on_ring = tuple(
            (self.ring_radius_m * cos(radians(b)), self.ring_radius_m * sin(radians(b)), b) for b in self.bearings_deg
        )
        return tuple(
            Pose(x_m=x, y_m=y, heading_rad=wrap_angle(radians(heading))) for x, y, heading in on_ring or self.mounts
        )


@dataclass(frozen=True)
class LaserModel:
    """A scanning laser whose beams cover `field_rad` symmetrically about its heading."""

    beams: int
    field_rad: float
    max_range_m: float
    x_m: float = 0.0
    y_m: float = 0.0
    heading_rad: float = 0.0
    rate_hz: float = 5.0
    latency_s: float = 0.0
    noise_m: float = 0.01
    missed_fraction: float = 0.0

    def __post_init__(self) -> None:
        require(2 <= self.beams <= MAX_BEAMS, "beams", self.beams, f"[2, {MAX_BEAMS}]")
        require(0.0 < self.field_rad <= 2 * pi, "field_rad", self.field_rad, "(0, 2 pi]")
        require(0.0 < self.max_range_m <= 1000.0, "max_range_m", self.max_range_m, "(0, 1000]")
        for key in ("x_m", "y_m"):
            require(abs(getattr(self, key)) <= 100.0, key, getattr(self, key), "[-100, 100]")
        _rate(self.rate_hz)
        _latency(self.latency_s)
        _not_negative(self.noise_m, "noise_m")
        _fraction(self.missed_fraction, "missed_fraction")

    @property
    def step_rad(self) -> float:
        """Angle between two beams; a full circle does not look in its first direction twice."""
        return self.field_rad / (self.beams if self.field_rad > 2 * pi - 1e-6 else self.beams - 1)


@dataclass(frozen=True)
class CameraModel:
    """A camera that tells colours along `field_rad`, symmetrically about its heading."""

    field_rad: float
    max_range_m: float  # further off no colour is told
    x_m: float = 0.0
    y_m: float = 0.0
    heading_rad: float = 0.0
    rays: int = 241  # a quarter of a degree in a field of 60 degrees
    rate_hz: float = 4.0
    latency_s: float = 0.0
    noise_rad: float = radians(0.2)  # standard deviation of where a stretch ends
    missed_fraction: float = 0.05
    false_fraction: float = 0.005  # of the scans show a stretch where there is none

    def __post_init__(self) -> None:
        require(0.0 < self.field_rad <= pi, "field_rad", self.field_rad, "(0, pi]")
        require(0.0 < self.max_range_m <= 1000.0, "max_range_m", self.max_range_m, "(0, 1000]")
        for key in ("x_m", "y_m"):
            require(abs(getattr(self, key)) <= 100.0, key, getattr(self, key), "[-100, 100]")
        require(2 <= self.rays <= MAX_BLOBS, "rays", self.rays, f"[2, {MAX_BLOBS}]")
        _rate(self.rate_hz)
        _latency(self.latency_s)
        _not_negative(self.noise_rad, "noise_rad")
        for key in ("missed_fraction", "false_fraction"):
            _fraction(getattr(self, key), key)


@dataclass(frozen=True)
class BatteryModel:
    """A charge that falls with time and with distance; empty, the robot stands."""

    rate_hz: float = 0.1
    standing_s: float = 28_800.0  # a full charge lasts this long standing still
    driving_m: float = 10_000.0  # and this far if driving were all that it fed

    def __post_init__(self) -> None:
        _rate(self.rate_hz)
        for key in ("standing_s", "driving_m"):
            require(getattr(self, key) > 0.0, key, getattr(self, key), "(0, inf)")
