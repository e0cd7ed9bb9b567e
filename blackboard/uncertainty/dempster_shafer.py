"""Belief functions (Dempster and Shafer): what is not known is kept apart from what is denied.

Source: Bou-Ghannam 1992, section 2.5.3.4: m maps subsets of the frame of discernment to [0, 1], m(empty) = 0, sum m = 1;
BF(A) = sum of m(B) over B in A; p(A) = 1 - BF(not A); u(A) = p(A) - BF(A); Dempster's rule
m(C) = sum of m1(A) m2(B) over A and B that meet in C / (1 - k), k = the same sum over A and B that do not meet (the source
prints BF(C) for m(C)). The two bodies of evidence must be independent.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from blackboard.errors import UncertaintyError, did_you_mean
from blackboard.uncertainty.limits import sums_to_one, within

Proposition = frozenset[str]


@dataclass(frozen=True, slots=True)
class Evidence:
    """One unit of belief shared out over subsets of `frame`; `focal` holds those with some, smallest first, then by name.

    Made by `evidence`, `support` and `combine`, which check it.
    """

    frame: tuple[str, ...]
    focal: tuple[tuple[Proposition, float], ...]

    def mass(self, proposition: Iterable[str]) -> float:
        """Return what is committed exactly to `proposition` and to nothing smaller."""
        wanted = _proposition(proposition, self.frame)
        return next((mass for subset, mass in self.focal if subset == wanted), 0.0)

    @property
    def ignorance(self) -> float:
        """What is committed to the whole frame: belief in nothing in particular."""
        return self.mass(self.frame)


@dataclass(frozen=True, slots=True, kw_only=True)
class Interval:
    """The evidential interval [BF(A), p(A)] of a proposition: the least and the most that it deserves."""

    belief: float
    plausibility: float

    @property
    def uncertainty(self) -> float:
        """u(A) = p(A) - BF(A)."""
        return self.plausibility - self.belief


def evidence(frame: Iterable[str], masses: Mapping[Proposition, float]) -> Evidence:
    """Return the body of evidence with these masses, which add up to 1 and give the empty set nothing."""
    names = _frame(frame)
    checked: dict[Proposition, float] = {}
    for subset, value in masses.items():
        wanted = _proposition(subset, names)
        mass = within(f"mass of {_shown(wanted)}", value, 0.0, 1.0)
        if not wanted and mass > 0:
            raise UncertaintyError(f"mass of the empty set = {mass:g} must be 0: one proposition of the frame is true")
        if wanted in checked:
            raise UncertaintyError(f"mass of {_shown(wanted)} is given twice; keep one")
        checked[wanted] = mass
    sums_to_one("masses", checked.values())
    return Evidence(names, _in_order(checked))


def support(frame: Iterable[str], proposition: Iterable[str], degree: float) -> Evidence:
    """Return evidence that commits `degree` to one proposition and leaves the rest to the whole frame."""
    names = _frame(frame)
    wanted = _proposition(proposition, names)
    degree = within("degree of support", degree, 0.0, 1.0)
    if wanted == frozenset(names):
        return evidence(names, {wanted: 1.0})
    return evidence(names, {wanted: degree, frozenset(names): 1.0 - degree})


def belief(of: Evidence, proposition: Iterable[str]) -> float:
    """Return BF(A): all that is committed to subsets of A."""
    wanted = _proposition(proposition, of.frame)
    return min(math.fsum(mass for subset, mass in of.focal if subset <= wanted), 1.0)


def plausibility(of: Evidence, proposition: Iterable[str]) -> float:
    """Return p(A) = 1 - BF(not A): all that does not contradict A."""
    wanted = _proposition(proposition, of.frame)
    return min(math.fsum(mass for subset, mass in of.focal if subset & wanted), 1.0)


def interval(of: Evidence, proposition: Iterable[str]) -> Interval:
    """Return [BF(A), p(A)]."""
    wanted = _proposition(proposition, of.frame)
    return Interval(belief=belief(of, wanted), plausibility=plausibility(of, wanted))


def conflict(first: Evidence, second: Evidence) -> float:
    """Return k, how far two bodies of evidence contradict each other: 0 not at all, 1 wholly."""
    _same_frame(first, second)
    return min(math.fsum(a * b for x, a in first.focal for y, b in second.focal if not x & y), 1.0)


def combine(first: Evidence, second: Evidence) -> Evidence:
    """Return both bodies of evidence as one, by Dempster's rule; raises UncertaintyError where k = 1."""
    _same_frame(first, second)
    products: dict[Proposition, list[float]] = {}
    for x, a in first.focal:
        for y, b in second.focal:
            if x & y:
                products.setdefault(x & y, []).append(a * b)
    meeting = math.fsum(value for values in products.values() for value in values)  # 1 - k, without its cancellation
    if meeting == 0.0:
        raise UncertaintyError(
            "the two bodies of evidence contradict each other wholly (k = 1): no combination exists; keep both"
        )
    return Evidence(first.frame, _in_order({subset: math.fsum(p) / meeting for subset, p in products.items()}))


def _frame(names: Iterable[str]) -> tuple[str, ...]:
    frame = tuple(sorted({*_names(names)}))
    if not frame:
        raise UncertaintyError("the frame of discernment is empty; name the propositions that exclude each other")
    return frame


def _names(names: Iterable[str]) -> list[str]:
    if isinstance(names, str):
        raise UncertaintyError(f"'{names}' is one name where several are expected; write {{'{names}'}}")
    return list(names)


def _proposition(names: Iterable[str], frame: tuple[str, ...]) -> Proposition:
    wanted = frozenset(_names(names))
    for name in sorted(wanted):
        if name not in frame:
            raise UncertaintyError(f"'{name}' is not in the frame of discernment{did_you_mean(name, frame)}")
    return wanted


def _same_frame(first: Evidence, second: Evidence) -> None:
    if first.frame != second.frame:
        raise UncertaintyError(
            f"frames differ ({_shown(first.frame)} and {_shown(second.frame)}); evidence combines over one frame"
        )


def _in_order(masses: Mapping[Proposition, float]) -> tuple[tuple[Proposition, float], ...]:
    kept = [(subset, mass) for subset, mass in masses.items() if mass > 0]
    return tuple(sorted(kept, key=lambda item: (len(item[0]), sorted(item[0]))))


def _shown(names: Iterable[str]) -> str:
    return "{" + ", ".join(sorted(names)) + "}"
