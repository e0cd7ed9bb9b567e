"""One question to every theory of hypotheses with reasons: confirmed, denied, or unresolved?

The reasons are endorsements. Bou-Ghannam 1992, section 2.5.3, describes the theories; a mission chooses one (`theory = "bayes"`).
What each makes of a weak, fair or strong reason is chosen alike: one strong reason decides, also against a fair one; a fair one
alone does not; fair ones against each other leave it open. They differ in what adds up: two fair reasons for the same decide in all
but fuzzy logic, where a conjunction or disjunction is never surer than its surest part.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Literal, get_args

from blackboard.entry import Endorsement, Strength
from blackboard.uncertainty import bayes, certainty, dempster_shafer, fuzzy
from blackboard.uncertainty.endorsements import reasons, standing

Theory = Literal["endorsements", "certainty-factors", "dempster-shafer", "bayes", "fuzzy"]
Outcome = Literal["confirmed", "denied", "unresolved"]

THEORIES: tuple[Theory, ...] = get_args(Theory)
FACTORS: dict[Strength, float] = {"weak": 0.2, "fair": 0.5, "strong": 0.9}  # certainty factor, and degree of support
RATIOS: dict[Strength, float] = {
    "weak": 1.5,
    "fair": 3.0,
    "strong": 20.0,
}  # likelihood, of the more to the less probable
DEGREES: dict[Strength, float] = {"weak": 0.2, "fair": 0.4, "strong": 0.9}  # of membership in what is certain
SURE_FACTOR = 0.7  # two fair reasons give 0.75, a strong one against a fair one 0.8
SURE_PROBABILITY = 0.85  # they give 0.9 and 0.87
SURE_DEGREE = 0.6  # a strong one against a fair one gives that
ENOUGH_FAIR = 2
FRAME = ("true", "false")


@dataclass(frozen=True, slots=True, kw_only=True)
class Belief:
    """What a theory makes of the reasons: belief and plausibility (the same where it has one number), and what is lacking."""

    outcome: Outcome
    belief: float
    plausibility: float
    lacking: tuple[str, ...] = ()


def judge(theory: Theory, endorsements: Iterable[Endorsement], needs: Sequence[str] = ()) -> Belief:
    """Return the verdict of `theory` on what stands of the endorsements.

    Nothing is confirmed while nobody speaks for one of the `needs`, things that endorsements are about: those are `lacking`.
    """
    stands = standing(endorsements)
    pro, contra = reasons(stands, "for"), reasons(stands, "against")
    lacking = tuple(need for need in needs if not any(e.about == need for e in pro))
    belief, plausibility, sure = _WEIGH[theory](pro, contra)
    outcome: Outcome = "unresolved"
    if sure == "for" and not lacking:
        outcome = "confirmed"
    elif sure == "against":
        outcome = "denied"
    return Belief(outcome=outcome, belief=belief, plausibility=plausibility, lacking=lacking)


Said = Sequence[Endorsement]
Weighed = tuple[float, float, Literal["for", "against"] | None]


def _by_reasons(pro: Said, contra: Said) -> Weighed:
    """Endorsements: the strongest reasons decide; divided ones, a single fair one and weak ones leave it open."""
    for strength, enough in (("strong", 1), ("fair", ENOUGH_FAIR)):
        for_, against = (sum(e.strength == strength for e in side) for side in (pro, contra))
        if for_ and against:
            break
        if for_ >= enough:
            return 1.0, 1.0, "for"
        if against >= enough:
            return 0.0, 0.0, "against"
    return 0.0, 1.0, None


def _by_factors(pro: Said, contra: Said) -> Weighed:
    factors = [FACTORS[e.strength] for e in pro] + [-FACTORS[e.strength] for e in contra]
    factor = certainty.combine_all(factors) if factors else 0.0
    share = (factor + 1.0) / 2.0
    return share, share, _side(factor, -factor, SURE_FACTOR)


def _by_evidence(pro: Said, contra: Said) -> Weighed:
    bodies = [dempster_shafer.support(FRAME, ("true",), FACTORS[e.strength]) for e in pro]
    bodies += [dempster_shafer.support(FRAME, ("false",), FACTORS[e.strength]) for e in contra]
    found = reduce(dempster_shafer.combine, bodies, dempster_shafer.support(FRAME, FRAME, 1.0))
    interval = dempster_shafer.interval(found, ("true",))
    against = dempster_shafer.belief(found, ("false",))
    return interval.belief, interval.plausibility, _side(interval.belief, against, SURE_FACTOR)


def _by_odds(pro: Said, contra: Said) -> Weighed:
    ratios = [RATIOS[e.strength] for e in pro] + [1.0 / RATIOS[e.strength] for e in contra]
    probability = bayes.probability(bayes.odds_after(1.0, ratios))  # as likely as not before anything is known
    return probability, probability, _side(probability, 1.0 - probability, SURE_PROBABILITY)


def _by_degrees(pro: Said, contra: Said) -> Weighed:
    for_, against = (reduce(fuzzy.disjunction, (DEGREES[e.strength] for e in side), 0.0) for side in (pro, contra))
    belief = fuzzy.conjunction(for_, fuzzy.negation(against))
    disbelief = fuzzy.conjunction(against, fuzzy.negation(for_))
    return belief, fuzzy.negation(disbelief), _side(belief, disbelief, SURE_DEGREE)


def _side(for_: float, against: float, sure: float) -> Literal["for", "against"] | None:
    if for_ >= sure:
        return "for"
    return "against" if against >= sure else None


_WEIGH = {
    "endorsements": _by_reasons,
    "certainty-factors": _by_factors,
    "dempster-shafer": _by_evidence,
    "bayes": _by_odds,
    "fuzzy": _by_degrees,
}
