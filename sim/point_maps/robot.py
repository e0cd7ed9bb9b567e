"""A map of points as a robot that has seen it all at once: nobody knows where from.

Posts  observations/feature/supported_points    PointSet, once: one point a cell, `sensed_from` being the point itself
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from blackboard.component import Reading, Robot
from blackboard.errors import RecordingError
from blackboard.kinds import SUPPORTED_POINTS
from blackboard.messages.geometry import pack_array
from blackboard.messages.sensing import RobotDescription
from blackboard.messages.world import PointSet
from blackboard.parameters import require
from sim.point_maps.reading import read_points
from sim.robot_file import load_robot

MOST_CELLS = 1_000_000  # what one message holds


@dataclass(frozen=True, slots=True, kw_only=True)
class PointMapParams:
    """Which file, whose robot drives there, and how closely points are kept."""

    path: Path
    robot: Path | None = None  # its size says which gaps it could pass
    radius_m: float | None = None  # None: the robot file's, else 0.25, between a Pioneer (0.26) and a Roomba (0.17)
    cell_m: float = 0.02  # points closer to each other than a laser errs tell the same again

    def __post_init__(self) -> None:
        require(self.radius_m is None or 0 < self.radius_m <= 100, "radius_m", self.radius_m, "(0, 100] m")
        require(0.001 <= self.cell_m <= 1.0, "cell_m", self.cell_m, "[0.001, 1] m")


def one_a_cell(points: npt.NDArray[np.float64], cell_m: float) -> npt.NDArray[np.float64]:
    """Return the first of the points (n, 2) in each cell, in the order of the file."""
    cells = np.floor(
        points / cell_m + 1e-6
    )  # points on a grid of the cell's size do not fall on both sides of its border
    return points[np.sort(np.unique(cells, axis=0, return_index=True)[1])]


class PointMap(Robot[PointMapParams]):
    """Gives the points of a file; raises RecordingError where it cannot be used."""

    Params = PointMapParams
    provides = (SUPPORTED_POINTS,)

    def __init__(self, params: PointMapParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._file = read_points(params.path)
        self._points = one_a_cell(self._file.points, params.cell_m)
        if len(self._points) > MOST_CELLS:
            raise RecordingError(
                f"{params.path}: its points fill {len(self._points)} cells of {params.cell_m:g} m, over the limit of "
                f"{MOST_CELLS}; set cell_m larger"
            )
        body = load_robot(params.robot).description() if params.robot is not None else None
        self._description = RobotDescription(
            name=re.sub(r"[^A-Za-z0-9_-]", "_", params.path.name.split(".")[0]) or "points",
            radius_m=params.radius_m or (body.radius_m if body is not None else 0.25),
            max_speed_mps=1.0,
            max_turn_radps=1.0,
            max_acceleration_mps2=1.0,
        )
        self._told = False

    @property
    def description(self) -> RobotDescription:
        return self._description

    @property
    def end_s(self) -> float:
        return 0.0

    @property
    def moves(self) -> bool:
        return False

    def advance(self, until_s: float) -> Iterator[Reading[Any]]:
        """Yield the points, once."""
        if not self._told:
            self._told = True
            points = pack_array(np.ascontiguousarray(self._points, dtype=np.float32))
            half_cones = pack_array(np.zeros(len(self._points), dtype=np.float32))
            value = PointSet(points=points, sensed_from=points, half_cone_rad=half_cones)
            yield Reading(SUPPORTED_POINTS, 0.0, value)

    def drawn_lines(self) -> npt.NDArray[np.float64] | None:
        return self._file.lines if len(self._file.lines) else None

    def summary(self) -> dict[str, float | int | str]:
        """Return how many points the file holds, and how many are left of them."""
        return {"points_read": len(self._file.points), "points": len(self._points)}
