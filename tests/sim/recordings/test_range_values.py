"""What single range values mean (REP-117)."""

from math import inf, nan

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sim.recordings.ranges import as_echoes, fit_echoes, sort_out, sort_out_one, unfit


def test_echo_no_return_and_unfit_values() -> None:
    ranges = sort_out([1.25, 5.0, 5.1, inf, nan, -inf, -0.3, 0.0, 0.05], 0.1, 5.0)
    assert ranges.tolist()[:4] == [1.25, inf, inf, inf]
    assert np.isnan(ranges[4:]).all()
    assert unfit(ranges) == 5
    assert as_echoes(ranges) == (1.25, None, None, None, None, None, None, None, None)


def test_unfit_sonars_are_left_out_and_silent_ones_stay() -> None:
    assert fit_echoes((3, 5, 8), np.array([0.5, nan, inf])) == ((3, 8), (0.5, None))


def test_single_precision_at_the_sensors_reach_is_no_echo() -> None:
    assert sort_out(np.array([5.6], np.float32), 0.02, float(np.float32(5.6)))[0] == inf


@given(st.floats(width=32), st.floats(0, 2), st.floats(2, 1000))
def test_one_is_treated_like_many(value: float, least_m: float, most_m: float) -> None:
    assert np.array_equal(
        sort_out([value], least_m, most_m), np.array([sort_out_one(value, least_m, most_m)]), equal_nan=True
    )
