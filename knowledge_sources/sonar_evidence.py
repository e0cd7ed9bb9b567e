"""Sonar echoes as evidence in the grid: cones that empty what they passed, arcs that fill where they ended.

Steps 2 and 3 of Bou-Ghannam 1992, section 5.2.1. Beyond the thesis, an echo's evidence is shared along its arc in proportion
to the present odds of its cells, since one thing made it; and a cone ends at what is surely occupied, since an echo from
behind that did not come straight.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, floor, pi, sin
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from blackboard.grid import Grid
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import RobotDescription, SonarScan
from knowledge_sources.eou_params import EouGridParams
from knowledge_sources.sensor_cone import HEADINGS, RANGE_STEP_M, Cone, cone

SURE_ODDS = 8.0  # odds are counted up to here: beyond it one cell would take all, whatever came later

Indices = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]


class Ping(NamedTuple):
    """One sonar's reading, map frame: where it stood, where it looked, and how far it is clear. `heard`: an echo came."""

    x_m: float
    y_m: float
    heading_rad: float
    cone_rad: float
    range_m: float
    heard: bool


def pings(scan: SonarScan, robot: RobotDescription, map_from_robot: Pose, params: EouGridParams) -> list[Ping]:
    """Return what each sonar of a scan says, as far as it is trusted; those that say nothing are left out."""
    said = []
    for number, range_m in zip(scan.sensors, scan.ranges_m, strict=True):
        sonar = robot.sonars[number]
        heard = range_m is not None and range_m <= params.sonar_range_m
        silent_m = min(params.no_echo_clears_m, sonar.max_range_m)
        clear_m = silent_m if range_m is None else min(range_m, params.sonar_range_m)
        if clear_m > 0.0:
            at = map_from_robot @ sonar.mount
            said.append(Ping(at.x_m, at.y_m, at.heading_rad, sonar.cone_rad, clear_m, heard))
    return said


@dataclass(frozen=True, eq=False)
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
            self._laid.clear()
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
        flat[cells] = values
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
        range_m = ping.range_m + ahead * params.cell_m
        counts, last = laid.cone.count_within, len(laid.cone.count_within) - 1
        step = max(int(range_m / RANGE_STEP_M), 0)
        if ping.heard:
            clear = counts[min(max(step - self._margin, 0), last)]
            near = counts[min(max(step - self._band, 0), last)]
            stop = counts[min(step + self._band, last)]
        else:
            clear = near = stop = counts[min(step, last)]
        weak = min(counts[min(int(step * params.weak_from_fraction), last)], clear)
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
        lit: Bytes | None = None
        for cut in cuts:
            blocking = sure[cut.start : cut.clear]  # what lies nearer to the arc may have made the echo itself
            if not blocking.any():
                continue
            if lit is None:
                lit = np.ones(len(values), np.uint8)
            sectors = cut.cone.sectors[: cut.stop - cut.start]
            before = len(blocking)
            shadow = np.bitwise_or.accumulate(np.where(blocking, sectors[:before], 0))
            hidden = np.empty(len(sectors), np.uint8)
            hidden[0] = 0
            hidden[1:before] = shadow[:-1]
            hidden[before:] = shadow[-1]
            lit[cut.start : cut.stop] = (sectors & ~hidden) != 0
        return lit

    def _raise(self, flat: Bytes, cells: Indices, cuts: list[_Cut], lit: Bytes | None) -> None:
        arcs = []
        for cut in cuts:
            arc = cells[cut.near : cut.stop]
            if lit is not None:
                arc = arc[lit[cut.near : cut.stop].view(np.bool_)]
            if len(arc):
                arcs.append(arc)
        if not arcs:
            return
        raised = np.concatenate(arcs)
        lengths = [len(arc) for arc in arcs]
        starts = np.cumsum([0, *lengths[:-1]])
        values = flat[raised]
        weights = self._weights[values]
        most = np.maximum.reduceat(weights, starts)  # the likeliest cell of an arc gets the whole step
        steps = np.rint(self._params.sonar_up * weights / np.repeat(most, lengths)).astype(np.int16)
        flat[raised] = np.minimum(values + steps, 255)

    def _lay(self, cone_rad: float, turn: int) -> _Laid:
        params = self._params
        template = cone(cone_rad, params.sonar_range_m + params.band_m + params.cell_m, params.cell_m, turn)
        heading_rad = turn * 2 * pi / HEADINGS
        laid = _Laid(template.rows * self._width + template.columns, template, cos(heading_rad), sin(heading_rad))
        self._laid[(cone_rad, turn)] = laid
        return laid
