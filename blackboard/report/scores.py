"""How good a map is against the world as it is. Only a simulated world can be asked; the robot never is.

Which wall can give a line: a straight edge of the free floor of at least MIN_WALL_M. Shorter ones (ends of thin things, the
facets of drums and pillars) are not asked for, but a line that lies on one is no false line.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import shapely
from shapely.affinity import affine_transform

from blackboard.component import WorldTruth
from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN
from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import RobotDescription
from blackboard.messages.world import Line
from blackboard.report.pose_scores import fitted_frame
from blackboard.report.result import GridView, RunResult, Trajectory, segments
from blackboard.report.visibility import viewpoints, visible
from blackboard.report.walls import Segments, free_floor, sample, surface, wall_edges

SURFACE_M = 0.10  # an occupied cell is right this near to a surface: two cells
LINE_M = 0.05  # a line lies on a wall within this distance ...
LINE_RAD = np.deg2rad(3.0)  # ... and this angle
SAMPLE_M = 0.05  # walls and lines are compared piece by piece, each no longer than this
MIN_WALL_M = 0.5  # no shorter straight edge is asked for: a sonar hears it as a point


@dataclass(frozen=True, kw_only=True)
class GridScore:
    """Of the cells that the grid decided, the fraction that is right; None where nothing was decided."""

    decided: int
    right_fraction: float | None
    occupied: int
    occupied_right_fraction: float | None
    empty: int
    empty_right_fraction: float | None


@dataclass(frozen=True, kw_only=True)
class LineScore:
    """Of the wall length that was visible, the fraction found; of the length of all lines, the fraction on no wall.

    None where no wall was visible, or where there are no lines.
    """

    visible_m: float
    found_fraction: float | None
    lines_m: float
    spurious_fraction: float | None


def grid_score(grid: GridView, truth: WorldTruth) -> GridScore:
    """Score the decided cells by their centres.

    An occupied cell is right within SURFACE_M of a surface, on either side; an empty one on free floor, or within half a
    cell of it.
    """
    occupied = _centres(grid, grid.cells >= OCCUPIED_MIN)
    empty = _centres(grid, grid.cells <= EMPTY_MAX)
    right_occupied = _within(occupied, surface(truth), SURFACE_M)
    right_empty = _within(empty, free_floor(truth), grid.cell_m / 2)
    return GridScore(
        decided=len(occupied) + len(empty),
        right_fraction=_fraction(right_occupied + right_empty, len(occupied) + len(empty)),
        occupied=len(occupied),
        occupied_right_fraction=_fraction(right_occupied, len(occupied)),
        empty=len(empty),
        empty_right_fraction=_fraction(right_empty, len(empty)),
    )


def line_score(lines: list[Line], truth: WorldTruth, trajectory: Trajectory, range_m: float) -> LineScore:
    """Score lines against the walls that could be seen within `range_m` from the trajectory (the true one), all around.

    Wall and line are sampled every SAMPLE_M; a sample counts as covered within LINE_M and LINE_RAD of the other.
    """
    edges = wall_edges(truth)
    lengths = np.hypot(edges[:, 2] - edges[:, 0], edges[:, 3] - edges[:, 1])
    walls = sample(edges[lengths >= MIN_WALL_M], SAMPLE_M)
    seen = visible(walls, edges, viewpoints(trajectory), range_m)
    ends = segments(lines)
    ends = ends[(ends[:, :2] != ends[:, 2:]).any(axis=1)]
    found = seen.copy()
    found[seen] = covered(walls.points[seen], walls.directions[seen], ends, LINE_M, LINE_RAD)
    drawn = sample(ends, SAMPLE_M)
    spurious = ~covered(drawn.points, drawn.directions, edges, LINE_M, LINE_RAD)
    visible_m, lines_m = float(walls.weights_m[seen].sum()), float(drawn.weights_m.sum())
    return LineScore(
        visible_m=visible_m,
        found_fraction=_fraction(float(walls.weights_m[found].sum()), visible_m),
        lines_m=lines_m,
        spurious_fraction=_fraction(float(drawn.weights_m[spurious].sum()), lines_m),
    )


def covered(
    points: npt.NDArray[np.float64],
    directions: npt.NDArray[np.float64],
    ends: Segments,
    distance_m: float,
    angle_rad: float,
) -> npt.NDArray[np.bool_]:
    """Return which points (n, 2) lie no further than this from a segment whose direction differs no more from theirs."""
    found = np.zeros(len(points), dtype=np.bool_)
    tree = shapely.STRtree(shapely.points(points))
    drawn = shapely.linestrings(ends.reshape(-1, 2, 2))
    end, point = tree.query(
        drawn, predicate="dwithin", distance=distance_m + 1e-9
    )  # every pair that is near, (k,) each
    spans = ends[end, 2:] - ends[end, :2]
    sine = directions[point, 0] * spans[:, 1] - directions[point, 1] * spans[:, 0]
    parallel = np.abs(sine) <= np.hypot(spans[:, 0], spans[:, 1]) * np.sin(angle_rad + 1e-9)
    found[point[parallel]] = True
    return found


def area_decided(
    grid: GridView | None, truth: WorldTruth, place: Pose, radius_m: float = 0.0, map_from_world: Pose = IDENTITY
) -> float:
    """Return the fraction of the reachable free floor that the grid decided, by cell centres.

    Reachable is what a disc of `radius_m` can cover on its way from `place` (true), whether it could see it or not. 0 where
    nothing is reachable. `map_from_world` lays the world on the grid: unless given the grid is taken as it lies, and what drift
    moved off the floor is not decided.
    """
    parts = shapely.get_parts(shapely.buffer(free_floor(truth), -radius_m))
    mine = [part for part in parts if shapely.distance(part, shapely.Point(place.x_m, place.y_m)) <= SURFACE_M]
    if grid is None or not mine:
        return 0.0
    reachable = _laid(shapely.buffer(shapely.union_all(mine), radius_m), map_from_world)
    x0, y0, x1, y1 = shapely.bounds(reachable)
    columns = np.arange(np.floor((x0 - grid.x_min_m) / grid.cell_m), np.ceil((x1 - grid.x_min_m) / grid.cell_m))
    rows = np.arange(np.floor((y0 - grid.y_min_m) / grid.cell_m), np.ceil((y1 - grid.y_min_m) / grid.cell_m))
    column, row = (a.ravel().astype(np.int64) for a in np.meshgrid(columns, rows))
    shapely.prepare(reachable)
    x_m, y_m = grid.x_min_m + (column + 0.5) * grid.cell_m, grid.y_min_m + (row + 0.5) * grid.cell_m
    asked = shapely.contains_xy(reachable, x_m, y_m)
    column, row = column[asked], row[asked]
    inside = (row >= 0) & (row < grid.cells.shape[0]) & (column >= 0) & (column < grid.cells.shape[1])
    values = grid.cells[row[inside], column[inside]]
    decided = int(((values >= OCCUPIED_MIN) | (values <= EMPTY_MAX)).sum())
    return _fraction(decided, len(row)) or 0.0


def _laid(geometry: shapely.Geometry, map_from_world: Pose) -> shapely.Geometry:
    c, s = np.cos(map_from_world.heading_rad), np.sin(map_from_world.heading_rad)
    return affine_transform(geometry, (c, -s, s, c, map_from_world.x_m, map_from_world.y_m))


def sensing_range_m(robot: RobotDescription) -> float:
    """Return how far the robot's farthest-reaching range sensor sees; 0 without any."""
    sonars, lasers = [s.max_range_m for s in robot.sonars], [s.max_range_m for s in robot.lasers]
    return max(sonars + lasers, default=0.0)


def score_table(result: RunResult) -> dict[str, float]:
    """Return the rows about the map's quality for the table at the end; none where there is no truth."""
    if result.truth is None:
        return {}
    scores: dict[str, float | None] = {}
    path = result.trajectory if result.true_trajectory is None else result.true_trajectory
    if result.grid is not None:
        scores["grid_right_fraction"] = grid_score(result.grid, result.truth).right_fraction
        if len(path):
            # where it ends, in the world as it is then: a door that was closed for good leaves the side that it is on
            last = Pose(x_m=float(path[-1, 1]), y_m=float(path[-1, 2]), heading_rad=0.0)
            radius_m = result.robot.radius_m
            scores["reachable_decided_fraction"] = area_decided(result.grid, result.truth, last, radius_m)
            if result.true_trajectory is not None and len(result.trajectory):
                frame = fitted_frame(result.trajectory, result.true_trajectory)
                fraction = area_decided(result.grid, result.truth, last, radius_m, frame)
                scores["reachable_decided_aligned_fraction"] = fraction
    if result.lines:
        lines = line_score([e.value for e in result.lines], result.truth, path, sensing_range_m(result.robot))
        scores["walls_found_fraction"] = lines.found_fraction
        scores["lines_spurious_fraction"] = lines.spurious_fraction
    return {name: value for name, value in scores.items() if value is not None}


def _centres(grid: GridView, chosen: npt.NDArray[np.bool_]) -> npt.NDArray[np.float64]:
    rows, columns = np.nonzero(chosen)
    return np.stack([columns + 0.5, rows + 0.5], axis=1) * grid.cell_m + (grid.x_min_m, grid.y_min_m)


def _within(points: npt.NDArray[np.float64], geometry: shapely.Geometry, distance_m: float) -> int:
    """Return how many points (n, 2) lie no further than this from the geometry."""
    shapely.prepare(geometry)
    return int(shapely.dwithin(geometry, shapely.points(points), distance_m + 1e-9).sum())


def _fraction(part: float, whole: float) -> float | None:
    return part / whole if whole > 0 else None
