"""Steps 6 to 8: grouping, ordering and breaks."""

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from knowledge_sources.line_points import group, order, split_at_breaks


def test_a_line_s_group_is_what_lies_near_it() -> None:
    assert group(np.array([0.02, -0.11, 0.10, -0.09, 0.5, np.inf]), 0.10).tolist() == [0, 2, 3]


def test_order_is_by_place() -> None:
    assert order(np.array([3.0, 1.0, 9.0, 2.0]), np.array([0, 1, 3])).tolist() == [1, 3, 0]


def test_a_line_breaks_at_a_gap_wider_than_the_robot_and_at_no_other() -> None:
    along = np.array([0.0, 0.3, 0.85, 1.5, 1.6])  # gaps 0.30, 0.55, 0.65, 0.10
    pieces = split_at_breaks(along, np.arange(5), 0.6)
    assert [piece.tolist() for piece in pieces] == [[0, 1, 2], [3, 4]]
    assert len(split_at_breaks(along, np.arange(5), 0.66)) == 1


def test_nothing_has_no_pieces() -> None:
    assert split_at_breaks(np.array([]), np.array([], dtype=np.intp), 0.6) == []


@given(st.lists(st.floats(-10, 10), min_size=1, max_size=40), st.floats(0.01, 3.0))
def test_pieces_are_all_of_the_points_and_far_apart(places: list[float], gap_m: float) -> None:
    along = np.array(places)
    pieces = split_at_breaks(along, order(along, np.arange(len(along))), gap_m)
    assert sorted(np.concatenate(pieces).tolist()) == list(range(len(along)))
    for piece, following in pairwise(pieces):
        assert along[following].min() - along[piece].max() > gap_m
    for piece in pieces:
        assert (np.diff(along[piece]) <= gap_m).all()
