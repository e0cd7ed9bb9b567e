"""Endorsements: reasons for and against, weighed as reasons and never summed up in a number.

Source: Bou-Ghannam 1992, section 2.5.3.6 (theory of endorsements, after Cohen 1985), used as in section 2.6: a missing part is a
recorded reason against; a task looks for it; when it is found, the reason is taken back.

Whoever endorses again takes back what they said before about the same, and may withdraw it without saying anything else. Strength
is an order of endorsers, in tiers; what decides is a list of explicit rules, of which the first that holds gives the verdict.
Endorsers are named as they are, by a pattern such as `look-again-*`, or with what they speak about, such as `mug_detector/handle`
or `*/handle`.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Literal

from blackboard.entry import Endorsement
from blackboard.errors import UncertaintyError

Side = Literal["for", "against"]
Tiers = Sequence[Sequence[str]]

SIDES: tuple[Side, ...] = ("for", "against")
UNRESOLVED = "unresolved"
CONDITIONS = ("all_for", "any_for", "none_for", "all_against", "any_against", "none_against")


@dataclass(frozen=True, slots=True, kw_only=True)
class VerdictRule:
    """A verdict such as 'confirmed', and what must hold for it: every condition that is given, at least one.

    `all_*`: each of these endorsers says so; `any_*`: one of them does; `none_*`: none of them does. `strongest`: the
    strongest tier in which anyone speaks is for, is against, or is divided.
    """

    verdict: str
    all_for: tuple[str, ...] = ()
    any_for: tuple[str, ...] = ()
    none_for: tuple[str, ...] = ()
    all_against: tuple[str, ...] = ()
    any_against: tuple[str, ...] = ()
    none_against: tuple[str, ...] = ()
    strongest: Literal["for", "against", "divided"] | None = None

    def __post_init__(self) -> None:
        if not self.verdict:
            raise UncertaintyError("a rule of verdict needs a verdict, such as 'confirmed'")
        if self.strongest not in (None, "for", "against", "divided"):
            raise UncertaintyError(f"strongest = {self.strongest!r} must be 'for', 'against' or 'divided'")
        for condition in CONDITIONS:
            _check_patterns(f"{condition} of the rule for '{self.verdict}'", getattr(self, condition))
        if self.strongest is None and not any(getattr(self, condition) for condition in CONDITIONS):
            raise UncertaintyError(f"the rule for '{self.verdict}' has no condition: it would always hold; give it one")


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """What the rules make of the endorsements: the verdict, the rule that gave it (None: unresolved), and what stands."""

    verdict: str
    rule: VerdictRule | None
    standing: tuple[Endorsement, ...]


def reasons(endorsements: Iterable[Endorsement], side: Side) -> tuple[Endorsement, ...]:
    """Return the endorsements of one side, in the order given."""
    return tuple(e for e in endorsements if e.verdict == side)


def standing(endorsements: Iterable[Endorsement]) -> tuple[Endorsement, ...]:
    """Return the latest word of each endorser about each thing, oldest first, then by name; of one stamp the later given stands.

    What was withdrawn does not stand.
    """
    latest: dict[tuple[str, str], Endorsement] = {}
    for e in endorsements:
        name = (e.who, e.about)
        if name not in latest or e.stamp_s >= latest[name].stamp_s:
            latest[name] = e
    left = (e for e in latest.values() if e.verdict != "withdrawn")
    return tuple(sorted(left, key=lambda e: (e.stamp_s, e.who, e.about)))


def by_strength(endorsements: Iterable[Endorsement], tiers: Tiers) -> tuple[tuple[Endorsement, ...], ...]:
    """Return what stands by tier, strongest first: one tuple for each tier, and last those whom no tier names.

    An endorser belongs to the first tier with a name or pattern that fits.
    """
    for i, tier in enumerate(tiers, 1):
        _check_patterns(f"tier {i}", tier)
    groups: list[list[Endorsement]] = [[] for _ in range(len(tiers) + 1)]
    for e in standing(endorsements):
        place = next((i for i, tier in enumerate(tiers) if _fits(e, tier)), len(tiers))
        groups[place].append(e)
    return tuple(tuple(group) for group in groups)


def strongest_side(endorsements: Iterable[Endorsement], tiers: Tiers) -> Literal["for", "against", "divided"] | None:
    """Return what the strongest tier that has anyone says; None where nobody says anything."""
    for group in by_strength(endorsements, tiers):
        if group:
            sides = [side for side in SIDES if reasons(group, side)]
            return "divided" if len(sides) > 1 else sides[0]
    return None


def judge(endorsements: Iterable[Endorsement], rules: Sequence[VerdictRule], tiers: Tiers = ()) -> Judgement:
    """Return the verdict of the first rule that holds for what stands, strongest reasons first; else 'unresolved'."""
    groups = by_strength(endorsements, tiers)
    stands = tuple(e for group in groups for e in group)
    strongest = strongest_side(stands, tiers)
    rule = next((rule for rule in rules if _holds(rule, stands, strongest)), None)
    return Judgement(verdict=rule.verdict if rule else UNRESOLVED, rule=rule, standing=stands)


def lacking(endorsements: Iterable[Endorsement], rule: VerdictRule) -> tuple[str, ...]:
    """Return whose word `rule` still waits for (its `all_for` and `all_against`): what a resolution task should go and get."""
    stands = standing(endorsements)
    return (
        *_unsaid(rule.all_for, reasons(stands, "for")),
        *_unsaid(rule.all_against, reasons(stands, "against")),
    )


def _holds(rule: VerdictRule, stands: tuple[Endorsement, ...], strongest: str | None) -> bool:
    pro, contra = reasons(stands, "for"), reasons(stands, "against")
    return (
        not _unsaid(rule.all_for, pro)
        and not _unsaid(rule.all_against, contra)
        and (not rule.any_for or _said(rule.any_for, pro))
        and (not rule.any_against or _said(rule.any_against, contra))
        and not _said(rule.none_for, pro)
        and not _said(rule.none_against, contra)
        and rule.strongest in (None, strongest)
    )


def _said(patterns: Sequence[str], given: tuple[Endorsement, ...]) -> bool:
    return any(_fits(e, patterns) for e in given)


def _unsaid(patterns: Sequence[str], given: tuple[Endorsement, ...]) -> tuple[str, ...]:
    return tuple(pattern for pattern in patterns if not _said((pattern,), given))


def _fits(said: Endorsement, patterns: Sequence[str]) -> bool:
    names = (said.who, f"{said.who}/{said.about}") if said.about else (said.who,)
    return any(fnmatchcase(name, pattern) for pattern in patterns for name in names)


def _check_patterns(name: str, patterns: Sequence[str]) -> None:
    if isinstance(patterns, str) or not all(isinstance(p, str) and p for p in patterns):
        raise UncertaintyError(f"{name} = {patterns!r} must be a list of names of endorsers")
    if len(set(patterns)) < len(patterns):
        raise UncertaintyError(f"{name} = {list(patterns)!r} names an endorser twice; keep one")
