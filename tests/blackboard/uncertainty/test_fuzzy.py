"""Fuzzy sets: the source's small integers, the connectives, and the laws that they keep."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import UncertaintyError
from blackboard.uncertainty.fuzzy import (
    Membership,
    complement,
    compose,
    conjunction,
    disjunction,
    implication,
    intersection,
    negation,
    triangle,
    union,
)

# Section 2.5.3.3: the fuzzy set of small integers
SMALL = {1: 1.0, 2: 1.0, 3: 0.9, 4: 0.7, 30: 0.001}
DEGREES = st.floats(0.0, 1.0)
SETS = st.fixed_dictionaries(dict.fromkeys("abc", DEGREES))


def test_small_integers() -> None:
    small = Membership(tuple((float(i), m) for i, m in SMALL.items()))
    assert [small.degree(i) for i in SMALL] == pytest.approx(list(SMALL.values()))
    assert small.degree(3.5) == pytest.approx(0.8)
    assert (small.degree(-5), small.degree(1000)) == (1.0, 0.001)


def test_a_triangle() -> None:
    near = triangle(0.0, 1.0, 3.0)
    assert [near.degree(x) for x in (-1, 0, 0.5, 1, 2, 3, 4)] == pytest.approx([0, 0, 0.5, 1, 0.5, 0, 0])


def test_connectives_by_hand() -> None:
    assert conjunction(0.9, 0.7) == 0.7
    assert disjunction(0.9, 0.7) == 0.9
    assert implication(0.9, 0.7) == pytest.approx(0.8)  # min(1, 1 - 0.9 + 0.7)
    assert implication(0.7, 0.9) == 1.0
    assert negation(0.9) == pytest.approx(0.1)


def test_sets_by_hand() -> None:
    odd = {3: 1.0, 5: 1.0}
    assert intersection(SMALL, odd) == {3: 0.9}
    assert union({3: 0.9, 4: 0.7}, odd) == {3: 1.0, 4: 0.7, 5: 1.0}
    assert list(union({4: 0.7}, odd)) == [4, 3, 5]
    assert complement({3: 0.75, 6: 0.0}) == {3: 0.25, 6: 1.0}


def test_composition_by_hand() -> None:
    """b(slow) = max(min(0.8, 0.9), min(0.3, 0.4)), b(fast) = max(min(0.8, 0.1), min(0.3, 1))."""
    relation = {("near", "slow"): 0.9, ("far", "slow"): 0.4, ("near", "fast"): 0.1, ("far", "fast"): 1.0}
    assert compose({"near": 0.8, "far": 0.3}, relation) == {"slow": 0.8, "fast": 0.3}
    assert compose({"near": 0.8}, {("elsewhere", "slow"): 1.0}) == {"slow": 0.0}


@given(SETS, SETS, SETS)
def test_laws_of_sets(a: dict[str, float], b: dict[str, float], c: dict[str, float]) -> None:
    assert union(a, b) == union(b, a)
    assert intersection(a, b) == intersection(b, a)
    assert union(union(a, b), c) == union(a, union(b, c))
    assert intersection(intersection(a, b), c) == intersection(a, intersection(b, c))
    assert intersection(a, union(b, c)) == union(intersection(a, b), intersection(a, c))
    assert union(a, a) == intersection(a, a) == a
    assert complement(union(a, b)) == intersection(complement(a), complement(b))


@given(DEGREES, DEGREES)
def test_bounds(a: float, b: float) -> None:
    assert conjunction(a, b) <= min(a, b) <= max(a, b) <= disjunction(a, b)
    assert 0 <= implication(a, b) <= 1
    assert (implication(a, b) == 1.0) or a > b


@given(SETS)
def test_composing_with_sameness_changes_nothing(a: dict[str, float]) -> None:
    assert compose(a, {(x, y): float(x == y) for x in a for y in a}) == a


@given(
    st.lists(st.tuples(st.floats(-1e3, 1e3), DEGREES), min_size=1, max_size=6, unique_by=lambda p: p[0]),
    st.floats(-2e3, 2e3),
)
def test_a_membership_stays_among_its_degrees(points: list[tuple[float, float]], value: float) -> None:
    degrees = [degree for _, degree in points]
    assert min(degrees) - 1e-12 <= Membership(tuple(sorted(points))).degree(value) <= max(degrees) + 1e-12


def test_bad_input_is_refused_in_one_line() -> None:
    cases = [
        (lambda: Membership(()), "needs at least one point"),
        (lambda: Membership(((1.0, 0.5), (1.0, 0.7))), "must rise from each point to the next"),
        (lambda: Membership(((1.0, 1.5),)), r"degree of membership = 1.5 is outside \[0, 1\]"),
        (lambda: triangle(2.0, 1.0, 3.0), "must rise"),
        (lambda: triangle(0.0, 1.0, 2.0).degree(float("inf")), "value = inf must be finite"),
        (lambda: conjunction(-0.1, 0.5), "degree of membership = -0.1 is outside"),
        (lambda: intersection({"a": 2.0}, {}), "degree of membership = 2.0 is outside"),
        (lambda: compose({"a": 0.5, "b": 3.0}, {("a", "c"): 0.5}), "degree of membership = 3.0 is outside"),
    ]
    for call, said in cases:
        with pytest.raises(UncertaintyError, match=said):
            call()
