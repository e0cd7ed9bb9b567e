"""What the robot knows of its world: the occupancy grid, points, lines."""

from typing import Annotated

from msgspec import Meta

from blackboard.messages.base import Angle, Count, Length, Message
from blackboard.messages.geometry import PackedArray, Point, check_array

TILE_CELLS = 64  # a grid tile is this many cells wide and high


class GridTile(Message, frozen=True, kw_only=True):
    """A square piece of the empty-occupied-unknown grid, map frame.

    `cells` is uint8 (TILE_CELLS, TILE_CELLS), row by row from low y, each row from low x: 0 empty, 128 unknown, 255 occupied.
    Cell (row r, column c) of tile (column, row) covers x from (column * TILE_CELLS + c) * cell_m, and y likewise.
    """

    column: Annotated[int, Meta(ge=-100_000, le=100_000)]
    row: Annotated[int, Meta(ge=-100_000, le=100_000)]
    cell_m: Annotated[float, Meta(gt=0.0, le=10.0)]
    cells: PackedArray

    def __post_init__(self) -> None:
        check_array(self.cells, "uint8", (TILE_CELLS, TILE_CELLS), "cells")

    def extent(self) -> tuple[float, float, float, float]:
        side_m = TILE_CELLS * self.cell_m
        return (self.column * side_m, self.row * side_m, (self.column + 1) * side_m, (self.row + 1) * side_m)


class PointSet(Message, frozen=True, kw_only=True):
    """Range readings as points, map frame: float32 (n, 2), metres.

    `sensed_from` is float32 (n, 2): where the sensor stood for each point. `half_cone_rad` is float32 (n,): half the width
    of the cone that the point was heard in (0 for a laser beam). Where nobody knows where the sensor stood, it is the point itself.
    """

    points: PackedArray
    sensed_from: PackedArray
    half_cone_rad: PackedArray
    dropped: Count = 0

    def __post_init__(self) -> None:
        check_array(self.points, "float32", (None, 2), "points")
        check_array(self.sensed_from, "float32", (self.points.shape[0], 2), "sensed_from")
        check_array(self.half_cone_rad, "float32", (self.points.shape[0],), "half_cone_rad")


class Line(Message, frozen=True, kw_only=True):
    """A straight piece of a wall, map frame, from `start` to `end`.

    Its carrier is x cos(alpha) + y sin(alpha) = rho with rho >= 0; `sigma_rho_m` is the largest distance of an admitted
    point from it (Bou-Ghannam 1992, section 5.2.3, step 6), `support` the number of points.
    """

    start: Point
    end: Point
    alpha_rad: Angle
    rho_m: Length
    sigma_rho_m: Length
    support: Count

    def extent(self) -> tuple[float, float, float, float]:
        xs, ys = (self.start.x_m, self.end.x_m), (self.start.y_m, self.end.y_m)
        return (min(xs), min(ys), max(xs), max(ys))
