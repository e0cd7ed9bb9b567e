"""Ways for a round robot over the floor that the grid knows to be empty: one wavefront from the robot serves every goal.

The wavefront runs over blocks of cells, each stood for by its cell with the most room, so that a gap one cell wide stays open; two
neighbouring blocks are joined where the straight way between those cells is open. Walking back from a goal gives its way, which
is then straightened wherever the straight line costs no more.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import ceil, hypot

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from blackboard.grid import KnownPart
from knowledge_sources.room_to_move import Floats, Room, room_to_move
from knowledge_sources.ways_params import WaysParams

Indices = npt.NDArray[np.int64]
Place = tuple[float, float]
NEIGHBOURS = ((0, 1), (1, -1), (1, 0), (1, 1))  # half of them: each pair once
NO_NODE = -1
ROOM_SAMPLES = 5  # along a step of a way: as near to each other as cells
CLIPPED = 10.0  # more for each metre of a step between two blocks that grazes the corner of a closed cell
LITTLE = 1.02  # a straight line that costs so much more is as cheap: costs are summed over cells


@dataclass(frozen=True, eq=False)
class Wavefront:
    """How far it is from the robot to every block that it can reach.

    `rows` and `columns` are the cells that stand for the blocks; `cost` is that of the cheapest way there (inf: none),
    `length_m` how long it is, `before` the block before it on the way (negative: none).
    """

    room: Room
    start: Place
    rows: Indices
    columns: Indices
    cost: Floats
    length_m: Floats
    before: npt.NDArray[np.int32]

    def places(self) -> Floats:
        """Return where the blocks' cells lie, (n, 2) m, map frame."""
        x, y = self.room.centre(self.rows, self.columns)  # type: ignore[arg-type]
        return np.stack([x, y], axis=1)


@dataclass(frozen=True, eq=False)
class Way:
    """A way by its corners, from where the robot stands to where it ends: (n, 2) m, map frame."""

    corners: Floats
    length_m: float


def wavefront(known: KnownPart, radius_m: float, start: Place, params: WaysParams) -> Wavefront:
    """Return how far it is from `start` to everywhere, for a robot of this radius that stands there."""
    room = room_to_move(known, radius_m, start, params)
    blocks = _blocks(room, max(1, round(params.block_m / room.cell_m)))
    rows, columns = blocks.rows, blocks.columns
    first = _start_node(room, rows, columns, start)
    if first is None:
        nowhere = np.full(len(rows), np.inf)
        return Wavefront(room, start, rows, columns, nowhere, nowhere, np.full(len(rows), NO_NODE, np.int32))
    graph = _graph(room, blocks)
    cost, before = dijkstra(graph, directed=False, indices=first, return_predecessors=True)
    x_m, y_m = room.centre(int(rows[first]), int(columns[first]))
    length_m = hypot(x_m - start[0], y_m - start[1]) + _lengths(room, rows, columns, before)
    length_m[~np.isfinite(cost)] = np.inf
    return Wavefront(room, start, rows, columns, cost, length_m, before)


def node_near(front: Wavefront, goal: Place, reach_m: float) -> int | None:
    """Return the block that the robot can reach whose cell lies nearest to a place, at most reach_m away."""
    away = np.hypot(*(front.places() - goal).T)
    away[~np.isfinite(front.cost)] = np.inf
    if not len(away):
        return None
    best = int(np.argmin(away))
    return best if away[best] <= reach_m else None


def way_to(front: Wavefront, goal: Place, reach_m: float) -> Way | None:
    """Return the way to a goal, or to the reachable place nearest to it within reach_m; None where there is none."""
    room = front.room
    node = node_near(front, goal, max(reach_m, room.cell_m * 2))
    if node is None:
        return None
    nodes = [node]
    while (node := int(front.before[node])) >= 0:
        nodes.append(node)
    nodes.reverse()
    corners = front.places()[nodes]
    if room.is_open(*goal) and straight_cost(room, corners[-1], np.array(goal)) < np.inf:
        corners = np.vstack([corners, goal])
    if straight_cost(room, np.array(front.start), corners[0]) < np.inf:
        corners = np.vstack([front.start, corners])
    corners = straightened(room, corners)
    return Way(corners, float(np.hypot(*np.diff(corners, axis=0).T).sum()))


def with_room(room: Room, corners: Floats, radius_m: float, step_m: float) -> Floats:
    """Return a way cut into steps: (n, 3) x and y of each point, and how far the nearest thing lies from the rim up to the next, m.

    No further than `comfort_m` of the parameters is measured; a robot that still leaves a thing's neighbourhood has no room.
    """
    rows = []
    for a, b in pairwise(corners):
        count = max(1, ceil(float(np.hypot(*(b - a))) / step_m))
        points = a + np.linspace(0.0, 1.0, count * ROOM_SAMPLES + 1)[:, None] * (b - a)
        cells = [
            np.floor((points[:, i] - low) / room.cell_m).astype(np.int64)
            for i, low in ((1, room.y_min_m), (0, room.x_min_m))
        ]
        around_m = np.sqrt(room.squares[cells[0], cells[1]]) * room.cell_m - radius_m
        pieces = np.stack([around_m[i : i + count * ROOM_SAMPLES : ROOM_SAMPLES] for i in range(ROOM_SAMPLES)])
        rows.append(np.column_stack([points[:-1:ROOM_SAMPLES], np.maximum(pieces.min(axis=0), 0.0)]))
    last = rows[-1][-1, 2] if rows else 0.0
    rows.append(np.array([[*corners[-1], last]]))
    return np.concatenate(rows)


def straight_cost(room: Room, start: Floats, end: Floats) -> float:
    """Return what the straight way between two places costs; infinity where it is not open."""
    length_m = float(np.hypot(*(end - start)))
    count = ceil(length_m / (room.cell_m / 2)) + 1
    points = start + np.linspace(0.0, 1.0, count)[:, None] * (end - start)
    columns = np.floor((points[:, 0] - room.x_min_m) / room.cell_m).astype(np.int64)
    rows = np.floor((points[:, 1] - room.y_min_m) / room.cell_m).astype(np.int64)
    height, width = room.open.shape
    if rows.min() < 0 or columns.min() < 0 or rows.max() >= height or columns.max() >= width:
        return np.inf
    if not room.open[rows, columns].all():
        return np.inf
    costs = room.cost[rows, columns]
    return length_m * (float(costs.sum()) - 0.5 * float(costs[0] + costs[-1])) / max(count - 1, 1)


def cost_of(room: Room, corners: Floats) -> float:
    """Return what a way with these corners costs; infinity where it is not open."""
    return sum((straight_cost(room, a, b) for a, b in pairwise(corners)), 0.0)


def nearest_on(corners: Floats, place: Place) -> tuple[float, Floats]:
    """Return how far a place lies from a way, and what of the way is left from the point of it that lies nearest."""
    starts, steps = corners[:-1], np.diff(corners, axis=0)
    if not len(steps):
        return float(np.hypot(*(corners[0] - place))), corners
    squares = np.maximum((steps**2).sum(axis=1), 1e-12)
    share = np.clip(((place - starts) * steps).sum(axis=1) / squares, 0.0, 1.0)
    feet = starts + share[:, None] * steps
    away = np.hypot(*(feet - place).T)
    nearest = int(np.argmin(away))
    return float(away[nearest]), np.vstack([feet[nearest], corners[nearest + 1 :]])


def straightened(room: Room, corners: Floats) -> Floats:
    """Return a way with corners left out where the straight line between those that stay costs no more than the way did."""
    steps_m = np.hypot(*np.diff(corners, axis=0).T)
    pieces = [straight_cost(room, a, b) for a, b in pairwise(corners)]
    pieces = [p if p < np.inf else m * (1.0 + CLIPPED) for p, m in zip(pieces, steps_m.tolist(), strict=True)]
    until = np.concatenate([[0.0], np.cumsum(pieces)])  # what the way costs up to each corner
    kept, at = [0], 0
    while at < len(corners) - 1:
        best, step = at + 1, 2
        while at + step < len(corners) and _no_dearer(room, corners, until, at, at + step):
            best, step = at + step, step * 2
        low, high = best, min(at + step, len(corners))
        while high - low > 1:  # between the last that was cheap and the first that was not
            middle = (low + high) // 2
            if _no_dearer(room, corners, until, at, middle):
                low = middle
            else:
                high = middle
        kept.append(low)
        at = low
    return corners[kept]


def _no_dearer(room: Room, corners: Floats, until: Floats, a: int, b: int) -> bool:
    return straight_cost(room, corners[a], corners[b]) <= LITTLE * float(until[b] - until[a])


@dataclass(frozen=True, eq=False)
class _Blocks:
    """The blocks with an open cell: the cells that stand for them, and by row and column of blocks, with a rim of none, their
    numbers. In the midst of a `deep` one's neighbours all is open.
    """

    rows: Indices
    columns: Indices
    number: Indices
    deep: npt.NDArray[np.bool_]


def _blocks(room: Room, side: int) -> _Blocks:
    height, width = (ceil(n / side) for n in room.open.shape)
    value = np.zeros((height * side, width * side), room.squares.dtype)
    np.multiply(room.squares + 1, room.open, out=value[: room.open.shape[0], : room.open.shape[1]])
    best = value[::side, ::side].copy()  # the cell with the most room, the first of equals
    inner = np.zeros(best.shape, np.int64)
    full = best > 0
    for cell in range(1, side * side):
        other = value[cell // side :: side, cell % side :: side]
        inner[other > best] = cell
        np.maximum(best, other, out=best)
        full &= other > 0
    row, column = np.nonzero(best)
    inner = inner[row, column]
    number = np.full((height + 2, width + 2), NO_NODE, np.int64)
    number[row + 1, column + 1] = np.arange(len(row))
    around = np.pad(full, 1)
    across = around[:, :-2] & around[:, 1:-1] & around[:, 2:]
    deep = across[:-2] & across[1:-1] & across[2:]
    return _Blocks(row * side + inner // side, column * side + inner % side, number, deep[row, column])


def _graph(room: Room, blocks: _Blocks) -> csr_matrix:
    """Return the costs of the ways between neighbouring blocks, each pair once."""
    rows, columns, number = blocks.rows, blocks.columns, blocks.number.ravel()
    flat = np.flatnonzero(number != NO_NODE)
    width = blocks.number.shape[1]
    other = number[flat[:, None] + np.array([dr * width + dc for dr, dc in NEIGHBOURS])]  # (n, 4)
    a, k = np.nonzero(other != NO_NODE)
    b = other[a, k]
    joined = blocks.deep[a]
    narrow = np.flatnonzero(~joined)  # these cell by cell
    joined[narrow] = _joined(room, rows, columns, a[narrow], b[narrow])
    a, b = a[joined], b[joined]
    cost = room.cost[rows, columns]
    costs = np.hypot(rows[a] - rows[b], columns[a] - columns[b]) * (0.5 * room.cell_m) * (cost[a] + cost[b])
    until = np.zeros(len(rows) + 1, np.int32)
    np.cumsum(np.bincount(a, minlength=len(rows)), out=until[1:])
    return csr_matrix((costs, b.astype(np.int32), until), shape=(len(rows), len(rows)))


def _joined(room: Room, rows: Indices, columns: Indices, a: Indices, b: Indices) -> npt.NDArray[np.bool_]:
    """Say for each pair of blocks whether the straight way between their cells is open."""
    row_a, column_a = rows[a], columns[a]
    by_rows, by_columns = rows[b] - row_a, columns[b] - column_a
    steps = 2 * int(max(np.abs(by_rows).max(initial=0), np.abs(by_columns).max(initial=0)))
    clear = np.ones(len(a), np.bool_)
    for step in range(1, steps):
        row = row_a + (2 * by_rows * step + steps) // (2 * steps)
        column = column_a + (2 * by_columns * step + steps) // (2 * steps)
        clear &= room.open[row, column]
    return clear


def _start_node(room: Room, rows: Indices, columns: Indices, start: Place) -> int | None:
    """Return the block to begin at: the nearest that the robot can go straight to."""
    if not len(rows):
        return None
    row, column = room.cell(*start)
    away = (rows - row) ** 2 + (columns - column) ** 2
    for node in np.argsort(away, kind="stable")[:9].tolist():
        if straight_cost(room, np.array(start), np.array(room.centre(int(rows[node]), int(columns[node])))) < np.inf:
            return int(node)
    return None


def _lengths(room: Room, rows: Indices, columns: Indices, before: npt.NDArray[np.int32]) -> Floats:
    """Return how long the way from the first block to each is; steps are summed by jumping twice as far each time."""
    jump = np.where(before >= 0, before, np.arange(len(before)))
    length: Floats = np.hypot(rows - rows[jump], columns - columns[jump]) * room.cell_m
    while not np.array_equal(jump, further := jump[jump]):
        length = length + length[jump]
        jump = further
    return length
