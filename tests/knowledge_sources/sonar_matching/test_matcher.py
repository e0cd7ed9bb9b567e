"""A known shift is found back in a box; in a corridor nothing moves along it."""

from math import cos, pi, radians, sin

import numpy as np
import numpy.typing as npt
import pytest

from blackboard.grid import Grid
from blackboard.messages.geometry import IDENTITY, Pose
from knowledge_sources.sonar_matching.matcher import Match, informative, match, slope_and_curvature, stencil, surprise
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.window import Heard

PARAMS = SonarMatcherParams()
CELL_M = PARAMS.cell_m
PRIOR = np.diag([0.1, 0.1, 0.1]) ** 2


def room(half_length_m: float, half_width_m: float, wall_m: float = 0.2) -> Grid:
    """Empty within the box, occupied from its walls on, as thick as `wall_m`, unknown behind."""
    grid = Grid(CELL_M)
    grid.cover(-half_length_m - 2, -half_width_m - 2, half_length_m + 2, half_width_m + 2)
    rows, columns = grid.cells.shape
    x = np.abs(grid.x_min_m + (np.arange(columns) + 0.5) * CELL_M)[None, :]
    y = np.abs(grid.y_min_m + (np.arange(rows) + 0.5) * CELL_M)[:, None]
    grid.cells[(x < half_length_m + wall_m) & (y < half_width_m + wall_m)] = 255
    grid.cells[(x < half_length_m) & (y < half_width_m)] = 0
    return grid


def ring(half_length_m: float, half_width_m: float, true: Pose, cone_rad: float = radians(12)) -> Heard:
    """Echoes within reach of 24 sonars at the centre of a robot that stands at `true`."""
    rows = []
    for bearing in 0.003 + np.arange(24) * (2 * pi / 24):  # no ray is parallel to a wall
        ranges = []
        for ray in np.linspace(-cone_rad / 2, cone_rad / 2, 40):
            c, s = cos(true.heading_rad + bearing + ray), sin(true.heading_rad + bearing + ray)
            ranges.append((np.copysign(half_length_m, c) - true.x_m) / c)
            ranges.append((np.copysign(half_width_m, s) - true.y_m) / s)
        if min(ranges) <= PARAMS.reach_m:
            rows.append((0.0, 0.0, bearing, min(ranges)))
    table = np.array(sorted(rows, key=lambda row: row[3]))
    return Heard(table[:, :3], table[:, 3], np.full(len(table), cone_rad))


@pytest.mark.parametrize(
    ("x_m", "y_m", "turn_rad"), [(0.1, 0.0, 0.0), (0.0, -0.12, 0.0), (0.0, 0.0, 0.08), (-0.1, 0.08, -0.06)]
)
def test_a_known_shift_is_found_back_in_a_box(x_m: float, y_m: float, turn_rad: float) -> None:
    true = Pose(x_m=0.01 + x_m, y_m=0.01 + y_m, heading_rad=turn_rad)
    found = match(room(2.0, 1.5), ring(2.0, 1.5, true), Pose(x_m=0.01, y_m=0.01, heading_rad=0.0), PRIOR, 1.0, PARAMS)
    assert found is not None
    assert found.shift == pytest.approx([x_m, y_m, turn_rad], abs=0.03)
    assert found.echoes == 24
    assert np.linalg.eigvalsh(found.information)[0] > 1 / 0.1**2  # sharper than the prior in every direction


def test_nothing_moves_along_a_corridor() -> None:
    true = Pose(x_m=0.2, y_m=0.1, heading_rad=0.05)
    found = match(room(20.0, 1.0), ring(20.0, 1.0, true), IDENTITY, PRIOR, 1.0, PARAMS)
    assert found is not None
    along, across, turn = found.shift
    assert across == pytest.approx(0.1, abs=0.03)
    assert turn == pytest.approx(0.05, abs=0.03)
    assert abs(along) < 0.02
    assert found.information[0, 0] < 0.02 * found.information[1, 1]


def test_less_weight_moves_less_and_informs_less() -> None:
    true = Pose(x_m=0.1, y_m=0.0, heading_rad=0.0)
    grid, echoes = room(2.0, 1.5), ring(2.0, 1.5, true)
    full = match(grid, echoes, IDENTITY, PRIOR, 1.0, PARAMS)
    light = match(grid, echoes, IDENTITY, PRIOR, 0.05, PARAMS)
    assert full is not None
    assert light is not None
    assert 0.0 < light.shift[0] < full.shift[0]
    assert np.trace(light.information) < 0.2 * np.trace(full.information)


def test_in_an_unmapped_place_there_is_no_match() -> None:
    assert match(Grid(CELL_M), ring(2.0, 1.5, IDENTITY), IDENTITY, PRIOR, 1.0, PARAMS) is None


def test_too_few_echoes_are_no_match() -> None:
    few = ring(2.0, 1.5, IDENTITY)
    few = Heard(few.sensors[:5], few.ranges_m[:5], few.cones_rad[:5])
    assert match(room(2.0, 1.5), few, IDENTITY, PRIOR, 1.0, PARAMS) is None


def test_slope_and_curvature_of_a_parabola_are_its_own() -> None:
    widths = np.array([0.1, 0.2, 0.05])
    slope = np.array([1.0, -2.0, 3.0])
    curvature = np.array([[-4.0, 1.0, 0.5], [1.0, -3.0, 0.2], [0.5, 0.2, -2.0]])
    at = stencil(widths)
    scores: npt.NDArray[np.float64] = at @ slope + 0.5 * np.einsum("ki,ij,kj->k", at, curvature, at)
    found = slope_and_curvature(scores, widths)
    np.testing.assert_allclose(found[0], slope)
    np.testing.assert_allclose(found[1], curvature, atol=1e-9)


def test_a_saddle_informs_only_where_it_curves_down() -> None:
    information, slope = informative(np.diag([-100.0, 50.0, -1.0]), np.array([1.0, 2.0, 3.0]))
    np.testing.assert_allclose(information, np.diag([100.0, 0.0, 1.0]), atol=1e-12)
    np.testing.assert_allclose(slope, [1.0, 0.0, 3.0], atol=1e-12)


def test_surprise_is_the_squared_normal_distance_of_two_opinions() -> None:
    """Both know x to 0.1 m and lie 0.6 m apart: the best is half way, and 0.6**2 / (0.1**2 + 0.1**2) = 18."""
    prior = np.diag([0.01, 0.01, 0.01])
    halfway = Match(np.array([0.3, 0.0, 0.0]), np.diag([100.0, 0.0, 100.0]), 24)
    assert surprise(halfway, prior) == pytest.approx(18.0)
    assert surprise(Match(np.zeros(3), np.zeros((3, 3)), 24), prior) == 0.0
