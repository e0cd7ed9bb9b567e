"""Programs back to CLIPS text: for CLIPS itself, for people, and to tell whether two rules are the same.

`names` puts other names in the place of functions, for an engine that has them under others; there `post` stays the flat call
that it is. Without it what is written reads as the same program, but for the positions.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby

from rules.language.definition_order import Declared, in_order
from rules.language.syntax import (
    Action,
    All,
    AnyOf,
    Assert,
    Atom,
    Bind,
    Condition,
    Constant,
    Constraint,
    Deffacts,
    Exists,
    Expression,
    FactForm,
    Function,
    Global,
    GlobalUse,
    If,
    Match,
    Modify,
    Not,
    Pattern,
    Position,
    Predicate,
    Program,
    Retract,
    Returned,
    Rule,
    Slot,
    Template,
    Test,
    VariableUse,
    Wildcard,
)
from rules.language.values import written

Names = Mapping[str, str]


def program_text(program: Program, names: Names | None = None) -> str:
    """Return a whole program, each construct after what it needs."""
    return "\n\n".join(text for text, _ in written_constructs(program, names)) + "\n"


def written_constructs(program: Program, names: Names | None = None) -> Iterator[tuple[str, Position | None]]:
    """Yield the text of each construct with its place, each after what it needs, as CLIPS wants them."""
    for template in program.templates:
        yield template_text(template), template.position
    for definition in in_order(program):
        if isinstance(definition, Global):
            yield global_text(definition, names), definition.position
        elif isinstance(definition, Declared):
            yield f"({_function_head(definition.function)})", definition.function.position
        else:
            yield function_text(definition, names), definition.position
    for deffacts in program.deffacts:
        yield deffacts_text(deffacts, names), deffacts.position
    for rule in program.rules:
        yield rule_text(rule, names), rule.position


def template_text(template: Template) -> str:
    """Return a deftemplate."""
    return _lines(f"deftemplate {template.name}", template.doc, *map(_slot_text, template.slots))


def _slot_text(slot: Slot) -> str:
    head = f"{'multislot' if slot.multi else 'slot'} {slot.name}"
    if slot.default is None:
        return f"({head})"
    values = slot.default if isinstance(slot.default, tuple) else (slot.default,)
    return f"({head} {_joined('default', map(written, values))})"


def global_text(definition: Global, names: Names | None = None) -> str:
    """Return a defglobal."""
    return f"(defglobal ?*{definition.name}* = {expression_text(definition.value, names)})"


def function_text(function: Function, names: Names | None = None) -> str:
    """Return a deffunction."""
    doc = f" {written(function.doc)}" if function.doc else ""
    head = _function_head(function).replace(f"deffunction {function.name}", f"deffunction {function.name}{doc}", 1)
    return _lines(head, "", *(action_text(action, names) for action in function.body))


def _function_head(function: Function) -> str:
    rest = [f"$?{function.rest}"] if function.rest is not None else []
    return f"deffunction {function.name} ({' '.join([*(f'?{name}' for name in function.parameters), *rest])})"


def deffacts_text(deffacts: Deffacts, names: Names | None = None) -> str:
    """Return a deffacts."""
    return _lines(f"deffacts {deffacts.name}", deffacts.doc, *(fact_text(fact, names) for fact in deffacts.facts))


def rule_text(rule: Rule, names: Names | None = None) -> str:
    """Return a defrule."""
    declared = [f"(declare (salience {rule.salience}))"] if rule.salience else []
    left = [*declared, *(condition_text(condition, names) for condition in rule.conditions)]
    return _lines(f"defrule {rule.name}", rule.doc, *left, "=>", *(action_text(a, names) for a in rule.actions))


def condition_text(condition: Condition, names: Names | None = None) -> str:
    """Return a condition."""
    if isinstance(condition, Match):
        pattern = pattern_text(condition.pattern, names)
        return pattern if condition.binding is None else f"?{condition.binding} <- {pattern}"
    if isinstance(condition, Test):
        return f"(test {expression_text(condition.expression, names)})"
    if isinstance(condition, Not):
        return f"(not {condition_text(condition.condition, names)})"
    word = {Exists: "exists", All: "and", AnyOf: "or"}[type(condition)]
    return _joined(word, (condition_text(one, names) for one in condition.conditions))


def pattern_text(pattern: Pattern, names: Names | None = None) -> str:
    """Return a pattern."""
    constraints = [constraint_text(constraint, names) for constraint in pattern.constraints]
    return _joined(pattern.relation, _in_slots(pattern.slots, constraints))


def constraint_text(constraint: Constraint, names: Names | None = None) -> str:
    """Return what stands for one field."""
    text = "|".join("&".join(_atom_text(atom, names) for atom in atoms) for atoms in constraint.alternatives)
    return text if constraint.binds is None else f"{expression_text(constraint.binds)}&{text}"


def _atom_text(atom: Atom, names: Names | None) -> str:
    term, sign = atom.term, "~" if atom.negated else ""
    if isinstance(term, Wildcard):
        return f"{sign}{'$?' if term.multi else '?'}"
    if isinstance(term, Predicate | Returned):
        return f"{sign}{':' if isinstance(term, Predicate) else '='}{expression_text(term.expression, names)}"
    return f"{sign}{expression_text(term, names)}"


def fact_text(fact: FactForm, names: Names | None = None) -> str:
    """Return a fact of assert or deffacts."""
    return _joined(fact.relation, _in_slots(fact.slots, [expression_text(field, names) for field in fact.fields]))


def _in_slots(slots: tuple[str, ...] | None, texts: Sequence[str]) -> list[str]:
    """Return the texts, those of a slot in its bracket."""
    if slots is None:
        return list(texts)
    grouped = groupby(zip(slots, texts, strict=True), key=lambda pair: pair[0])
    return [_joined(slot, (text for _, text in pairs)) for slot, pairs in grouped]


def action_text(action: Action, names: Names | None = None) -> str:
    """Return an action."""
    if isinstance(action, Assert):
        return _joined("assert", (fact_text(fact, names) for fact in action.facts))
    if isinstance(action, Retract):
        return _joined("retract", (expression_text(fact, names) for fact in action.facts))
    if isinstance(action, Modify):
        slots = [_joined(slot, (expression_text(v, names) for v in values)) for slot, values in action.slots]
        return _joined("modify", [expression_text(action.fact, names), *slots])
    if isinstance(action, Bind):
        target = f"?*{action.name}*" if action.is_global else f"?{action.name}"
        return _joined("bind", [target, *(expression_text(value, names) for value in action.values)])
    if isinstance(action, If):
        otherwise = ["else", *(action_text(one, names) for one in action.otherwise)] if action.otherwise else []
        then = [action_text(one, names) for one in action.then]
        return _joined("if", [expression_text(action.condition, names), "then", *then, *otherwise])
    return expression_text(action, names)


def expression_text(expression: Expression, names: Names | None = None) -> str:
    """Return an expression."""
    if isinstance(expression, Constant):
        return written(expression.value)
    if isinstance(expression, VariableUse):
        return f"{'$?' if expression.multi else '?'}{expression.name}"
    if isinstance(expression, GlobalUse):
        return f"?*{expression.name}*"
    arguments = [expression_text(argument, names) for argument in expression.arguments]
    if names is None and expression.function == "post":
        slots = [f"({slot} {value})" for slot, value in zip(arguments[1::2], arguments[2::2], strict=True)]
        return f"(post {_joined(arguments[0], slots)})"
    return _joined((names or {}).get(expression.function, expression.function), arguments)


def _joined(head: str, parts: Iterable[str]) -> str:
    return f"({' '.join([head, *parts])})"


def _lines(head: str, doc: str, *parts: str) -> str:
    return "\n  ".join([f"({head}{f' {written(doc)}' if doc else ''}", *parts]) + ")"
