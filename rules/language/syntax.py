"""What a rule file says, as records: templates, deffacts, globals, functions and rules, each with its place in its file.

The reader makes these, the engines compile them, the checks look at them; nothing here knows where they come from.
"""

from dataclasses import dataclass

from rules.language.values import Value


@dataclass(frozen=True, slots=True, order=True)
class Position:
    """Where something stands in a rule file; lines and columns count from 1."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


# Expressions


@dataclass(frozen=True, slots=True)
class Constant:
    """A literal value."""

    value: Value
    position: Position


@dataclass(frozen=True, slots=True)
class VariableUse:
    """`?x`, or `$?x` where `multi`."""

    name: str
    position: Position
    multi: bool = False


@dataclass(frozen=True, slots=True)
class GlobalUse:
    """`?*name*`."""

    name: str
    position: Position


@dataclass(frozen=True, slots=True)
class Call:
    """`(function argument ...)`. A board action is a call too: `(post (target (id a) (size-m 1)))` reads as `post` with the
    arguments `target`, then slot and value by turns: all in one flat row.
    """

    function: str
    arguments: tuple["Expression", ...]
    position: Position


Expression = Constant | VariableUse | GlobalUse | Call

# Patterns


@dataclass(frozen=True, slots=True)
class Wildcard:
    """`?`, or `$?` where `multi`."""

    position: Position
    multi: bool = False


@dataclass(frozen=True, slots=True)
class Predicate:
    """`:(...)`: holds where the expression is not FALSE."""

    expression: Expression
    position: Position


@dataclass(frozen=True, slots=True)
class Returned:
    """`=(...)`: holds where the field equals what the expression returns."""

    expression: Expression
    position: Position


Term = Constant | VariableUse | Wildcard | Predicate | Returned


@dataclass(frozen=True, slots=True)
class Atom:
    """One term of a constraint, with `~` where `negated`. A variable that nothing before has bound is bound here."""

    term: Term
    negated: bool = False


@dataclass(frozen=True, slots=True)
class Constraint:
    """What one field must be: any of the `alternatives` (`|`), of each all the atoms (`&`). `binds` is the variable of
    `?x&...`: bound (or tested) first, whatever alternative holds.
    """

    alternatives: tuple[tuple[Atom, ...], ...]
    position: Position
    binds: VariableUse | None = None


@dataclass(frozen=True, slots=True)
class Pattern:
    """`(relation constraint ...)`, or a template's where `slots` names what each constraint is on, as written.

    A multislot's constraints stand as several entries with the same slot name, in order.
    """

    relation: str
    constraints: tuple[Constraint, ...]
    position: Position
    slots: tuple[str, ...] | None = None


# Conditions


@dataclass(frozen=True, slots=True)
class Match:
    """A pattern that a fact must match; `binding` is the variable of `?f <-`."""

    pattern: Pattern
    binding: str | None = None


@dataclass(frozen=True, slots=True)
class Test:
    """`(test expression)`."""

    expression: Expression
    position: Position


@dataclass(frozen=True, slots=True)
class Not:
    """`(not condition)`."""

    condition: "Condition"
    position: Position


@dataclass(frozen=True, slots=True)
class Exists:
    """`(exists condition ...)`."""

    conditions: tuple["Condition", ...]
    position: Position


@dataclass(frozen=True, slots=True)
class All:
    """`(and condition ...)`."""

    conditions: tuple["Condition", ...]
    position: Position


@dataclass(frozen=True, slots=True)
class AnyOf:
    """`(or condition ...)`."""

    conditions: tuple["Condition", ...]
    position: Position


Condition = Match | Test | Not | Exists | All | AnyOf

# Actions


@dataclass(frozen=True, slots=True)
class FactForm:
    """A fact to be asserted or kept in deffacts; `slots` as in Pattern (a multislot's values stand as several entries)."""

    relation: str
    fields: tuple[Expression, ...]
    position: Position
    slots: tuple[str, ...] | None = None


@dataclass(frozen=True, slots=True)
class Assert:
    """`(assert fact ...)`."""

    facts: tuple[FactForm, ...]
    position: Position


@dataclass(frozen=True, slots=True)
class Retract:
    """`(retract ?f ...)`."""

    facts: tuple[Expression, ...]
    position: Position


@dataclass(frozen=True, slots=True)
class Modify:
    """`(modify ?f (slot value) ...)`."""

    fact: Expression
    slots: tuple[tuple[str, tuple[Expression, ...]], ...]
    position: Position


@dataclass(frozen=True, slots=True)
class Bind:
    """`(bind ?x value ...)`, or a global's where `is_global`."""

    name: str
    values: tuple[Expression, ...]
    position: Position
    is_global: bool = False


@dataclass(frozen=True, slots=True)
class If:
    """`(if condition then action ... [else action ...])`."""

    condition: Expression
    then: tuple["Action", ...]
    otherwise: tuple["Action", ...]
    position: Position


Action = Assert | Retract | Modify | Bind | If | Call | Constant | VariableUse | GlobalUse

# Constructs


@dataclass(frozen=True, slots=True)
class Slot:
    """A slot of a template; `default` is None where none is written (then nil, or an empty multifield)."""

    name: str
    multi: bool = False
    default: Value | None = None


@dataclass(frozen=True, slots=True)
class Template:
    """`(deftemplate name (slot ...) (multislot ...))`. `position` is None for those that follow from the vocabulary."""

    name: str
    slots: tuple[Slot, ...]
    doc: str = ""
    position: Position | None = None


@dataclass(frozen=True, slots=True)
class Deffacts:
    """`(deffacts name fact ...)`."""

    name: str
    facts: tuple[FactForm, ...]
    position: Position
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Global:
    """One `?*name* = value` of a defglobal."""

    name: str
    value: Expression
    position: Position


@dataclass(frozen=True, slots=True)
class Function:
    """`(deffunction name (?a $?rest) expression ...)`: returns its last expression, changes nothing."""

    name: str
    parameters: tuple[str, ...]
    rest: str | None
    body: tuple[Action, ...]
    position: Position
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Rule:
    """`(defrule name [doc] [(declare (salience n))] condition ... => action ...)`."""

    name: str
    conditions: tuple[Condition, ...]
    actions: tuple[Action, ...]
    position: Position
    salience: int = 0
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Program:
    """All files of a planning module together, in the order of their definitions."""

    templates: tuple[Template, ...] = ()
    deffacts: tuple[Deffacts, ...] = ()
    globals: tuple[Global, ...] = ()
    functions: tuple[Function, ...] = ()
    rules: tuple[Rule, ...] = ()
