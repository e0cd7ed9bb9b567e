"""Constants in patterns on the board's entries that their slots never hold: another word, a string for a symbol, 1 for 1.0."""

from collections.abc import Iterator
from dataclasses import dataclass

import msgspec

from blackboard.errors import did_you_mean
from rules.checks.finding import Finding
from rules.checks.names import Board
from rules.language.library.function import kind
from rules.language.syntax import Constant, Program
from rules.language.templates import LONGEST_NAME, KindTemplate, symbol
from rules.language.values import FALSE, NIL, TRUE, Symbol, Value, written
from rules.language.walk import patterns_in


@dataclass(frozen=True, slots=True)
class Holds:
    """What a slot can hold: kinds of values, and the symbols where they are a fixed choice."""

    kinds: frozenset[type]
    words: tuple[Symbol, ...] = ()

    def __str__(self) -> str:
        named = {int: "integer", float: "number", str: "text"}
        words = [word.name for word in self.words] or (["a word"] if Symbol in self.kinds else [])
        if not self.words and {Symbol, int} <= self.kinds:
            return "a word, or an integer where it is all digits"
        return " or ".join([text for one, text in named.items() if one in self.kinds] + words)

    def can_be(self, value: Value) -> bool:
        """Say whether the slot may ever hold this value."""
        if type(value) not in self.kinds:
            return False
        return not isinstance(value, Symbol) or not self.words or value in self.words


def slot_value_findings(program: Program, board: Board) -> Iterator[Finding]:
    """Yield the constants of patterns that can never match."""
    mentioned = {pattern.relation for rule in program.rules for pattern in patterns_in(rule.conditions)}
    holds = {name: slots_hold(made) for name, made in board.templates.items() if name in mentioned}
    for rule in program.rules:
        for pattern in patterns_in(rule.conditions):
            if pattern.relation not in holds or pattern.slots is None:
                continue
            for slot, constraint in zip(pattern.slots, pattern.constraints, strict=True):
                for atom in (atom for atoms in constraint.alternatives for atom in atoms):
                    if isinstance(atom.term, Constant) and slot in holds[pattern.relation]:
                        wrong = _unfit(atom.term.value, holds[pattern.relation][slot])
                        if wrong is not None:
                            text = f"the slot '{slot}' of '{pattern.relation}' {wrong}"
                            yield Finding(text, atom.term.position)


def _unfit(value: Value, holds: Holds) -> str | None:
    if holds.can_be(value):
        return None
    if isinstance(value, Symbol) and holds.words:
        return f"is never {value}{did_you_mean(value.name, [word.name for word in holds.words])}"
    instead = ""
    if isinstance(value, int) and float in holds.kinds:
        instead = f"; write {float(value)}"
    elif isinstance(value, str) and Symbol in holds.kinds:
        instead = f"; write {value} without quotation marks"
    elif isinstance(value, Symbol) and str in holds.kinds:
        instead = f'; write "{value}"'
    return f"never holds {kind(value)} such as {written(value)}{instead}"


def slots_hold(template: KindTemplate) -> dict[str, Holds]:
    """Return what each slot of an entry's template can hold."""
    found = {
        "id": Holds(frozenset({Symbol, int})),
        "key": Holds(frozenset({str})),
        "stamp-s": Holds(frozenset({float})),
    }
    for field in template.fields:
        options = list(_options(_at(template.kind.type, field.path)))
        found[field.slot.name] = _holds(options)
    return found


def _at(type_: type[msgspec.Struct], path: tuple[str, ...]) -> msgspec.inspect.Type:
    info = msgspec.inspect.type_info(type_)
    for name in path:
        records = [one for one in _options(info) if isinstance(one, msgspec.inspect.StructType)]
        info = next(field.type for field in records[0].fields if field.name == name)
    return info


def _options(type_: msgspec.inspect.Type) -> Iterator[msgspec.inspect.Type]:
    if isinstance(type_, msgspec.inspect.UnionType):
        for inner in type_.types:
            yield from _options(inner)
    elif isinstance(type_, msgspec.inspect.Metadata):
        yield from _options(type_.type)
    elif isinstance(type_, msgspec.inspect.VarTupleType):
        yield from _options(type_.item_type)
    elif isinstance(type_, msgspec.inspect.TupleType):
        for inner in type_.item_types:
            yield from _options(inner)
    else:
        yield type_


def _holds(options: list[msgspec.inspect.Type]) -> Holds:
    kinds: set[type] = set()
    words: list[Symbol] = []
    free = False
    worded = any(isinstance(option, msgspec.inspect.LiteralType) or _is_name(option) for option in options)
    for option in options:
        if isinstance(option, msgspec.inspect.LiteralType):
            kinds.add(Symbol)
            words += [symbol(str(value)) for value in option.values]
        elif isinstance(option, msgspec.inspect.StrType):
            kinds |= {Symbol, int} if worded else {str}  # a name that is all digits is an integer
            free = True
        elif isinstance(option, msgspec.inspect.BoolType):
            kinds.add(Symbol)
            words += [TRUE, FALSE]
        elif isinstance(option, msgspec.inspect.NoneType):
            kinds.add(Symbol)
            words.append(NIL)
        elif isinstance(option, msgspec.inspect.IntType | msgspec.inspect.FloatType):
            kinds.add(int if isinstance(option, msgspec.inspect.IntType) else float)
    return Holds(frozenset(kinds), () if free and worded else tuple(words))


def _is_name(option: msgspec.inspect.Type) -> bool:
    return (
        isinstance(option, msgspec.inspect.StrType)
        and option.max_length is not None
        and option.max_length <= LONGEST_NAME
    )
