"""Sonar echoes as evidence in the grid: cones that empty what they passed, arcs that fill where they ended.

Steps 2 and 3 of Bou-Ghannam 1992, section 5.2.1. Beyond the thesis, an echo's evidence is shared along its arc in proportion
to the present odds of its cells, since one thing made it; and a cone ends at what is surely occupied, since an echo from
behind that did not come straight. Cones of one scan that overlap heard the same things at the same time: a cell in several of
them changes once, by the largest step, whatever the order of the sonars.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from math import cos, floor, pi, sin
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from blackboard.grid import Grid
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import RobotDescription, SonarScan
from knowledge_sources.eou_params import EouGridParams
from knowledge_sources.sensor_cone import HEADINGS, RANGE_STEP_M, Cone, cone
from knowledge_sources.sensors import sonar_of

SURE_ODDS = 8.0  # odds are counted up to here: beyond it one cell would take all, whatever came later
CELLS_KEPT = 6_000_000  # of laid cones, some 150 MB; 720 headings of a cone of 25 degrees and 5 m need 1.6 million
LEAST_WEIGHT = 1e-9  # of an arc that lies in the shadow altogether

Indices = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]


class Ping(NamedTuple):
    """One sonar's reading, map frame: where it stood, where it looked, and how far it is clear. `heard`: an echo came.

    `range_m` is at most `sonar_range_m`.
    """

    x_m: float
    y_m: float
    heading_rad: float
    cone_rad: float
    range_m: float
    heard: bool


def pings(scan: SonarScan, robot: RobotDescription, map_from_robot: Pose, params: EouGridParams) -> list[Ping]:
    """Return what each sonar of a scan says, as far as it is trusted; those that say nothing are left out."""
    said = []
    cosine, sine = cos(map_from_robot.heading_rad), sin(map_from_robot.heading_rad)
    for number, range_m in zip(scan.sensors, scan.ranges_m, strict=True):
        sonar = sonar_of(robot, number)
        clear_m = min(params.no_echo_clears_m, sonar.max_range_m) if range_m is None else range_m
        if clear_m > 0.0:
            mount = sonar.mount
            said.append(
                Ping(
                    map_from_robot.x_m + cosine * mount.x_m - sine * mount.y_m,
                    map_from_robot.y_m + sine * mount.x_m + cosine * mount.y_m,
                    map_from_robot.heading_rad + mount.heading_rad,
                    sonar.cone_rad,
                    min(clear_m, params.sonar_range_m),
                    range_m is not None and range_m <= params.sonar_range_m,
                )
            )
    return said


@dataclass(frozen=True, slots=True, eq=False)
class _Laid:
    """A cone laid over the grid's flat array: offsets from the sensor's cell, nearest first."""

    offsets: Indices
    cone: Cone
    cosine: float  # of its axis
    sine: float


@dataclass(slots=True)
class _Cut:
    """A cone cut at its range, in the buffers of one scan: its cells from `start`, cleared up to `clear`, arc from `near`."""

    start: int
    clear: int
    near: int
    stop: int
    cone: Cone


class SonarEvidence:
    """Folds scans into a grid. Cones are laid once for each heading and kept while the grid has the same width."""

    def __init__(self, params: EouGridParams) -> None:
        self._params = params
        self._laid: dict[tuple[float, int], _Laid] = {}
        self._laid_cells = 0
        self._width = 0
        values = np.arange(256)
        odds = np.minimum((values + 1) / (256 - values), SURE_ODDS)
        self._weights = (odds**params.share).astype(np.float32)
        self._margin = round(params.clear_margin_m / RANGE_STEP_M)
        self._band = round(params.band_m / RANGE_STEP_M)
        self._weak_down = max(1, params.sonar_down // 2)
        self._cells = np.empty(1 << 14, np.int64)  # buffers for all cones of a scan, grown as needed
        self._steps = np.empty(1 << 14, np.uint8)

    def fold(self, grid: Grid, scan: Sequence[Ping]) -> None:
        """Lower the cells that the pings passed and raise those where they ended. The grid must cover their range."""
        flat, width, first_row, first_column = grid.flat()
        if width != self._width:
            self._forget()
            self._width = width
        cuts: list[_Cut] = []
        used = 0
        for ping in scan:
            cut = self._cut(ping, used, first_row, first_column)
            cuts.append(cut)
            used = cut.stop
        if not cuts:
            return
        cells, steps = self._cells[:used], self._steps[:used]
        values = flat[cells]
        lit = self._lit(values, cuts) if self._params.shadow else None
        if lit is not None:
            steps *= lit
        np.maximum(values, steps, out=values)
        values -= steps
        np.minimum.at(flat, cells, values)
        self._raise(flat, cells, cuts, lit)

    def _cut(self, ping: Ping, start: int, first_row: int, first_column: int) -> _Cut:
        """Write a ping's cells and downward steps into the buffers."""
        params = self._params
        turn = round(ping.heading_rad * (HEADINGS / (2 * pi))) % HEADINGS
        laid = self._laid.get((ping.cone_rad, turn)) or self._lay(ping.cone_rad, turn)
        x, y = ping.x_m / params.cell_m, ping.y_m / params.cell_m
        row, column = floor(y), floor(x)
        # ranges of a template count from the centre of the sensor's cell: shift the cut by where in it the sensor is
        ahead = (x - column - 0.5) * laid.cosine + (y - row - 0.5) * laid.sine
        step = max(0, round((ping.range_m + ahead * params.cell_m) / RANGE_STEP_M))
        counts = laid.cone.count_within
        if ping.heard:
            clear = counts[step - self._margin] if step >= self._margin else 0
            near = counts[step - self._band] if step >= self._band else 0
            stop = counts[step + self._band]
        else:
            clear = near = stop = counts[step]
        weak = min(counts[int(step * params.weak_from_fraction)], clear)
        end = start + stop
        if end > len(self._cells):
            self._cells, self._steps = np.resize(self._cells, 2 * end), np.resize(self._steps, 2 * end)
        np.add(laid.offsets[:stop], (row - first_row) * self._width + column - first_column, self._cells[start:end])
        steps = self._steps
        steps[start : start + weak] = params.sonar_down
        steps[start + weak : start + clear] = self._weak_down
        steps[start + clear : end] = 0
        return _Cut(start, start + clear, start + near, end, laid.cone)

    def _lit(self, values: Bytes, cuts: list[_Cut]) -> Bytes | None:
        """Return 1 for cells that nothing surely occupied on the cleared way hides, else 0; None: all are lit."""
        sure = values >= self._params.blocks_from
        places = np.flatnonzero(sure)
        firsts = np.searchsorted(places, [cut.start for cut in cuts])
        pasts = np.searchsorted(
            places, [cut.clear for cut in cuts]
        )  # what is nearer to the arc may be the echo's source
        lit: Bytes | None = None
        for which in np.flatnonzero(pasts > firsts).tolist():
            cut = cuts[which]
            if lit is None:
                lit = np.ones(len(values), np.uint8)
            sectors = cut.cone.sectors[: cut.stop - cut.start]
            first = int(places[firsts[which]]) - cut.start
            blocking = sure[cut.start + first : cut.clear]
            shadow = np.bitwise_or.accumulate(sectors[first : first + len(blocking)] * blocking)
            hidden = np.empty(len(sectors) - first - 1, np.uint8)  # of the cells beyond the first that blocks
            hidden[: len(shadow) - 1] = shadow[:-1]
            hidden[len(shadow) - 1 :] = shadow[-1]
            lit[cut.start + first + 1 : cut.stop] = (sectors[first + 1 :] & ~hidden) != 0
        return lit

    def _raise(self, flat: Bytes, cells: Indices, cuts: list[_Cut], lit: Bytes | None) -> None:
        arcs = [(cut.near, cut.stop) for cut in cuts if cut.near < cut.stop]
        if not arcs:
            return
        lengths = [stop - near for near, stop in arcs]
        starts = list(accumulate(lengths[:-1], initial=0))
        raised = np.concatenate([cells[near:stop] for near, stop in arcs])
        values = flat[raised]
        weights = self._weights[values]
        if lit is not None:
            weights *= np.concatenate([lit[near:stop] for near, stop in arcs])
        most = np.maximum(np.maximum.reduceat(weights, starts), LEAST_WEIGHT)
        weights *= np.repeat(self._params.sonar_up / most, lengths)  # the likeliest cell of an arc gets the whole step
        np.rint(weights, out=weights)
        weights += values
        np.maximum.at(flat, raised, np.minimum(weights, 255.0).astype(np.uint8))

    def _lay(self, cone_rad: float, turn: int) -> _Laid:
        params = self._params
        template = cone(cone_rad, params.sonar_range_m + params.band_m + params.cell_m, params.cell_m, turn)
        heading_rad = turn * 2 * pi / HEADINGS
        laid = _Laid(template.rows * self._width + template.columns, template, cos(heading_rad), sin(heading_rad))
        if self._laid_cells + len(laid.offsets) > CELLS_KEPT:
            self._forget()
        self._laid[(cone_rad, turn)] = laid
        self._laid_cells += len(laid.offsets)
        return laid

    def _forget(self) -> None:
        self._laid.clear()
        self._laid_cells = 0
