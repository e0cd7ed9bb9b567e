"""Templates that follow from the board's vocabulary: an entry of each kind as a fact, and the slots of a fact as a value.

A template bears its kind's name with `-` for `_`; the name of its panel goes before it where two kinds share one. Its slots
are `id` (of a collection), `key`, `stamp-s`, then the fields of the value: those of a record inside it follow its name
(`place-x-m`), a row of plain values is a multislot, arrays and rows of records are left out. Words from a fixed choice, names
and ids are symbols (a space in them becomes `-`; one that is all digits is an integer), free text is a string, nothing is `nil`.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import msgspec

from blackboard.entry import Entry
from blackboard.errors import did_you_mean
from blackboard.kinds import Kind
from blackboard.messages.geometry import PackedArray
from rules.language.errors import RuleError
from rules.language.syntax import Slot, Template
from rules.language.values import FALSE, NIL, TRUE, FactValue, Symbol, Value, as_symbol, written

CLOCK = Template("clock", (Slot("time-s"),), "the mission's clock, told about once a second to rules that ask for it")
LONGEST_NAME = 200  # a string that may be no longer than this is a name
_COUNT = re.compile(r"0|[1-9]\d{0,17}")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")  # as CLIPS reads one
_UNFIT = re.compile(r"[\s()\"';&|~<$?]+")  # what CLIPS does not take in a symbol


@dataclass(frozen=True, slots=True)
class SlotField:
    """A slot of a template and where it is found in the value."""

    slot: Slot
    path: tuple[str, ...]
    said: Callable[[Any], Value]
    choices: tuple[str, ...] = ()  # of a word from a fixed choice


@dataclass(frozen=True, slots=True)
class KindTemplate:
    """The template of one kind."""

    kind: Kind[Any]
    template: Template
    fields: tuple[SlotField, ...]

    def fact(self, entry: Entry[Any]) -> FactValue:
        """Return an entry as a fact."""
        values: list[Value] = [name_value(entry.id)] if self.kind.collection and entry.id is not None else []
        values += (entry.key, float(entry.stamp_s))
        for field in self.fields:
            found = entry.value
            for name in field.path:
                found = getattr(found, name, None)
            values.append(_nothing(field) if found is None else field.said(found))
        return FactValue(self.template.name, tuple(values), tuple(slot.name for slot in self.template.slots))

    def value(self, slots: Mapping[str, Value]) -> Any:
        """Return the message that these slots say. Raises RuleError for an unknown slot or an unfit value."""
        try:
            return self.revised({}, slots)
        except msgspec.ValidationError as error:
            raise RuleError(f"post: '{self.template.name}': {plainly(error)}") from None

    def revised(self, plain: dict[str, Any], slots: Mapping[str, Value]) -> Any:
        """Return the message of a value as plain data with these slots over it.

        Raises RuleError for an unknown slot, msgspec.ValidationError where the message would be unfit.
        """
        by_slot = {field.slot.name: field for field in self.fields}
        for name, given in slots.items():
            field = by_slot.get(name)
            if field is None:
                raise RuleError(f"'{self.template.name}' has no slot '{name}' to post{did_you_mean(name, by_slot)}")
            place = plain
            for step in field.path[:-1]:
                if place.get(step) is None:  # a record that was not given, or is nothing
                    place[step] = {}
                place = place[step]
            place[field.path[-1]] = plain_value(field, given)
        return msgspec.convert(plain, self.kind.type)


def plainly(error: msgspec.ValidationError) -> str:
    """Return what msgspec says of an unfit value without its marks."""
    return str(error).replace("`", "").replace("$.", "")


def symbol(word: str) -> Symbol:
    """Return a word as a symbol, `-` for what a symbol cannot hold, and `_` before what would read as a number."""
    fit = _UNFIT.sub("-", word) or "-"
    return Symbol(f"_{fit}" if _NUMBER.fullmatch(fit) else fit)


def name_value(name: str) -> Value:
    """Return a name or an id as rules write it: a symbol, or an integer where it is the number of something."""
    return int(name) if _COUNT.fullmatch(name) else symbol(name)


def kind_templates(kinds: Iterable[Kind[Any]]) -> dict[str, KindTemplate]:
    """Return the template of each kind, by the kind's path."""
    listed = sorted(kinds, key=lambda kind: kind.path)
    names = [kind.name for kind in listed]
    made = {}
    for kind in listed:
        name = kind.name if names.count(kind.name) == 1 else f"{kind.panel}-{kind.name}"
        made[kind.path] = _template(kind, name.replace("_", "-"))
    return made


def planning_templates(kinds: Iterable[Kind[Any]]) -> tuple[Template, ...]:
    """Return all templates that rule files may use without defining them."""
    return (*(made.template for made in kind_templates(kinds).values()), CLOCK)


def kind_template(name: str, templates: Mapping[str, KindTemplate]) -> KindTemplate:
    """Return the template of this name; raise RuleError with the nearest name where no kind has it."""
    by_name = {made.template.name: made for made in templates.values()}
    if name not in by_name:
        raise RuleError(f"there is no template '{name}' of an entry{did_you_mean(name, by_name)}")
    return by_name[name]


@cache  # it follows from the kind alone, and a start or a reload asks several times
def _template(kind: Kind[Any], name: str) -> KindTemplate:
    fields = tuple(_fields(kind.type, ()))
    head = [Slot("id")] if kind.collection else []
    slots = (*head, Slot("key"), Slot("stamp-s"), *(field.slot for field in fields))
    return KindTemplate(kind, Template(name, slots, f"{kind.path}: {kind.doc}"), fields)


def _fields(type_: type[msgspec.Struct], path: tuple[str, ...]) -> Iterable[SlotField]:
    info = msgspec.inspect.type_info(type_)
    if not isinstance(info, msgspec.inspect.StructType):
        return
    for field in info.fields:
        here = (*path, field.name)
        options = [t for t in _options(field.type) if not isinstance(t, msgspec.inspect.NoneType)]
        records = [t for t in options if isinstance(t, msgspec.inspect.StructType)]
        if len(records) == 1 and len(options) == 1:
            if not issubclass(records[0].cls, PackedArray):
                yield from _fields(records[0].cls, here)
            continue
        slot_name = "-".join(here).replace("_", "-")
        if len(options) == 1 and isinstance(options[0], msgspec.inspect.VarTupleType | msgspec.inspect.TupleType):
            items = _items(options[0])
            said = _said(items)
            if said is not None:
                yield SlotField(Slot(slot_name, multi=True), here, _row(said))
            continue
        said = _said(options)
        if said is not None:
            yield SlotField(Slot(slot_name), here, said, _choices(options))


def _options(type_: msgspec.inspect.Type) -> list[msgspec.inspect.Type]:
    if isinstance(type_, msgspec.inspect.UnionType):
        return [option for inner in type_.types for option in _options(inner)]
    if isinstance(type_, msgspec.inspect.Metadata):
        return _options(type_.type)
    return [type_]


def _items(type_: msgspec.inspect.VarTupleType | msgspec.inspect.TupleType) -> list[msgspec.inspect.Type]:
    inner = [type_.item_type] if isinstance(type_, msgspec.inspect.VarTupleType) else list(type_.item_types)
    return [option for item in inner for option in _options(item)]


def _said(options: Iterable[msgspec.inspect.Type]) -> Callable[[Any], Value] | None:
    """Return how a value of one of these types is said; None where it is no plain value."""
    words = False
    options = list(options)
    for option in options:
        if isinstance(option, msgspec.inspect.LiteralType):
            words = True
        elif isinstance(option, msgspec.inspect.StrType):
            words = words or (option.max_length is not None and option.max_length <= LONGEST_NAME)
        elif not isinstance(
            option,
            msgspec.inspect.IntType | msgspec.inspect.FloatType | msgspec.inspect.BoolType | msgspec.inspect.NoneType,
        ):
            return None
    said = _say_word if words else _say
    of_kinds = {type(option) for option in options}
    is_float = msgspec.inspect.FloatType in of_kinds and msgspec.inspect.IntType not in of_kinds
    return _float_or(said) if is_float else said


def _float_or(said: Callable[[Any], Value]) -> Callable[[Any], Value]:
    """What is a float by its type is said as one, though a component posted 1 for 1.0; and there is one zero only."""
    return lambda value: float(value) + 0.0 if type(value) in (int, float) else said(value)


def _say_word(value: Any) -> Value:
    return name_value(value) if isinstance(value, str) else _say(value)


def _say(value: Any) -> Value:
    if value is None:
        return NIL
    if isinstance(value, bool):
        return as_symbol(value)
    if isinstance(value, str | int | float):
        return value
    raise TypeError(f"{value!r} is no plain value")


def _row(said: Callable[[Any], Value]) -> Callable[[Any], Value]:
    return lambda row: tuple(said(item) for item in row)


def _choices(options: Iterable[msgspec.inspect.Type]) -> tuple[str, ...]:
    return tuple(str(v) for o in options if isinstance(o, msgspec.inspect.LiteralType) for v in o.values)


def _nothing(field: SlotField) -> Value:
    return () if field.slot.multi else NIL


def plain_value(field: SlotField, value: Value) -> Any:
    """Return a slot's value as JSON has it. Raises RuleError for what no entry can hold."""
    if isinstance(value, tuple):
        return [plain_value(field, item) for item in value]
    if value == NIL:
        return None
    if value in (TRUE, FALSE):
        return value == TRUE
    if isinstance(value, Symbol):
        return next((choice for choice in field.choices if symbol(choice) == value), value.name)
    if isinstance(value, int) and field.said is _say_word:
        return str(value)
    if isinstance(value, str | int | float):
        return value
    raise RuleError(f"slot '{field.slot.name}': {written(value)} cannot be posted")
