from hypothesis import given
from hypothesis import strategies as st

from blackboard.keeper.journal_index import MAX_AHEAD, MAX_LANES, JournalIndex

LANE, OTHER = ("h", "b", "signal"), ("h", "b", "knowledge")


@given(st.lists(st.integers(1, 40), unique=True), st.integers(1, 45), st.integers(1, 45))
def test_whatever_the_order_all_are_found_in_order(numbers, first, last):
    index = JournalIndex(1000)
    for number in numbers:
        index.add(LANE, number, number * 10)
        index.add(OTHER, number, 7)
    expected = [(n, n * 10) for n in sorted(numbers) if first <= n <= last]
    assert list(index.between(LANE, first, last)) == expected


def test_of_the_longest_lane_the_older_half_goes_first():
    index = JournalIndex(10)
    for number in range(1, 9):
        index.add(LANE, number, number)
    for number in range(1, 4):
        index.add(OTHER, number, number)
    assert [n for n, _ in index.between(LANE, 1, 100)] == [5, 6, 7, 8]
    assert [n for n, _ in index.between(OTHER, 1, 100)] == [1, 2, 3]
    assert len(index) == 7


@given(st.lists(st.integers(1, 2**53), max_size=30))
def test_wild_numbers_take_no_more_room_than_the_limit(numbers):
    index = JournalIndex(MAX_AHEAD)
    for number in numbers:
        index.add(LANE, number, 1)
    assert len(index) <= MAX_AHEAD


def test_of_too_many_lanes_those_met_first_go_first():
    index = JournalIndex(MAX_LANES * 2)
    for boot in range(MAX_LANES + 1):
        index.add(("h", str(boot), "signal"), 1, boot)
    assert list(index.between(("h", "0", "signal"), 1, 1)) == []
    assert list(index.between(("h", str(MAX_LANES), "signal"), 1, 1)) == [(1, MAX_LANES)]
    assert len(index) == MAX_LANES
