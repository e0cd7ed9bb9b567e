"""Cones and arcs in the grid, worked by hand: a cone of 12 degrees, 5 cm cells, the sensor in the middle of cell (0, 0)."""

from dataclasses import replace
from math import pi, radians
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.grid import OCCUPIED_MIN, UNKNOWN, Grid
from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import RobotDescription, SonarScan, SonarSensor
from knowledge_sources.eou_params import EouGridParams
from knowledge_sources.sonar_evidence import Ping, SonarEvidence, pings

CELL_M = 0.05
HERE = CELL_M / 2  # the middle of cell (0, 0)
PLAIN = EouGridParams(share=0.0, shadow=False, sonar_down=10, sonar_up=24)


def ping(range_m: float, heading_rad: float = 0.0, heard: bool = True, x_m: float = HERE, y_m: float = HERE) -> Ping:
    return Ping(x_m, y_m, heading_rad, radians(12.0), range_m, heard)


def folded(params: EouGridParams, *scans: list[Ping], grid: Grid | None = None) -> Grid:
    grid = grid or blank()
    evidence = SonarEvidence(params)
    for scan in scans:
        evidence.fold(grid, scan)
    return grid


def blank() -> Grid:
    grid = Grid(CELL_M)
    grid.cover(-6.0, -6.0, 6.0, 6.0)
    return grid


def value(grid: Grid, row: int, column: int) -> int:
    return int(grid.values_at(np.array([[(column + 0.5) * CELL_M, (row + 0.5) * CELL_M]]))[0])


def put(grid: Grid, row: int, column: int, to: int) -> None:
    flat, width, first_row, first_column = grid.flat()
    flat[(row - first_row) * width + column - first_column] = to


def test_a_cone_at_two_metres() -> None:
    grid = folded(PLAIN, [ping(2.02)])
    # Down by 10 up to three quarters of the range (1.51 m, column 30), by 5 up to 10 cm before the echo (1.92 m, column 38).
    assert [value(grid, 0, c) for c in (0, 1, 30, 31, 38)] == [118, 118, 118, 123, 123]
    # Up by 24 within 5 cm of the range, from 1.97 to 2.07 m: columns 40 and 41 on the axis.
    assert [value(grid, 0, c) for c in (39, 40, 41, 42)] == [UNKNOWN, 152, 152, UNKNOWN]
    # Off the axis: the arc ends at row 4 (atan(4 / 40) = 5.7 degrees); row 5 is outside of the cone.
    assert (value(grid, 4, 40), value(grid, -4, 40)) == (152, 152)
    assert (value(grid, 5, 40), value(grid, -5, 40)) == (UNKNOWN, UNKNOWN)
    assert (value(grid, 2, 18), value(grid, 1, 18)) == (UNKNOWN, 118)
    assert value(grid, 0, -1) == UNKNOWN


def test_between_what_is_cleared_and_the_band_nothing_changes() -> None:
    grid = folded(replace(PLAIN, clear_margin_m=0.3), [ping(2.02)])
    assert [value(grid, 0, c) for c in (34, 35, 39, 40)] == [123, UNKNOWN, UNKNOWN, 152]


def test_where_in_its_cell_the_sensor_stands_shifts_the_band() -> None:
    # From the middle of its cell, a range of 1.98 m fills 1.93 to 2.03 m: columns 39 and 40. 2 cm further ahead it is 2.00 m.
    assert _filled(ping(1.98)) == [39, 40]
    assert _filled(ping(1.98, x_m=HERE + 0.023)) == [40, 41]
    assert _filled(ping(1.98, pi, x_m=HERE - 0.023)) == [-41, -40]
    assert _filled(ping(1.98, pi, x_m=HERE + 0.023)) == [-40, -39]


def _filled(one: Ping) -> list[int]:
    grid = folded(PLAIN, [one])
    return [c for c in range(-60, 60) if value(grid, 0, c) > UNKNOWN]


def test_no_echo_raises_nothing() -> None:
    grid = folded(PLAIN, [ping(1.0, heard=False)])
    assert [value(grid, 0, c) for c in (0, 15, 16, 20, 21)] == [118, 118, 123, 123, UNKNOWN]
    assert (grid.cells <= UNKNOWN).all()


def test_values_stay_within_a_byte() -> None:
    grid = folded(PLAIN, *[[ping(2.0)]] * 40)
    assert (value(grid, 0, 10), value(grid, 0, 40)) == (0, 255)


def test_a_longer_reading_wins_back_what_a_shorter_one_filled() -> None:
    # Someone stood at 1 m and is gone: 152 after one echo, then down by 10 a scan; below empty's limit after nine more.
    grid = folded(PLAIN, [ping(1.0)], *[[ping(2.0)]] * 9)
    assert value(grid, 0, 20) == 152 - 9 * 10
    assert value(grid, 0, 40) == 255


def test_a_scan_lowers_a_cell_once() -> None:
    # Neighbours whose cones overlap are one sweep.
    grid = folded(PLAIN, [ping(2.0), ping(2.0, radians(2.0))])
    assert value(grid, 0, 20) == 118


def test_conflicting_cones_of_a_scan_count_alike_in_any_order() -> None:
    # The first clears what the second's arc fills: down by 10, then up by 24.
    scan = [ping(2.02), ping(1.02, radians(4.0))]
    for order in (scan, scan[::-1]):
        grid = folded(PLAIN, order)
        assert value(grid, 1, 20) == UNKNOWN - 10 + 24
        assert value(grid, 0, 10) == 118


def test_conflicting_scans_leave_the_balance() -> None:
    # Two of three scans end at 1 m, one goes on to 2 m: 128 + 24 + 24 - 10.
    grid = folded(PLAIN, [ping(1.02)], [ping(2.02)], [ping(1.02)])
    assert value(grid, 0, 20) == 166


def test_the_likeliest_cell_of_an_arc_takes_the_evidence() -> None:
    params = replace(PLAIN, share=2.0)
    grid = blank()
    put(grid, 2, 40, 200)  # odds 201 / 56 = 3.6
    put(grid, -2, 40, 20)  # odds 21 / 236 = 0.09
    folded(params, [ping(2.0)], grid=grid)
    assert value(grid, 2, 40) == 224
    assert value(grid, 0, 40) == UNKNOWN + round(24 * (129 / 128) ** 2 / (201 / 56) ** 2)  # 2
    assert value(grid, -2, 40) == 20


def test_an_arc_without_favourite_goes_up_as_a_whole() -> None:
    grid = folded(replace(PLAIN, share=2.0), [ping(2.0)])
    assert {value(grid, row, 40) for row in range(-3, 4)} == {152}


def test_what_is_surely_occupied_hides_what_is_behind() -> None:
    params = replace(PLAIN, shadow=True)
    wall = blank()
    for row in range(-6, 7):
        put(wall, row, 20, 250)
    folded(params, [ping(2.0)], grid=wall)
    assert value(wall, 0, 19) == 118
    assert value(wall, 0, 20) == 240  # the wall itself loses, so that what has gone can fade
    assert {value(wall, 0, c) for c in range(22, 42)} == {UNKNOWN}
    through = folded(replace(params, shadow=False), [ping(2.0)])
    assert value(through, 0, 40) == 152


def test_the_rest_of_the_cone_looks_past_a_narrow_thing() -> None:
    grid = blank()
    put(grid, 2, 30, 250)  # 3.8 degrees to the left
    folded(replace(PLAIN, shadow=True), [ping(2.0)], grid=grid)
    assert value(grid, -2, 36) == 123
    assert value(grid, 2, 33) == UNKNOWN
    assert value(grid, -2, 40) == 152


def test_a_range_at_the_sensor_itself_touches_only_what_is_there() -> None:
    for range_m in (0.0, 0.01, 0.04):
        grid = folded(replace(PLAIN, cell_m=CELL_M), [ping(range_m, x_m=0.001)])
        assert (grid.cells != UNKNOWN).sum() <= 4
        assert (folded(PLAIN, [ping(range_m, heard=False, x_m=0.001)]).cells != UNKNOWN).sum() <= 1


def test_many_wide_cones_of_one_scan() -> None:
    # More cells than the buffers have at first.
    scan = [Ping(HERE, HERE, i * pi / 8, radians(120.0), 2.5, False) for i in range(16)]
    grid = folded(PLAIN, scan)
    assert (grid.cells == UNKNOWN - 10).sum() == pytest.approx(pi * (0.75 * 2.5 / CELL_M) ** 2, rel=0.01)


RANGES = st.lists(st.floats(0.0, 3.0), min_size=1, max_size=12)


@given(RANGES, st.integers(0, 719))
def test_a_quarter_turn_of_the_robot_turns_the_grid(ranges: list[float], turn: int) -> None:
    params = EouGridParams()
    turned = []
    for quarter in (0.0, pi / 2):
        scan = [ping(r, turn * pi / 360 + i * pi / 6 + quarter) for i, r in enumerate(ranges)]
        grid = folded(params, scan)
        turned.append(square(grid))
    assert np.array_equal(np.rot90(turned[0], -1), turned[1])


def square(grid: Grid) -> np.ndarray:
    flat, width, first_row, first_column = grid.flat()
    return flat.reshape(-1, width)[-80 - first_row : 81 - first_row, -80 - first_column : 81 - first_column]


@given(st.lists(RANGES, min_size=1, max_size=4), st.integers(0, 719), st.integers(1, 60))
def test_a_mirrored_robot_mirrors_the_grid(scans: list[list[float]], turn: int, apart: int) -> None:
    both = []
    for side in (1, -1):
        told = [[ping(r, side * (turn + i * apart) * pi / 360) for i, r in enumerate(ranges)] for ranges in scans]
        both.append(square(folded(EouGridParams(), *told)))
    assert np.array_equal(both[0][::-1], both[1])


@given(RANGES, st.integers(1, 60), st.randoms(use_true_random=False))
def test_the_order_of_the_sonars_does_not_matter(ranges: list[float], apart: int, random: Random) -> None:
    scan = [ping(r, i * apart * pi / 360) for i, r in enumerate(ranges)]  # many cones overlap
    grid, other = blank(), blank()
    first, second = SonarEvidence(EouGridParams()), SonarEvidence(EouGridParams())
    for _ in range(6):  # enough for shadows
        first.fold(grid, scan)
        random.shuffle(scan)
        second.fold(other, scan)
        assert np.array_equal(grid.cells, other.cells)


@given(st.lists(RANGES, min_size=1, max_size=5), st.booleans(), st.sampled_from([0.0, 1.0, 2.0]))
def test_nothing_changes_beyond_the_readings(scans: list[list[float]], shadow: bool, share: float) -> None:
    params = replace(EouGridParams(), shadow=shadow, share=share)
    grid = folded(params, *[[ping(r, i * pi / 6) for i, r in enumerate(ranges)] for ranges in scans])
    rows, columns = np.nonzero(grid.cells != UNKNOWN)
    x, y = grid.x_min_m + (columns + 0.5) * CELL_M - HERE, grid.y_min_m + (rows + 0.5) * CELL_M - HERE
    longest = max(max(ranges) for ranges in scans)
    assert np.hypot(x, y).max(initial=0.0) <= longest + params.band_m + 0.01


def test_the_grid_may_grow_between_scans() -> None:
    one = blank()
    evidence = SonarEvidence(PLAIN)
    evidence.fold(one, [ping(2.0)])
    one.cover(-30.0, -30.0, 30.0, 30.0)
    evidence.fold(one, [ping(2.0)])
    other = folded(PLAIN, [ping(2.0)], [ping(2.0)])
    assert [value(one, 0, c) for c in range(45)] == [value(other, 0, c) for c in range(45)]


def robot() -> RobotDescription:
    mounts = [Pose(x_m=0.3, y_m=0.0, heading_rad=0.0), Pose(x_m=0.0, y_m=0.3, heading_rad=pi / 2)]
    sonars = tuple(SonarSensor(mount=m, cone_rad=radians(12.0), max_range_m=10.0) for m in mounts)
    return RobotDescription(
        name="two", radius_m=0.3, max_speed_mps=0.5, max_turn_radps=1.0, max_acceleration_mps2=0.5, sonars=sonars
    )


def test_what_a_scan_says() -> None:
    params = EouGridParams(sonar_range_m=3.0)
    at = Pose(x_m=1.0, y_m=2.0, heading_rad=pi / 2)
    said = pings(SonarScan(sensors=(1, 0), ranges_m=(7.0, 1.5)), robot(), at, params)
    assert [(p.range_m, p.heard) for p in said] == [(3.0, False), (1.5, True)]  # beyond 3 m only the way there is clear
    assert (said[1].x_m, said[1].y_m, said[1].heading_rad) == pytest.approx((1.0, 2.3, pi / 2))
    assert (said[0].x_m, said[0].y_m) == pytest.approx((0.7, 2.0))


def test_silence_clears_only_what_it_is_told_to() -> None:
    scan = SonarScan(sensors=(0,), ranges_m=(None,))
    assert pings(scan, robot(), IDENTITY, EouGridParams()) == []
    said = pings(scan, robot(), IDENTITY, EouGridParams(no_echo_clears_m=0.5))
    assert [(p.range_m, p.heard) for p in said] == [(0.5, False)]


def test_three_echoes_or_four_make_a_wall_sure() -> None:
    grid = folded(EouGridParams(), *[[ping(2.0)]] * 4)
    assert value(grid, 0, 40) >= OCCUPIED_MIN
