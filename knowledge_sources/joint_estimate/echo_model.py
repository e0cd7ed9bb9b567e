"""Which echoes the lines would give, and how they answer to the state.

A wall is heard where it is nearest within the cone: along its normal if that lies in the cone, else along the edge of the cone
that is nearer to it, as long as the wall does not throw the sound away (Leonard and Durrant-Whyte 1992, chapter 2). A beam of a
laser is a cone of no width. With D the distance of the wall's carrier from the sensor and e the angle between the normal and the
cone: r = D / cos e.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from blackboard.uncertainty.matrices import Array
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import LATENCY, LINES, JointState, X

NEAREST_M = 0.05  # a sensor does not hear what it touches


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LineTable:
    """The lines of a state as columns, (n,) each."""

    theta_rad: Array
    offset_m: Array
    anchor_x_m: Array
    anchor_y_m: Array
    from_m: Array
    to_m: Array
    side: Array  # 1: faces left, -1: right

    @staticmethod
    def of(state: JointState) -> "LineTable":
        """Return the table of all lines of the state."""
        rows = [(e.anchor_x_m, e.anchor_y_m, e.from_m, e.to_m, 1.0 if e.faces_left else -1.0) for e in state.lines]
        columns = np.array(rows).reshape(len(rows), 5).T
        lines = state.mean[LINES:].reshape(-1, 2)
        return LineTable(
            theta_rad=lines[:, 0],
            offset_m=lines[:, 1],
            anchor_x_m=columns[0],
            anchor_y_m=columns[1],
            from_m=columns[2],
            to_m=columns[3],
            side=columns[4],
        )

    @property
    def length_m(self) -> Array:
        return self.to_m - self.from_m

    def only(self, number: int) -> "LineTable":
        """Return the table of one line."""
        return LineTable(**{name: getattr(self, name)[number : number + 1] for name in self.__dataclass_fields__})


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cones:
    """Sensors that fired: places in the robot's frame (m,), directions there, half widths, and the motion of the robot."""

    x_m: Array
    y_m: Array
    bearing_rad: Array
    half_rad: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Predicted:
    """Echoes of every line in every cone, (m, n): ranges (inf: none), and what their derivatives are made of."""

    ranges_m: Array
    edge_rad: Array  # angle between the wall's normal and the cone, 0 where the normal lies in it
    turn: Array  # by how much the edge's angle grows as the cone turns: 0, 1 or -1
    distance_m: Array  # of the carrier
    place_x_m: Array  # (m,) of the sensors, map frame
    place_y_m: Array


def predict(state: JointState, table: LineTable, cones: Cones, params: JointLinesParams, at: int = X) -> Predicted:
    """Return the echo of each line in each cone, were the line alone; the pose stands at `at` in the mean."""
    x, y, heading = state.mean[at : at + 3].tolist()
    c, s = np.cos(heading), np.sin(heading)
    px, py = x + c * cones.x_m - s * cones.y_m, y + s * cones.x_m + c * cones.y_m
    nx, ny = np.sin(table.theta_rad), -np.cos(table.theta_rad)
    away_x, away_y = px[:, None] - table.anchor_x_m, py[:, None] - table.anchor_y_m
    distance = table.side * (table.offset_m - away_x * nx - away_y * ny)
    towards = np.arctan2(table.side * ny, table.side * nx)  # from the sensor to the wall
    axis = heading + cones.bearing_rad
    off = _wrapped(axis[:, None] - towards)
    over = np.abs(off) - cones.half_rad[:, None]
    edge = np.maximum(over, 0.0)
    turn = np.where(over > 0.0, np.sign(off), 0.0)
    limit = np.minimum(params.incidence_rad, 1.5)
    ranges = np.where((edge <= limit) & (distance > NEAREST_M), distance / np.cos(np.minimum(edge, limit)), np.inf)
    bearing = towards + turn * edge
    reach = np.where(np.isfinite(ranges), ranges, 0.0)
    along = (away_x + reach * np.cos(bearing)) * -ny + (away_y + reach * np.sin(bearing)) * nx
    margin = params.end_margin_m
    on_it = (along >= table.from_m - margin) & (along <= table.to_m + margin)
    ranges = np.where(on_it, ranges, np.inf)
    return Predicted(ranges_m=ranges, edge_rad=edge, turn=turn, distance_m=distance, place_x_m=px, place_y_m=py)


def variances(
    predicted: Predicted, cones: Cones, cone: npt.NDArray[np.intp], line: npt.NDArray[np.intp], params: JointLinesParams
) -> Array:
    """Return the variance (k,) of an echo of these lines in these cones: the sensor's, and what the cone's width is wrong by."""
    ranges, edge = predicted.ranges_m[cone, line], predicted.edge_rad[cone, line]
    own = params.range_sigma_m + params.range_sigma_fraction * ranges
    width = ranges * np.tan(edge) * params.cone_sigma_fraction * cones.half_rad[cone]
    found: Array = own**2 + width**2
    return found


def derivatives(
    state: JointState,
    table: LineTable,
    predicted: Predicted,
    cone: npt.NDArray[np.intp],
    line: npt.NDArray[np.intp],
    motion: tuple[float, float, float],
    at: int = X,
    first_line: int = 0,
) -> Array:
    """Return H (k, n): how the echoes of these lines in these cones answer to the state.

    The pose stands at `at` in the mean, and the table begins with line `first_line`.

    `motion` is the speed of map_from_robot (x, y, heading): a latency means that the robot was elsewhere when it heard.
    """
    k = np.arange(len(cone))
    theta, side = table.theta_rad[line], table.side[line]
    nx, ny = np.sin(theta), -np.cos(theta)
    px, py = predicted.place_x_m[cone], predicted.place_y_m[cone]
    edge, ranges = predicted.edge_rad[cone, line], predicted.ranges_m[cone, line]
    widening = 1.0 / np.cos(edge)
    turning = ranges * np.tan(edge) * predicted.turn[cone, line]
    h = np.zeros((len(cone), len(state.mean)))
    h[:, at], h[:, at + 1] = -side * nx * widening, -side * ny * widening
    lever_x, lever_y = -(py - state.mean[at + 1]), px - state.mean[at]
    h[:, at + 2] = -side * (nx * lever_x + ny * lever_y) * widening + turning
    h[:, LATENCY] = -(h[:, at : at + 3] @ np.array(motion))
    along = (px - table.anchor_x_m[line]) * -ny + (py - table.anchor_y_m[line]) * nx
    h[k, LINES + 2 * (first_line + line)] = -side * along * widening - turning
    h[k, LINES + 2 * (first_line + line) + 1] = side * widening
    return h


def _wrapped(angle_rad: Array) -> Array:
    wrapped: Array = (angle_rad + np.pi) % (2.0 * np.pi) - np.pi
    return wrapped
