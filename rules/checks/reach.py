"""Rules that cannot fire since no fact ever matches what they wait for, conditions that always hold, slots that nobody sets."""

from collections.abc import Iterable, Iterator

from blackboard.errors import did_you_mean
from rules.checks.facts import Facts, admits
from rules.checks.finding import Finding
from rules.language.alternatives import alternatives
from rules.language.syntax import Condition, Constant, Constraint, Exists, Match, Not, Pattern, Program, Rule, Wildcard
from rules.language.values import Symbol, Value, written
from rules.language.walk import patterns_in


def reach_findings(program: Program) -> Iterator[Finding]:
    """Yield what can never match, where that shows from the text alone."""
    everything = Facts.at_the_start(program)
    for rule in program.rules:
        everything.add_all_of(rule)
    yield from _without_a_cause(program, everything)
    yield from _always_true(program, everything)
    yield from _never_set(program, everything)


def _without_a_cause(program: Program, everything: Facts) -> Iterator[Finding]:
    """First the rules that nothing in the program can set off; then those that wait for each other."""
    reached = Facts.at_the_start(program)
    waiting: list[Rule] = []
    for rule in program.rules:
        missing = _missing(rule, everything)
        if missing is None:
            waiting.append(rule)
        else:
            reached.add_all_of(rule)  # what it would assert is not told a second time
            yield Finding(_why(missing, everything, rule), missing.position)
    while True:
        able = [rule for rule in waiting if _missing(rule, reached) is None]
        if not able:
            break
        for rule in able:
            reached.add_all_of(rule)
        waiting = [rule for rule in waiting if rule not in able]
    for rule in waiting:
        missing = _missing(rule, reached)
        if missing is not None:
            text = f"the rule '{rule.name}' cannot fire: what it waits for is asserted only by rules that wait for it in turn"
            yield Finding(text, missing.position)


def _missing(rule: Rule, facts: Facts) -> Pattern | None:
    """Return the first pattern that nothing matches; None where the rule may fire by some way through its `or`s."""
    first: Pattern | None = None
    for row in alternatives(rule.conditions):
        missing = next((pattern for pattern in _needed(row) if not facts.match(pattern)), None)
        if missing is None:
            return None
        first = first or missing
    return first


def _needed(row: Iterable[Condition]) -> Iterator[Pattern]:
    for condition in row:
        if isinstance(condition, Match):
            yield condition.pattern
        elif isinstance(condition, Exists):
            rows = alternatives(condition.conditions)
            if len(rows) == 1:
                yield from _needed(rows[0])


def _why(pattern: Pattern, facts: Facts, rule: Rule) -> str:
    cannot = f"the rule '{rule.name}' cannot fire"
    if not facts.has(pattern.relation):
        near = did_you_mean(pattern.relation, [*facts.rows, *facts.templates])
        return f"nothing asserts ({pattern.relation} ...), so {cannot}{near if near.startswith('; did') else ''}"
    for index, constraint in enumerate(pattern.constraints):
        held = facts.constants(pattern, index)
        wanted = _constants(constraint)
        if held is not None and wanted and not any(admits(constraint, value) for value in held):
            words = [value.name for value in held if isinstance(value, Symbol)]
            near = did_you_mean(str(wanted[0]), words)
            which = "" if pattern.slots is None else f" in the slot '{pattern.slots[index]}'"
            return f"nothing asserts ({pattern.relation} ...) with {written(wanted[0])}{which}, so {cannot}{near}"
    return f"nothing asserts a ({pattern.relation} ...) that matches this, so {cannot}"


def _constants(constraint: Constraint) -> list[Value]:
    atoms = [atom for row in constraint.alternatives for atom in row]
    return [atom.term.value for atom in atoms if isinstance(atom.term, Constant) and not atom.negated]


def _always_true(program: Program, facts: Facts) -> Iterator[Finding]:
    """`not` with a relation that nobody asserts always holds: most often a misspelt name."""
    for rule in program.rules:
        for row in alternatives(rule.conditions):
            for condition in row:
                if isinstance(condition, Not) and isinstance(condition.condition, Match):
                    pattern = condition.condition.pattern
                    if not facts.has(pattern.relation):
                        near = did_you_mean(pattern.relation, [*facts.rows, *facts.templates])
                        text = f"nothing asserts ({pattern.relation} ...), so this (not ...) always holds"
                        yield Finding(text + (near if near.startswith("; did") else ""), pattern.position)


def _never_set(program: Program, facts: Facts) -> Iterator[Finding]:
    told: set[tuple[str, str]] = set()
    for rule in program.rules:
        for pattern in patterns_in(rule.conditions):
            if facts.is_of_board(pattern.relation) or pattern.slots is None or pattern.relation not in facts.slots:
                continue
            for slot, constraint in zip(pattern.slots, pattern.constraints, strict=True):
                is_looked_at = not isinstance(constraint.alternatives[0][0].term, Wildcard)
                is_set = slot in facts.written.get(pattern.relation, ())
                if is_looked_at and not is_set and (pattern.relation, slot) not in told:
                    told.add((pattern.relation, slot))
                    text = f"nothing sets the slot '{slot}' of '{pattern.relation}': it always holds its default"
                    yield Finding(text, constraint.position)
