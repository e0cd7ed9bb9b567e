"""Places found along a segment by the squares that they lie in."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from knowledge_sources.place_buckets import Buckets

SIDE_M = 0.5
PLACES = np.random.default_rng(5).uniform(-4.0, 6.0, (800, 2))
WHERE = st.floats(-20.0, 20.0)


def distances_m(x0: float, y0: float, x1: float, y1: float) -> np.ndarray:
    """Return how far the places lie from a segment."""
    span = np.array([x1 - x0, y1 - y0])
    share = np.clip(((PLACES - (x0, y0)) @ span) / max(float(span @ span), 1e-12), 0.0, 1.0)
    return np.hypot(*(PLACES - (x0, y0) - share[:, None] * span).T)


@given(WHERE, WHERE, WHERE, WHERE)
def test_none_near_a_segment_is_left_out_and_none_far_from_it_comes(x0: float, y0: float, x1: float, y1: float) -> None:
    found = Buckets(PLACES[:, 0], PLACES[:, 1], SIDE_M).along(x0, y0, x1, y1)
    away = distances_m(x0, y0, x1, y1)
    assert set(np.flatnonzero(away <= 0.7 * SIDE_M).tolist()) <= set(found.tolist())
    assert away[found].max(initial=0.0) <= 3.0 * SIDE_M
    assert (np.diff(found) > 0).all()


def test_rows_do_not_touch() -> None:
    buckets = Buckets(np.array([0.0, 9.9]), np.array([0.6, 0.1]), SIDE_M)
    assert buckets.along(9.9, 0.1, 9.9, 0.2).tolist() == [1]
    assert buckets.along(0.0, 0.6, 0.1, 0.6).tolist() == [0]


def test_no_places() -> None:
    assert len(Buckets(np.zeros(0), np.zeros(0), SIDE_M).along(0.0, 0.0, 1.0, 1.0)) == 0
