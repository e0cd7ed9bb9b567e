"""Which facts a program can bring about, as far as its text says: constants are known, all else may be anything."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from rules.language.actions import default_of
from rules.language.functions import FUNCTIONS
from rules.language.library.multifields import MULTIFIELDS
from rules.language.syntax import (
    Assert,
    Atom,
    Bind,
    Call,
    Condition,
    Constant,
    Constraint,
    Exists,
    Expression,
    FactForm,
    GlobalUse,
    Match,
    Modify,
    Pattern,
    Program,
    Rule,
    Template,
    VariableUse,
    Wildcard,
)
from rules.language.values import Value, same
from rules.language.walk import actions_of, patterns_in

Known = Value | None  # None: may be anything
GIVES_ONE = ("nth$", "length$", "member$", "subsetp")  # of the functions of multifields, those that return one value


@dataclass(frozen=True, slots=True)
class Row:
    """The fields of an ordered fact; more of them may follow where it is `open`."""

    fields: tuple[Known, ...]
    open: bool = False


@dataclass
class Facts:
    """All facts that stand at the start or that some rule asserts."""

    templates: Mapping[str, Template]
    rows: dict[str, list[Row]] = field(default_factory=dict)
    slots: dict[str, dict[str, list[Known]]] = field(default_factory=dict)
    written: dict[str, set[str]] = field(default_factory=dict)  # slots that are set, by template

    @classmethod
    def at_the_start(cls, program: Program) -> "Facts":
        """Return what the deffacts say."""
        facts = cls({template.name: template for template in program.templates})
        for deffacts in program.deffacts:
            for form in deffacts.facts:
                facts.add(form)
        return facts

    def add(self, form: FactForm, singles: Collection[str] = ()) -> None:
        """Take in a fact that is asserted; `singles` are the variables that hold one value for sure."""
        template = self.templates.get(form.relation)
        if template is None or form.slots is None:
            self.rows.setdefault(form.relation, []).append(_row(form.fields, singles))
            return
        held = self.slots.setdefault(form.relation, {})
        for slot in template.slots:
            given = [value for name, value in zip(form.slots, form.fields, strict=True) if name == slot.name]
            self._set(form.relation, held, slot.name, given)
            if not given:
                held.setdefault(slot.name, []).append(None if slot.multi else default_of(slot.multi, slot.default))

    def _set(self, relation: str, held: dict[str, list[Known]], slot: str, values: Sequence[Expression]) -> None:
        if values:
            self.written.setdefault(relation, set()).add(slot)
            one = values[0].value if len(values) == 1 and isinstance(values[0], Constant) else None
            held.setdefault(slot, []).append(one)

    def add_all_of(self, rule: Rule) -> None:
        """Take in all that a rule may assert and modify."""
        relations, singles = bound_relations(rule), _singles(rule)
        for action in actions_of(rule.actions):
            if isinstance(action, Assert):
                for form in action.facts:
                    self.add(form, singles)
            elif isinstance(action, Modify) and isinstance(action.fact, VariableUse):
                relation = relations.get(action.fact.name, "")
                for slot, values in action.slots:
                    self._set(relation, self.slots.setdefault(relation, {}), slot, values)

    def has(self, relation: str) -> bool:
        """Say whether there may be any such fact."""
        return relation in self.rows or relation in self.slots or self.is_of_board(relation)

    def is_of_board(self, relation: str) -> bool:
        """Say whether the facts come from the board."""
        return relation in self.templates and self.templates[relation].position is None

    def match(self, pattern: Pattern) -> bool:
        """Say whether some fact may match a pattern."""
        if self.is_of_board(pattern.relation):
            return True
        if pattern.slots is None:
            return any(_fits(row, pattern.constraints) for row in self.rows.get(pattern.relation, ()))
        held = self.slots.get(pattern.relation)
        return held is not None and all(
            any(admits(constraint, value) for value in held.get(slot, [None]))
            for slot, constraint in zip(pattern.slots, pattern.constraints, strict=True)
            if not self._is_multi(pattern.relation, slot)
        )

    def _is_multi(self, relation: str, slot: str) -> bool:
        return any(one.multi for one in self.templates[relation].slots if one.name == slot)

    def constants(self, pattern: Pattern, index: int) -> list[Value] | None:
        """Return what may stand in a pattern's field; None where it may be anything."""
        if pattern.slots is not None:
            found = self.slots.get(pattern.relation, {}).get(pattern.slots[index], [None])
        else:
            rows = self.rows.get(pattern.relation, [])
            found = [row.fields[index] if index < len(row.fields) else None for row in rows]
        return None if None in found else [value for value in found if value is not None]


def bound_relations(rule: Rule) -> dict[str, str]:
    """Return the relations of the facts that `?f <-` binds, by variable."""
    found: dict[str, str] = {}

    def look(conditions: Iterable[Condition]) -> None:
        for condition in conditions:
            if isinstance(condition, Match):
                if condition.binding is not None:
                    found[condition.binding] = condition.pattern.relation
            elif hasattr(condition, "conditions") and not isinstance(condition, Exists):
                look(condition.conditions)

    look(rule.conditions)
    return found


def _singles(rule: Rule) -> set[str]:
    """Return the variables that patterns bind to one field each, and that no `bind` changes."""
    found: set[str] = set()
    for pattern in patterns_in(rule.conditions):
        for constraint in pattern.constraints:
            term = constraint.binds or constraint.alternatives[0][0].term
            if isinstance(term, VariableUse) and not term.multi:
                found.add(term.name)
    return found - {action.name for action in actions_of(rule.actions) if isinstance(action, Bind)}


def _row(fields: Sequence[Expression], singles: Collection[str]) -> Row:
    known: list[Known] = []
    for one in fields:
        if _may_be_several(one) and not (isinstance(one, VariableUse) and one.name in singles):
            return Row(tuple(known), open=True)
        known.append(one.value if isinstance(one, Constant) else None)
    return Row(tuple(known))


def _may_be_several(expression: Expression) -> bool:
    """A variable that `bind` set, a global, or a function's value may be a multifield; so may one from a $? elsewhere."""
    if isinstance(expression, Call):
        is_row = expression.function in MULTIFIELDS and expression.function not in GIVES_ONE
        return is_row or expression.function not in (*FUNCTIONS, "and", "or", "now")
    return isinstance(expression, VariableUse | GlobalUse)


def _fits(row: Row, constraints: Sequence[Constraint]) -> bool:
    several = next((i for i, constraint in enumerate(constraints) if is_several(constraint)), None)
    if several is None and not row.open:
        if len(row.fields) != len(constraints):
            return False
    elif not row.open and len(row.fields) < len(constraints) - 1:
        return False
    firm = len(constraints) if several is None else several
    return all(admits(c, value) for c, value in zip(constraints[:firm], row.fields, strict=False))


def is_several(constraint: Constraint) -> bool:
    """Say whether a constraint is on any number of fields."""
    term = constraint.binds or constraint.alternatives[0][0].term
    return isinstance(term, VariableUse | Wildcard) and term.multi


def admits(constraint: Constraint, value: Known) -> bool:
    """Say whether a field that holds this value may meet a constraint."""
    return value is None or any(all(_may_hold(atom, value) for atom in atoms) for atoms in constraint.alternatives)


def _may_hold(atom: Atom, value: Value) -> bool:
    return not isinstance(atom.term, Constant) or same(atom.term.value, value) is not atom.negated
