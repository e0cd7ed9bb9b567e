"""What CLIPS 6.42 cannot run though it is CLIPS.

Among the fields of an ordered fact, after a `$?`, these end the process: `=(...)`, and `|` with a variable of another pattern.
"""

from collections.abc import Iterable, Iterator

from rules.language.errors import RuleError
from rules.language.syntax import (
    All,
    AnyOf,
    Condition,
    Constraint,
    Exists,
    Match,
    Not,
    Pattern,
    Program,
    Returned,
    VariableUse,
    Wildcard,
)


def refuse_crashing(program: Program) -> None:
    """Raise RuleError for the first pattern that would end the process."""
    for rule in program.rules:
        for pattern in _patterns(rule.conditions):
            after_stretch = False
            for constraint in pattern.constraints if pattern.slots is None else ():
                if after_stretch and _crashes(constraint):
                    text = "CLIPS 6.42 crashes on =(...) or ?x|... after $?: write ?y&:(eq ?y ...), or use the engine experta"
                    raise RuleError(text, constraint.position)
                after_stretch = after_stretch or _is_stretch(constraint)


def _crashes(constraint: Constraint) -> bool:
    terms = [atom.term for row in constraint.alternatives for atom in row]
    chosen = len(constraint.alternatives) > 1
    return any(isinstance(term, Returned) or (chosen and isinstance(term, VariableUse)) for term in terms)


def _is_stretch(constraint: Constraint) -> bool:
    terms = [atom.term for row in constraint.alternatives for atom in row]
    return any(isinstance(term, VariableUse | Wildcard) and term.multi for term in (constraint.binds, *terms))


def _patterns(conditions: Iterable[Condition]) -> Iterator[Pattern]:
    for condition in conditions:
        if isinstance(condition, Match):
            yield condition.pattern
        elif isinstance(condition, Not):
            yield from _patterns((condition.condition,))
        elif isinstance(condition, Exists | All | AnyOf):
            yield from _patterns(condition.conditions)
