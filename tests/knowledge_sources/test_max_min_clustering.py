"""Max-min clustering, by hand on the example of Tou and Gonzalez 1974, section 3.3.2."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from knowledge_sources.max_min_clustering import max_min_centres

TEN = np.array([(0, 0), (3, 8), (2, 2), (1, 1), (5, 3), (4, 8), (6, 3), (5, 4), (6, 4), (7, 5)], dtype=np.float64)


def plane(points: npt.NDArray[np.float64]) -> Callable[[int], npt.NDArray[np.float64]]:
    return lambda k: np.asarray(np.hypot(*(points - points[k]).T))


def test_the_ten_points_of_tou_and_gonzalez() -> None:
    # From (0, 0) the farthest is (4, 8) at 8.94. Of the smaller distances to both, the largest is that of (6, 3): 5.39, more than
    # half of 8.94. Then (2, 2) at 2.83 is less than half the mean of 8.94 and 5.39, which is 3.58.
    centres, nearest = max_min_centres(len(TEN), plane(TEN), 0.5)
    assert centres == [0, 5, 6]
    assert nearest.tolist() == [0, 1, 0, 0, 2, 1, 2, 2, 2, 2]


def test_a_smaller_fraction_divides_further() -> None:
    # 2.83 is more than 0.35 x 7.16 = 2.51; then (7, 5), 2.24 from (6, 3), is more than 0.35 x 5.72 = 2.00; then (1, 1), 1.41 from
    # (0, 0), is less than 0.35 x 4.85 = 1.70.
    centres, _ = max_min_centres(len(TEN), plane(TEN), 0.35)
    assert centres == [0, 5, 6, 2, 9]


def test_samples_further_apart_than_the_resolution_are_never_one_cluster() -> None:
    points = np.array([(0.0, 0.0), (100.0, 0.0), (0.0, 3.0), (99.0, 2.0)])
    assert max_min_centres(4, plane(points), 0.5)[0] == [0, 1]
    assert max_min_centres(4, plane(points), 0.5, resolution=2.5)[0] == [0, 1, 2]


@pytest.mark.parametrize(("count", "centres"), [(0, []), (1, [0]), (2, [0, 1])])
def test_few_samples(count: int, centres: list[int]) -> None:
    assert max_min_centres(count, plane(TEN[:count]), 0.5)[0] == centres


def test_equal_samples_are_one_cluster() -> None:
    same = np.ones((5, 2))
    assert max_min_centres(5, plane(same), 0.5)[0] == [0]


@given(st.lists(st.tuples(st.integers(-50, 50), st.integers(-50, 50)), min_size=1, max_size=30))
def test_every_sample_belongs_to_the_nearest_centre(samples: list[tuple[int, int]]) -> None:
    points = np.array(samples, dtype=np.float64)
    centres, nearest = max_min_centres(len(points), plane(points), 0.5)
    distances = np.stack([plane(points)(c) for c in centres], axis=1)
    assert np.allclose(distances[np.arange(len(points)), nearest], distances.min(axis=1))
    assert len(set(centres)) == len(centres)
