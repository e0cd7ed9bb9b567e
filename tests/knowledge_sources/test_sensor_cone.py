"""The template cone: which cells it holds, nearest first, whichever way it looks."""

from math import ceil, pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from knowledge_sources.sensor_cone import HEADINGS, RANGE_STEP_M, SECTORS, Cone, cone

CELL_M = 0.05
TWELVE = radians(12.0)
QUARTER = HEADINGS // 4


def places(template: Cone) -> list[tuple[int, int]]:
    return list(zip(template.rows.tolist(), template.columns.tolist(), strict=True))


def ranges_m(template: Cone) -> np.ndarray:
    return np.hypot(template.rows, template.columns) * CELL_M


def test_twelve_degrees_to_two_metres() -> None:
    # At column c the half width is c tan(6 degrees) = 0.105 c: one row on the axis up to column 9, three from 10, five from 20.
    template = cone(TWELVE, 2.0, CELL_M, 0)
    by_column: dict[int, list[int]] = {}
    for row, column in places(template):
        by_column.setdefault(column, []).append(row)
    assert sorted(by_column) == list(range(41))
    assert sorted(by_column[9]) == [0]
    assert sorted(by_column[10]) == [-1, 0, 1]
    assert sorted(by_column[19]) == [-1, 0, 1]
    assert sorted(by_column[20]) == [-2, -1, 0, 1, 2]
    assert sorted(by_column[40]) == [0]  # the arc: (40, 1) is already 2.0006 m away
    assert sorted(by_column[39]) == [-4, -3, -2, -1, 0, 1, 2, 3, 4]


def test_a_full_turn_holds_every_cell_once() -> None:
    template = cone(2 * pi, 1.0, CELL_M, 123)
    there = [(r, c) for r in range(-20, 21) for c in range(-20, 21) if r * r + c * c <= 400]
    assert sorted(places(template)) == there


@given(st.integers(0, HEADINGS - 1), st.floats(0.02, 2.0), st.floats(0.3, 4.0))
def test_nearest_first_each_once_and_counted(heading: int, cone_rad: float, radius_m: float) -> None:
    template = cone(cone_rad, radius_m, CELL_M, heading)
    away = ranges_m(template)
    assert (np.diff(away) >= 0).all()
    assert len(set(places(template))) == len(away)
    assert places(template)[0] == (0, 0)
    assert len(template.count_within) > ceil(radius_m / RANGE_STEP_M)
    for k in (0, 7, ceil(radius_m / RANGE_STEP_M) - 1):
        assert template.count_within[k] == (away <= k * RANGE_STEP_M + 1e-9).sum()
    assert template.count_within[len(template.count_within) - 1] == len(away)


@given(st.integers(0, QUARTER - 1), st.floats(0.05, 1.5))
def test_a_quarter_turn_turns_the_cells(heading: int, cone_rad: float) -> None:
    one, turned = cone(cone_rad, 2.0, CELL_M, heading), cone(cone_rad, 2.0, CELL_M, heading + QUARTER)
    assert sorted((column, -row) for row, column in places(one)) == sorted((r, c) for r, c in places(turned))


@pytest.mark.parametrize("heading", [0, 17, 180, 359, 360, 719])
def test_all_lie_within_the_cone(heading: int) -> None:
    template = cone(radians(30.0), 3.0, CELL_M, heading)
    bearings = np.arctan2(template.rows[1:], template.columns[1:])
    off = (bearings - heading * 2 * pi / HEADINGS + pi) % (2 * pi) - pi
    assert np.abs(off).max() <= radians(15.0) + 1e-6
    area_m2 = len(template.rows) * CELL_M**2
    assert area_m2 == pytest.approx(radians(15.0) * 3.0**2, rel=0.05)


def test_sectors_cover_the_width_of_a_cell() -> None:
    template = cone(TWELVE, 3.0, CELL_M, 0)
    sectors = dict(zip(places(template), template.sectors.tolist(), strict=True))
    everything = 2**SECTORS - 1
    assert sectors[(0, 0)] == everything
    assert (
        sectors[(0, 4)] == everything
    )  # 20 cm away a cell is as wide as the cone: half of it is atan(0.5 / 4) = 7 degrees
    # 3 m away half a cell is 0.48 degrees, a sector 1.5: on the axis it touches the two middle ones, at the edge only one.
    assert sectors[(0, 60)] == 0b00011000
    assert sectors[(-6, 59)] == 0b00000001
    assert sectors[(6, 59)] == 0b10000000
    assert all(bits for bits in sectors.values())
