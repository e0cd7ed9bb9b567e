"""Fuzzy sets: how far something belongs, where the word itself is vague ("small", "near").

Source: Bou-Ghannam 1992, section 2.5.3.3 (after Zadeh): membership in [0, 1]; conjunction min(a, b), disjunction max(a, b),
implication min(1, 1 - a + b). Complement 1 - a and max-min composition are not printed there; they are Zadeh's own
(Information and Control 8, 1965; Outline of a new approach, 1973), to which the section refers the reader.
"""

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

from blackboard.errors import UncertaintyError
from blackboard.uncertainty.limits import finite, within

X = TypeVar("X", bound=Hashable)
Y = TypeVar("Y", bound=Hashable)


@dataclass(frozen=True, slots=True)
class Membership:
    """A membership function through `points` (value, degree) in rising order: straight between them, level beyond the ends."""

    points: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        if not self.points:
            raise UncertaintyError("a membership function needs at least one point (value, degree)")
        values = [finite("value", value) for value, _ in self.points]
        if any(following <= value for value, following in pairwise(values)):
            raise UncertaintyError(f"values {values} of a membership function must rise from each point to the next")
        degrees = [_degree(degree) for _, degree in self.points]
        object.__setattr__(self, "points", tuple(zip(values, degrees, strict=True)))

    def degree(self, value: float) -> float:
        """Return how far `value` belongs to the set, in [0, 1]."""
        value = finite("value", value)
        if value <= self.points[0][0]:
            return self.points[0][1]
        for (left, left_degree), (right, right_degree) in pairwise(self.points):
            if value <= right:
                share = (value - left) / (right - left)
                return left_degree * (1.0 - share) + right_degree * share
        return self.points[-1][1]


def triangle(low: float, peak: float, high: float) -> Membership:
    """Return the membership that is 1 at `peak` and falls to 0 at `low` and `high`."""
    return Membership(((low, 0.0), (peak, 1.0), (high, 0.0)))


def conjunction(a: float, b: float) -> float:
    """Return the degree of A AND B: min(a, b)."""
    return min(_degree(a), _degree(b))


def disjunction(a: float, b: float) -> float:
    """Return the degree of A OR B: max(a, b)."""
    return max(_degree(a), _degree(b))


def negation(a: float) -> float:
    """Return the degree of NOT A: 1 - a."""
    return 1.0 - _degree(a)


def implication(a: float, b: float) -> float:
    """Return the degree of IF A THEN B: min(1, 1 - a + b)."""
    return min(1.0, 1.0 - _degree(a) + _degree(b))


def intersection(first: Mapping[X, float], second: Mapping[X, float]) -> dict[X, float]:
    """Return the members that both sets name, by the smaller degree, in the order of `first`; what is not named has 0."""
    a, b = _degrees(first), _degrees(second)
    return {x: min(a[x], b[x]) for x in a if x in b}


def union(first: Mapping[X, float], second: Mapping[X, float]) -> dict[X, float]:
    """Return the members that either set names, by the larger degree, those of `first` first; what is not named has 0."""
    a, b = _degrees(first), _degrees(second)
    return {x: max(a.get(x, 0.0), b.get(x, 0.0)) for x in (*a, *b)}


def complement(members: Mapping[X, float]) -> dict[X, float]:
    """Return 1 - a for each member; every thing that is talked about must be named, with 0 where it does not belong."""
    return {x: negation(a) for x, a in members.items()}


def compose(members: Mapping[X, float], relation: Mapping[tuple[X, Y], float]) -> dict[Y, float]:
    """Return the set that `members` become through a fuzzy `relation`: b(y) = max over x of min(a(x), r(x, y))."""
    a, image = _degrees(members), dict[Y, float]()
    for (x, y), r in _degrees(relation).items():
        image[y] = max(image.get(y, 0.0), min(a.get(x, 0.0), r))
    return image


def _degree(value: float) -> float:
    return within("degree of membership", value, 0.0, 1.0)


def _degrees(members: Mapping[X, float]) -> dict[X, float]:
    return {x: _degree(degree) for x, degree in members.items()}
