"""What ways over the grid cost: one wavefront from the robot to everywhere, and one way walked back and straightened.

python benchmarks/routes.py

The maps are those of the shipped worlds, all of them known, on the grid's 5 cm; the robot is the k2a, at the world's start. The
baseline, in the same run, is straightforward: scipy's distance transform, every open cell a node joined to its eight
neighbours with the same costs, scipy's Dijkstra. What ways cost is compared over all places that both reach.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core

from collections.abc import Callable
from math import hypot
from time import process_time

import numpy as np
import numpy.typing as npt
import shapely
from scipy import ndimage
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from blackboard.component import WorldTruth
from blackboard.grid import OCCUPIED_MIN, Grid, KnownPart
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run
from knowledge_sources.ways import wavefront, way_to
from knowledge_sources.ways_params import WaysParams

WORLDS = ("lab", "trap", "office")
CELL_M, RADIUS_M, ROUNDS = 0.05, 0.3, 15
PARAMS = WaysParams()
Floats = npt.NDArray[np.float64]


def world(name: str) -> tuple[WorldTruth, tuple[float, float]]:
    """Return a world and where the robot starts in it."""
    run = Run(load_mission(find_mission("wander-lab"), {"robot": {"world": name}}))
    truth, pose = run.robot.truth(), run.robot.true_pose()
    assert truth is not None
    assert pose is not None
    return truth, (pose.x_m, pose.y_m)


def drawn(truth: WorldTruth) -> KnownPart:
    """Return the grid of a world that is known all over."""
    grid = Grid(CELL_M)
    x0, y0, x1, y1 = truth.floor.bounds
    grid.cover(x0 - 0.2, y0 - 0.2, x1 + 0.2, y1 + 0.2)
    rows, columns = grid.cells.shape
    x, y = np.meshgrid(
        grid.x_min_m + (np.arange(columns) + 0.5) * CELL_M, grid.y_min_m + (np.arange(rows) + 0.5) * CELL_M
    )
    half = CELL_M / 2 - 1e-6
    touched = shapely.intersects(truth.solid, shapely.box(x - half, y - half, x + half, y + half))
    grid.cells[:] = np.where(touched | ~shapely.contains_xy(truth.floor, x, y), 255, 0)
    known = grid.known_part()
    assert known is not None
    return known


def plain(known: KnownPart, start: tuple[float, float]) -> tuple[Floats, npt.NDArray[np.int64]]:
    """Return what the cheapest way to every open cell costs, and these cells (n, 2) row, column."""
    away_m = ndimage.distance_transform_edt(known.cells < OCCUPIED_MIN) * known.cell_m
    open_ = away_m > RADIUS_M + 1e-6
    cost = 1.0 + PARAMS.near_cost * np.maximum(RADIUS_M + PARAMS.comfort_m - away_m, 0.0) / PARAMS.comfort_m
    cells = np.argwhere(open_)
    number = np.full(open_.shape, -1)
    number[open_] = np.arange(len(cells))
    first, second, costs = [], [], []
    height, width = open_.shape
    for dr, dc in ((0, 1), (1, -1), (1, 0), (1, 1)):
        a = number[: height - dr, max(0, -dc) : width - max(0, dc)]
        b = number[dr:, max(0, dc) : width + min(0, dc)]
        both = (a >= 0) & (b >= 0)
        first.append(a[both])
        second.append(b[both])
        there, here = cells[second[-1]], cells[first[-1]]
        step = hypot(dr, dc) * known.cell_m
        costs.append(0.5 * step * (cost[there[:, 0], there[:, 1]] + cost[here[:, 0], here[:, 1]]))
    joined = (np.concatenate(costs), (np.concatenate(first), np.concatenate(second)))
    graph = coo_matrix(joined, shape=(len(cells), len(cells))).tocsr()
    row, column = int((start[1] - known.y_min_m) / known.cell_m), int((start[0] - known.x_min_m) / known.cell_m)
    return dijkstra(graph, directed=False, indices=number[row, column]), cells


def least_ms(call: Callable[[], object]) -> float:
    """Return the least CPU time of some calls."""
    taken = []
    for _ in range(ROUNDS):
        started = process_time()
        call()
        taken.append(process_time() - started)
    return 1e3 * min(taken)


def row(name: str) -> str:
    """Measure in one world and return a line of the table."""
    truth, start = world(name)
    known = drawn(truth)
    front = wavefront(known, RADIUS_M, start, PARAMS)
    costs, cells = plain(known, start)
    by_cell = np.full(known.cells.shape, np.inf)
    by_cell[cells[:, 0], cells[:, 1]] = costs
    plainly = by_cell[front.rows, front.columns]
    compared = np.isfinite(front.cost) & np.isfinite(plainly) & (plainly > 1.0)
    shares = front.cost[compared] / plainly[compared]
    farthest = int(np.argmax(np.where(np.isfinite(front.cost), front.cost, 0.0)))
    goal = front.room.centre(int(front.rows[farthest]), int(front.columns[farthest]))
    ours_ms = least_ms(lambda: wavefront(known, RADIUS_M, start, PARAMS))
    plain_ms = least_ms(lambda: plain(known, start))
    way_ms = least_ms(lambda: way_to(front, goal, 0.0))
    return (
        f"{name:8}{truth.floor.area:9.0f}{ours_ms:15.1f}{plain_ms:11.1f}{plain_ms / ours_ms:8.1f}{way_ms:11.1f}"
        f"   median {np.median(shares):.3f}, most {shares.max():.3f}"
    )


def main() -> None:
    print("world    floor m2   wavefront ms   plain ms   ratio   a way ms   cost of ways, ours / plain")
    for name in WORLDS:
        print(row(name))


if __name__ == "__main__":
    main()
