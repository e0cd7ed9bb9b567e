"""Calls of external functions, written so that clipspy passes their arguments on as they are.

clipspy 1.0.6 passes a part of a multifield, which is what `$?x` is bound to, as the whole that it is a part of: so each argument is
copied first.
"""

from collections.abc import Container, Sequence
from dataclasses import replace

from rules.language.syntax import Action, Assert, Bind, Call, Expression, If, Modify, Program, Retract, Rule

COPY = "ski-copy"
COPY_FUNCTION = f"(deffunction {COPY} (?x) (if (multifieldp ?x) then (create$ ?x) else ?x))"


def copying(program: Program, externals: Container[str]) -> Program:
    """Return the program with the arguments of external functions copied."""
    return replace(program, rules=tuple(_rule(rule, externals) for rule in program.rules))


def _rule(rule: Rule, externals: Container[str]) -> Rule:
    return replace(rule, actions=_actions(rule.actions, externals))


def _actions(actions: Sequence[Action], externals: Container[str]) -> tuple[Action, ...]:
    return tuple(_action(action, externals) for action in actions)


def _action(action: Action, externals: Container[str]) -> Action:
    def inner(expressions: Sequence[Expression]) -> tuple[Expression, ...]:
        return tuple(_expression(one, externals) for one in expressions)

    match action:
        case Assert(facts=facts):
            return replace(action, facts=tuple(replace(fact, fields=inner(fact.fields)) for fact in facts))
        case Retract(facts=addresses):
            return replace(action, facts=inner(addresses))
        case Modify(slots=slots):
            return replace(action, slots=tuple((name, inner(values)) for name, values in slots))
        case Bind(values=values):
            return replace(action, values=inner(values))
        case If():
            condition = _expression(action.condition, externals)
            then, otherwise = _actions(action.then, externals), _actions(action.otherwise, externals)
            return replace(action, condition=condition, then=then, otherwise=otherwise)
        case _:
            return _expression(action, externals)


def _expression(expression: Expression, externals: Container[str]) -> Expression:
    if not isinstance(expression, Call):
        return expression
    arguments = tuple(_expression(one, externals) for one in expression.arguments)
    if expression.function in externals:
        arguments = tuple(Call(COPY, (one,), expression.position) for one in arguments)
    return replace(expression, arguments=arguments)
