"""Thins a laser to a ring of sonar cones: each cone hears the nearest of its beams.

The cones share the laser's field of view equally. What comes out stands in for sonars with real geometry and real odometry,
but without specular loss or cross-talk.
"""

from dataclasses import dataclass
from math import pi

import numpy as np
import numpy.typing as npt

from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.sensing import LaserSensor, SonarSensor
from sim.recordings.ranges import Ranges


@dataclass(frozen=True, slots=True)
class Fan:
    """Where a laser's beams look: beam i along `angle_min_rad + i * angle_step_rad` in the laser's frame."""

    angle_min_rad: float
    angle_step_rad: float
    beams: int

    @property
    def edge_rad(self) -> float:
        """Where the first beam's share of the field of view begins: half a step before it."""
        return self.angle_min_rad - self.angle_step_rad / 2

    @property
    def width_rad(self) -> float:
        """The whole field of view, half a step beyond the outer beams; negative where the beams run clockwise."""
        return self.angle_step_rad * self.beams


def cone_sensors(fan: Fan, cones: int, laser: LaserSensor) -> tuple[SonarSensor, ...]:
    """Return the sonars that `cones` equal shares of the laser's field of view amount to, in the order of its beams."""
    width_rad = fan.width_rad / cones
    return tuple(
        SonarSensor(
            mount=laser.mount @ Pose(x_m=0.0, y_m=0.0, heading_rad=wrap_angle(fan.edge_rad + (cone + 0.5) * width_rad)),
            cone_rad=min(abs(width_rad), 2 * pi),
            max_range_m=laser.max_range_m,
        )
        for cone in range(cones)
    )


def cone_of_beams(scan: Fan, fan: Fan, cones: int) -> npt.NDArray[np.intp]:
    """Return the cone of each beam of a scan, (beams,); -1 for beams outside the field of view that the cones share.

    The cones are laid out on `fan`; a scan whose beams lie otherwise falls into them by angle.
    """
    angles_rad = scan.angle_min_rad + scan.angle_step_rad * np.arange(scan.beams)
    share = (angles_rad - fan.edge_rad) / (fan.width_rad / cones)
    cone: npt.NDArray[np.intp] = np.floor(share + 1e-9).astype(
        np.intp
    )  # a beam on an edge belongs to the later cone, whatever the rounding
    cone[(cone < 0) | (cone >= cones)] = -1
    return cone


def thin(ranges: Ranges, cone_of_beam: npt.NDArray[np.intp], cones: int) -> Ranges:
    """Return the nearest echo in each cone, (cones,): infinity where no beam returned, NaN where no beam was fit."""
    nearest = np.full(cones, np.nan)
    inside = cone_of_beam >= 0
    np.fmin.at(nearest, cone_of_beam[inside], ranges[inside])  # fmin passes over NaN
    return nearest
