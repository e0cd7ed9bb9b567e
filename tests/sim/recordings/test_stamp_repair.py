"""Stamps that run back: the longest rising sequence is believed, the rest is placed between."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.recordings.stamps import longest_rising, repair, trusted


def test_order_is_left_alone() -> None:
    stamps = np.array([1.0, 1.0, 2.0, 976052857.337246])
    repaired, count = repair(stamps[:3])
    assert repaired.tolist() == [1.0, 1.0, 2.0]
    assert count == 0


def test_one_stamp_far_back_is_placed_between_its_neighbours() -> None:
    repaired, count = repair(np.array([100.0, 100.2, 3.0, 100.6, 100.8]))
    assert repaired.tolist() == pytest.approx([100.0, 100.2, 100.4, 100.6, 100.8])
    assert count == 1


def test_one_stamp_far_ahead_does_not_cost_those_after_it() -> None:
    repaired, count = repair(np.array([100.0, 100.2, 2784.0, 100.6, 100.8]))
    assert repaired.tolist() == pytest.approx([100.0, 100.2, 100.4, 100.6, 100.8])
    assert count == 1


def test_a_burst_written_one_second_late() -> None:
    repaired, count = repair(np.array([927.46, 927.71, 928.89, 928.90, 928.18, 928.40]))
    assert count == 2
    assert repaired.tolist() == pytest.approx([927.46, 927.71, 927.8667, 928.0233, 928.18, 928.40], abs=1e-4)


@pytest.mark.parametrize("place", [0, 10])
def test_a_lone_stamp_at_an_end_far_from_all_others_is_not_believed(place: int) -> None:
    stamps = np.arange(1000.0, 1011.0)
    stamps[place] = -1.6 if place == 0 else 9000.0
    repaired, count = repair(stamps)
    assert count == 1
    assert repaired[place] == (1001.0 if place == 0 else 1009.0)


def test_a_real_pause_stays() -> None:
    stamps = np.concatenate([np.arange(0.0, 10.0), np.arange(1000.0, 1010.0)])
    assert repair(stamps)[1] == 0


def test_a_slow_recording_is_no_row_of_pauses() -> None:
    assert repair(np.arange(0.0, 3000.0, 300.0))[1] == 0


def test_stamps_that_are_no_times() -> None:
    repaired, count = repair(np.array([1.0, np.nan, 3.0, np.inf, 5.0, 1e12]))
    assert repaired.tolist() == [1.0, 2.0, 3.0, 4.0, 5.0, 5.0]
    assert count == 3
    with pytest.raises(ValueError, match="finite"):
        repair(np.array([np.nan, np.inf]))


def test_microseconds_of_unix_stamps_stay() -> None:
    stamps = 976052857.337246 + np.array([0.0, 0.000001, 0.2, -5.0, 0.4])
    repaired, _ = repair(stamps)
    assert [f"{s:.6f}" for s in repaired[:2]] == ["976052857.337246", "976052857.337247"]


@given(st.lists(st.floats(-1e6, 1e6), max_size=60))
def test_never_runs_back_and_believed_stamps_stay(values: list[float]) -> None:
    stamps = np.array(values)
    repaired, count = repair(stamps)
    assert np.all(np.diff(repaired) >= 0)
    believed = trusted(stamps)
    assert np.array_equal(repaired[believed], stamps[believed])
    assert count == stamps.size - int(believed.sum())


@given(st.lists(st.integers(0, 8), max_size=9))
def test_longest_rising_is_as_long_as_any(values: list[int]) -> None:
    stamps = np.array(values, dtype=float)
    best = 0
    for mask in range(1 << stamps.size):
        chosen = stamps[[bool(mask >> i & 1) for i in range(stamps.size)]] if stamps.size else stamps
        if np.all(np.diff(chosen) >= 0):
            best = max(best, chosen.size)
    found = longest_rising(stamps)
    assert found.size == best
    assert np.all(np.diff(stamps[found]) >= 0)
    assert np.all(np.diff(found) > 0)
