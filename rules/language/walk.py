"""Ways through the records of a program: the patterns, calls and facts of a rule, wherever they stand."""

from collections.abc import Iterable, Iterator

from rules.language.syntax import (
    Action,
    All,
    AnyOf,
    Assert,
    Bind,
    Call,
    Condition,
    Exists,
    Expression,
    FactForm,
    If,
    Match,
    Modify,
    Not,
    Pattern,
    Rule,
)


def actions_of(actions: Iterable[Action]) -> Iterator[Action]:
    """Yield all actions, those within `if` too."""
    for action in actions:
        yield action
        if isinstance(action, If):
            yield from actions_of((*action.then, *action.otherwise))


def calls_of(rule: Rule) -> Iterator[Call]:
    """Yield every call on the right-hand side of a rule."""
    for action in actions_of(rule.actions):
        for expression in expressions_of(action):
            yield from calls_in(expression)


def calls_in(expression: Expression) -> Iterator[Call]:
    """Yield the calls of an expression, the outer before the inner."""
    if isinstance(expression, Call):
        yield expression
        for argument in expression.arguments:
            yield from calls_in(argument)


def expressions_of(action: Action) -> Iterator[Expression]:
    """Yield the expressions of one action, but not of those within it."""
    if isinstance(action, Assert):
        for fact in action.facts:
            yield from fact.fields
    elif isinstance(action, Modify):
        for _, values in action.slots:
            yield from values
    elif isinstance(action, Bind):
        yield from action.values
    elif isinstance(action, If):
        yield action.condition
    elif isinstance(action, Call):
        yield action


def asserted(rule: Rule) -> Iterator[FactForm]:
    """Yield the facts that a rule may assert."""
    for action in actions_of(rule.actions):
        if isinstance(action, Assert):
            yield from action.facts


def patterns_in(conditions: Iterable[Condition]) -> Iterator[Pattern]:
    """Yield all patterns, those within `not`, `exists`, `and` and `or` too."""
    for condition in conditions:
        if isinstance(condition, Match):
            yield condition.pattern
        elif isinstance(condition, Not):
            yield from patterns_in((condition.condition,))
        elif isinstance(condition, Exists | All | AnyOf):
            yield from patterns_in(condition.conditions)
