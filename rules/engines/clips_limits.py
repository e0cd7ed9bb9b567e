"""What CLIPS 6.42 cannot run though it is CLIPS.

Among the fields of an ordered fact, after a `$?`, these end the process: `=(...)`, and `|` with a variable of another pattern.
"""

from rules.language.errors import RuleError
from rules.language.syntax import (
    Constraint,
    Program,
    Returned,
    VariableUse,
    Wildcard,
)
from rules.language.walk import patterns_in


def refuse_crashing(program: Program) -> None:
    """Raise RuleError for the first pattern that would end the process."""
    for rule in program.rules:
        for pattern in patterns_in(rule.conditions):
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
