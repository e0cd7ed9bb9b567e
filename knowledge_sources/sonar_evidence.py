"""Sonar echoes as evidence in the grid: cones that empty what they passed, arcs that fill where they ended.

Steps 2 and 3 of Bou-Ghannam 1992, section 5.2.1. Beyond the thesis, an echo's evidence is shared along its arc in proportion
to the present odds of its cells, since one thing made it; and a cone ends at what is surely occupied, since an echo from
behind that did not come straight.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, floor, pi, sin

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


@dataclass(frozen=True, slots=True)
class Ping:
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


class SonarEvidence:
    """Folds scans into a grid. Cones are laid once for each heading and kept while the grid has the same width."""

    def __init__(self, params: EouGridParams) -> None:
        self._params = params
        self._laid: dict[tuple[float, int], _Laid] = {}
        self._width = 0
        values = np.arange(256)
        odds = np.minimum((values + 1) / (256 - values), SURE_ODDS)
        self._weights = (odds**params.share).astype(np.float32)

    def fold(self, grid: Grid, scan: Sequence[Ping]) -> None:
        """Lower the cells that the pings passed and raise those where they ended. The grid must cover their range."""
        params = self._params
        flat, width, first_row, first_column = grid.flat()
        if width != self._width:
            self._laid.clear()
            self._width = width
        cells: list[Indices] = []
        steps: list[Bytes] = []
        arcs: list[Indices] = []
        for ping in scan:
            laid = self._lay(ping)
            row, column = floor(ping.y_m / params.cell_m), floor(ping.x_m / params.cell_m)
            # ranges of a template count from the centre of the sensor's cell: shift the cut by where in it the sensor is
            ahead_m = (ping.x_m - (column + 0.5) * params.cell_m) * cos(ping.heading_rad) + (
                ping.y_m - (row + 0.5) * params.cell_m
            ) * sin(ping.heading_rad)
            range_m = ping.range_m + ahead_m
            clear = _count(laid.cone, range_m - (params.clear_margin_m if ping.heard else 0.0))
            weak = min(_count(laid.cone, range_m * params.weak_from_fraction), clear)
            near, far = (_count(laid.cone, range_m - params.band_m), _count(laid.cone, range_m + params.band_m))
            here = laid.offsets[: far if ping.heard else clear] + ((row - first_row) * width + column - first_column)
            step = np.full(clear, params.sonar_down, np.uint8)
            step[weak:] = max(1, params.sonar_down // 2)
            arc = here[near:far] if ping.heard else here[:0]
            if params.shadow:
                lit = self._lit(flat, here, laid.cone, near if ping.heard else clear)
                if lit is not None:
                    step *= lit[:clear]
                    arc = arc[lit[near : near + len(arc)].view(np.bool_)]
            cells.append(here[:clear])
            steps.append(step)
            if len(arc):
                arcs.append(arc)
        if cells:
            _lower(flat, np.concatenate(cells), np.concatenate(steps))
        if arcs:
            self._raise(flat, arcs)

    def _lit(self, flat: Bytes, here: Indices, template: Cone, before: int) -> Bytes | None:
        """Return 1 for cells that something surely occupied nearer than `before` does not hide, 0 for others; None: all lit."""
        blocking = flat[here[:before]] >= self._params.blocks_from
        if not blocking.any():
            return None
        sectors = template.sectors[: len(here)]
        hidden = np.zeros(len(here), np.uint8)
        hidden[1:before] = np.bitwise_or.accumulate(np.where(blocking, sectors[:before], 0))[:-1]
        hidden[before:] = np.bitwise_or.reduce(np.where(blocking, sectors[:before], 0))
        lit: Bytes = ((sectors & ~hidden) != 0).astype(np.uint8)
        return lit

    def _raise(self, flat: Bytes, arcs: list[Indices]) -> None:
        cells = np.concatenate(arcs)
        lengths = [len(arc) for arc in arcs]
        starts = np.cumsum([0, *lengths[:-1]])
        values = flat[cells]
        weights = self._weights[values]
        most = np.maximum.reduceat(weights, starts)  # the likeliest cell of an arc gets the whole step
        steps = np.rint(self._params.sonar_up * weights / np.repeat(most, lengths)).astype(np.int16)
        flat[cells] = np.minimum(values + steps, 255)

    def _lay(self, ping: Ping) -> _Laid:
        turn = round(ping.heading_rad * HEADINGS / (2 * pi)) % HEADINGS
        laid = self._laid.get((ping.cone_rad, turn))
        if laid is None:
            params = self._params
            template = cone(ping.cone_rad, params.sonar_range_m + params.band_m + params.cell_m, params.cell_m, turn)
            laid = _Laid(template.rows * self._width + template.columns, template)
            self._laid[(ping.cone_rad, turn)] = laid
        return laid


def _count(template: Cone, range_m: float) -> int:
    counts = template.count_within
    return counts[min(max(int(range_m / RANGE_STEP_M), 0), len(counts) - 1)]


def _lower(flat: Bytes, cells: Indices, steps: Bytes) -> None:
    values = flat[cells]
    flat[cells] = np.maximum(values, steps) - steps
