"""Belief functions: Dempster's rule by hand, its laws, and its agreement with Bayes on single hypotheses."""

import math
import os
import subprocess
import sys
from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import UncertaintyError
from blackboard.uncertainty.bayes import posterior
from blackboard.uncertainty.dempster_shafer import (
    Evidence,
    Proposition,
    belief,
    combine,
    conflict,
    evidence,
    interval,
    plausibility,
    support,
)

FRAME = ("door", "person", "wall")
SUBSETS = [frozenset(names) for size in (1, 2, 3) for names in combinations(FRAME, size)]
DOOR, WALL, ALL = frozenset({"door"}), frozenset({"wall"}), frozenset(FRAME)


def shared(weights: list[float], subsets: list[Proposition]) -> Evidence:
    return evidence(FRAME, {s: w / math.fsum(weights) for s, w in zip(subsets, weights, strict=True)})


# every subset has some belief, so that no two bodies of evidence are in total conflict
BODIES = st.lists(st.floats(0.01, 1.0), min_size=7, max_size=7).map(lambda weights: shared(weights, SUBSETS))
WEIGHTS = st.lists(st.floats(0.01, 1.0), min_size=3, max_size=3)


def masses(of: Evidence) -> dict[Proposition, float]:
    return dict(of.focal)


def test_two_that_agree_by_hand() -> None:
    """0.6 and 0.5 for the door: 1 - 0.4 * 0.5 = 0.8 for it, u = m1(frame) m2(frame) = 0.2, no conflict."""
    first, second = support(FRAME, DOOR, 0.6), support(FRAME, DOOR, 0.5)
    both = combine(first, second)
    assert conflict(first, second) == 0.0
    assert masses(both) == pytest.approx({DOOR: 0.8, ALL: 0.2})
    assert interval(both, DOOR).uncertainty == pytest.approx(both.ignorance) == pytest.approx(0.2)


def test_two_that_disagree_by_hand() -> None:
    """0.6 for the door, 0.5 for the wall: k = 0.3, so 0.3, 0.2 and 0.2 of 0.7."""
    first, second = support(FRAME, DOOR, 0.6), support(FRAME, WALL, 0.5)
    both = combine(first, second)
    assert conflict(first, second) == pytest.approx(0.3)
    assert masses(both) == pytest.approx({DOOR: 3 / 7, WALL: 2 / 7, ALL: 2 / 7})
    door = interval(both, DOOR)
    assert (door.belief, door.plausibility) == pytest.approx((3 / 7, 5 / 7))


def test_belief_and_plausibility_by_hand() -> None:
    body = evidence(FRAME, {DOOR: 0.3, frozenset({"door", "wall"}): 0.5, ALL: 0.2})
    assert belief(body, {"door", "wall"}) == pytest.approx(0.8)
    assert plausibility(body, WALL) == pytest.approx(0.7)
    assert belief(body, WALL) == body.mass(WALL) == 0.0
    assert (belief(body, ()), plausibility(body, ())) == (0.0, 0.0)
    assert body.frame == FRAME
    assert [sorted(subset) for subset, _ in body.focal] == [["door"], ["door", "wall"], ["door", "person", "wall"]]


def test_the_order_of_writing_does_not_matter() -> None:
    assert evidence(FRAME, {DOOR: 0.5, WALL: 0.5}) == evidence(reversed(FRAME), {WALL: 0.5, DOOR: 0.5})


def test_ignorance_is_not_disbelief() -> None:
    nothing = support(FRAME, FRAME, 0.0)
    assert nothing.ignorance == 1.0
    unknown = interval(nothing, DOOR)
    assert (unknown.belief, unknown.plausibility, unknown.uncertainty) == (0.0, 1.0, 1.0)
    body = support(FRAME, DOOR, 0.7)
    assert masses(combine(body, nothing)) == pytest.approx(masses(body))


def test_near_total_conflict_keeps_its_digits() -> None:
    """Zadeh's example: what two witnesses both hardly believe is all that is left."""
    first = evidence(FRAME, {DOOR: 1 - 1e-12, frozenset({"person"}): 1e-12})
    second = evidence(FRAME, {WALL: 1 - 1e-12, frozenset({"person"}): 1e-12})
    assert conflict(first, second) == pytest.approx(1.0)
    assert combine(first, second).mass({"person"}) == 1.0


@given(BODIES, BODIES)
def test_combination_has_no_order_and_shares_one_unit(first: Evidence, second: Evidence) -> None:
    both = combine(first, second)
    assert masses(both) == pytest.approx(masses(combine(second, first)))
    assert math.fsum(masses(both).values()) == pytest.approx(1.0)
    assert both.ignorance <= min(first.ignorance, second.ignorance) / (1 - conflict(first, second)) + 1e-12


@given(BODIES, BODIES, BODIES)
def test_three_in_any_grouping(a: Evidence, b: Evidence, c: Evidence) -> None:
    assert masses(combine(combine(a, b), c)) == pytest.approx(masses(combine(a, combine(b, c))))


@given(BODIES, st.sampled_from(SUBSETS))
def test_bounds_of_belief(body: Evidence, proposition: Proposition) -> None:
    """BF(frame) = 1, BF(A) + BF(not A) <= 1, p(A) = 1 - BF(not A)."""
    rest = frozenset(FRAME) - proposition
    assert belief(body, FRAME) == pytest.approx(1.0)
    assert 0 <= belief(body, proposition) <= plausibility(body, proposition) <= 1
    assert belief(body, proposition) + belief(body, rest) <= 1 + 1e-12
    assert plausibility(body, proposition) == pytest.approx(1 - belief(body, rest))


@given(WEIGHTS, WEIGHTS)
def test_agrees_with_bayes_on_single_hypotheses(prior: list[float], likelihood: list[float]) -> None:
    single = [frozenset({name}) for name in FRAME]
    first, second = shared(prior, single), shared(likelihood, single)
    priors = {name: first.mass({name}) for name in FRAME}
    after = posterior(priors, dict(zip(FRAME, likelihood, strict=True)))
    both = combine(first, second)
    assert {name: both.mass({name}) for name in FRAME} == pytest.approx(after)
    for name in FRAME:
        assert belief(both, {name}) == pytest.approx(plausibility(both, {name}))


def test_the_same_bytes_whatever_the_hash_seed() -> None:
    program = (
        "from blackboard.uncertainty.dempster_shafer import combine, evidence;"
        "f = frozenset; n = ['wall', 'door', 'person', 'chair'];"
        "a = evidence(n, {f(n): 0.3, f(n[:2]): 0.1, f(n[1:3]): 0.2, f(n[2:]): 0.4});"
        "b = evidence(n, {f(n[:3]): 0.7, f(n[1:2]): 0.1, f(n[3:]): 0.2});"
        "c = combine(combine(a, b), a);"
        "print(c.frame, [(sorted(s), m) for s, m in c.focal])"
    )
    said = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)},
            capture_output=True,
            check=True,
        ).stdout
        for seed in ("1", "2", "3")
    }
    assert len(said) == 1


def test_bad_input_is_refused_in_one_line() -> None:
    body = support(FRAME, DOOR, 0.5)
    cases = [
        (lambda: combine(support(FRAME, DOOR, 1.0), support(FRAME, WALL, 1.0)), r"contradict each other wholly \(k = 1\)"),
        (lambda: combine(body, support(("door", "wall"), DOOR, 0.5)), r"frames differ \(\{door, person, wall\} and \{door, wall\}"),
        (lambda: conflict(body, support(("door", "wall"), DOOR, 0.5)), "frames differ"),
        (lambda: evidence(FRAME, {DOOR: 0.5, ALL: 0.4}), "masses add up to 0.9, not to 1"),
        (lambda: evidence(FRAME, {DOOR: 1.5, ALL: -0.5}), r"mass of \{door\} = 1.5 is outside \[0, 1\]"),
        (lambda: evidence(FRAME, {frozenset(): 0.1, ALL: 0.9}), "mass of the empty set = 0.1 must be 0"),
        (lambda: evidence(FRAME, {frozenset({"dor"}): 1.0}), "'dor' is not in the frame of discernment; did you mean 'door'?"),
        (lambda: evidence((), {}), "frame of discernment is empty"),
        (lambda: evidence(FRAME, {("door", "wall"): 0.5, ("wall", "door"): 0.5}), r"mass of \{door, wall\} is given twice"),  # type: ignore[dict-item]
        (lambda: support(FRAME, DOOR, 1.1), "degree of support = 1.1 is outside"),
        (lambda: support(FRAME, (), 0.5), "mass of the empty set = 0.5 must be 0"),
        (lambda: belief(body, "door"), r"'door' is one name where several are expected; write \{'door'\}"),
        (lambda: evidence("door", {}), "'door' is one name"),
    ]  # fmt: skip
    for call, said in cases:
        with pytest.raises(UncertaintyError, match=said):
            call()
