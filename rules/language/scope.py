"""Which variables are bound where: a variable that is used without a value, or a fact taken for a value, is a fault.

As in CLIPS a variable is bound where it first stands alone in a field, or first in it before `&`; what `not` and `exists` bind
holds within them only.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence

from blackboard.errors import did_you_mean
from rules.language.alternatives import MOST_ALTERNATIVES, alternatives, number_of_alternatives
from rules.language.argument_kinds import ROW, SINGLE, unfit
from rules.language.errors import RuleError
from rules.language.reading.slots import check_one_value, check_single, slot_named
from rules.language.syntax import (
    Action,
    Assert,
    Bind,
    Call,
    Condition,
    Constraint,
    Exists,
    Expression,
    Function,
    If,
    Match,
    Modify,
    Not,
    Pattern,
    Predicate,
    Retract,
    Returned,
    Rule,
    Template,
    Test,
    VariableUse,
)


def rule_faults(rule: Rule, templates: Mapping[str, Template]) -> list[RuleError]:
    """Return the faults of a rule."""
    return _Scope(templates).rule(rule)


def function_faults(function: Function) -> list[RuleError]:
    """Return the faults of a deffunction."""
    return _Scope({}).function(function)


class _Scope:
    """What is bound at a place of one rule or function."""

    def __init__(self, templates: Mapping[str, Template]) -> None:
        self.templates = templates
        self.bound: dict[str, bool] = {}  # by name: whether it holds a multifield
        self.facts: dict[str, str] = {}  # by name: the relation of the fact
        self.set: set[str] = set()  # by `bind` or a caller: they may hold anything
        self.nested = False  # within not or exists
        self.faults: list[RuleError] = []

    def rule(self, rule: Rule) -> list[RuleError]:
        number = number_of_alternatives(rule.conditions)
        if number > MOST_ALTERNATIVES:
            text = f"the (or ...)s of this rule write out to {number} rules, more than {MOST_ALTERNATIVES}: split it"
            return [RuleError(text, rule.position)]
        for row in alternatives(rule.conditions):
            self.bound, self.facts, self.set = {}, {}, set()
            for condition in row:
                self._condition(condition)
            self._actions(rule.actions)
        return self.faults

    def function(self, function: Function) -> list[RuleError]:
        self.bound = dict.fromkeys(function.parameters, False)
        if function.rest is not None:
            self.bound[function.rest] = True
        self.set = set(function.parameters)  # whoever calls it may give a multifield
        self._actions(function.body)
        return self.faults

    def _condition(self, condition: Condition) -> None:
        if isinstance(condition, Match):
            self._pattern(condition.pattern)
            if condition.binding is not None:
                self._bind_fact(condition.binding, condition.pattern)
        elif isinstance(condition, Test):
            self._expression(condition.expression)
        elif isinstance(condition, Not | Exists):
            self._within((condition.condition,) if isinstance(condition, Not) else condition.conditions)

    def _within(self, conditions: Sequence[Condition]) -> None:
        outer, nested = dict(self.bound), self.nested
        self.nested = True
        for row in alternatives(conditions):
            self.bound = dict(outer)
            for condition in row:
                self._condition(condition)
        self.bound, self.nested = outer, nested

    def _bind_fact(self, name: str, pattern: Pattern) -> None:
        if self.nested:
            self._fault(f"?{name} <- has no place within not and exists: no one fact is meant", pattern)
        elif name in self.bound or name in self.facts:
            self._fault(f"?{name} <- is bound a second time", pattern)
        self.facts[name] = pattern.relation

    def _pattern(self, pattern: Pattern) -> None:
        for constraint in pattern.constraints:
            self._constraint(constraint)

    def _constraint(self, constraint: Constraint) -> None:
        alone = len(constraint.alternatives) == 1 and len(constraint.alternatives[0]) == 1
        first = constraint.alternatives[0][0]
        if constraint.binds is not None:
            self._bind(constraint.binds)
        elif alone and isinstance(first.term, VariableUse) and not first.negated:
            self._bind(first.term)
            return
        for atoms in constraint.alternatives:
            for atom in atoms:
                if isinstance(atom.term, VariableUse):
                    self._use(atom.term, in_pattern=True)
                elif isinstance(atom.term, Predicate | Returned):
                    self._expression(atom.term.expression)

    def _bind(self, variable: VariableUse) -> None:
        if variable.name in self.facts:
            self._fault(f"?{variable.name} is a fact; facts are for retract and modify only", variable)
        elif self.bound.setdefault(variable.name, variable.multi) is not variable.multi:
            self._fault(f"?{variable.name} is used for one field and for several ($?{variable.name})", variable)

    def _use(self, variable: VariableUse, *, in_pattern: bool = False) -> None:
        if variable.name in self.facts:
            self._fault(f"?{variable.name} is a fact; facts are for retract and modify only", variable)
        elif variable.name not in self.bound:
            where = (
                ": a variable gets its value where it stands alone in a field, or first before &" if in_pattern else ""
            )
            near = where or did_you_mean(variable.name, self.bound)
            self._fault(f"?{variable.name} has no value here{near}", variable)

    def _expression(self, expression: Expression) -> None:
        if isinstance(expression, VariableUse):
            self._use(expression)
        elif isinstance(expression, Call):
            for index, argument in enumerate(expression.arguments):
                self._expression(argument)
                if isinstance(argument, VariableUse) and argument.name in self.bound and argument.name not in self.set:
                    kinds = ROW if self.bound[argument.name] else SINGLE
                    wrong = unfit(expression.function, index, argument, kinds)
                    if wrong is not None:
                        self._fault(wrong, argument)

    def _actions(self, actions: Iterable[Action]) -> None:
        for action in actions:
            self._action(action)

    def _action(self, action: Action) -> None:
        if isinstance(action, Retract | Modify):
            for fact in action.facts if isinstance(action, Retract) else (action.fact,):
                if isinstance(fact, VariableUse) and fact.name not in self.facts:
                    near = did_you_mean(fact.name, self.facts) or "; bind it in a condition: ?fact <- (pattern)"
                    self._fault(f"?{fact.name} is no fact{near}", fact)
            if isinstance(action, Modify):
                self._modified(action)
        elif isinstance(action, Call) and action.function == "retract-entry":
            for argument in action.arguments:
                if not (isinstance(argument, VariableUse) and argument.name in self.facts):
                    self._expression(argument)
        elif isinstance(action, If):
            self._expression(action.condition)
            self._actions((*action.then, *action.otherwise))
        elif isinstance(action, Bind):
            for value in action.values:
                self._expression(value)
            if not action.is_global:
                self.facts.pop(action.name, None)
                self.bound[action.name] = False
                self.set.add(action.name)
        else:
            for expression in _expressions(action):
                self._expression(expression)

    def _modified(self, action: Modify) -> None:
        for _, values in action.slots:
            for value in values:
                self._expression(value)
        name = action.fact.name if isinstance(action.fact, VariableUse) else ""
        if name not in self.facts:
            return
        template = self.templates.get(self.facts[name])
        if template is None:
            self._fault(f"'{self.facts[name]}' is no template: retract the fact and assert another", action)
            return
        for slot_name, values in action.slots:
            try:
                slot = slot_named(slot_name, template, action.position)
                check_single(slot, len(values), action.position)
                check_one_value(slot, values)
            except RuleError as fault:
                self.faults.append(fault)

    def _fault(self, text: str, where: VariableUse | Pattern | Action) -> None:
        self.faults.append(RuleError(text, where.position))


def _expressions(action: Action) -> Iterator[Expression]:
    if isinstance(action, Assert):
        for fact in action.facts:
            yield from fact.fields
    elif isinstance(action, Call | VariableUse):
        yield action
