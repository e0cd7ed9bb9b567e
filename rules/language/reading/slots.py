"""The slots of a template as patterns, facts and modify name them."""

from collections.abc import Sequence

from blackboard.errors import did_you_mean
from rules.language.argument_kinds import ROW, kinds_of
from rules.language.errors import RuleError
from rules.language.reading.forms import Form, Node, word
from rules.language.reading.surroundings import Surroundings
from rules.language.syntax import Expression, Position, Slot, Template, VariableUse


def slots_of(items: Sequence[Node], template: Template, known: Surroundings) -> list[tuple[Slot, Form]]:
    """Return the slots that the items name, each once; what is wrong with one does not keep the others from being read."""
    found: dict[str, tuple[Slot, Form]] = {}
    for item in items:
        with known.collecting():
            slot = _slot(item, template)
            if slot.name in found:
                raise RuleError(f"the slot '{slot.name}' stands there twice", item.position)
            if isinstance(item, Form):
                found[slot.name] = (slot, item)
    return list(found.values())


def _slot(item: Node, template: Template) -> Slot:
    if not isinstance(item, Form) or not item.items or not word(item.items[0]):
        raise RuleError(f"'{template.name}' is a template: write ({template.name} (slot ...) ...)", item.position)
    return slot_named(item.head, template, item.position)


def slot_named(name: str, template: Template, position: Position) -> Slot:
    """Return a slot of a template; RuleError with the nearest name where there is none."""
    for slot in template.slots:
        if slot.name == name:
            return slot
    near = did_you_mean(name, [slot.name for slot in template.slots])
    raise RuleError(f"the template '{template.name}' has no slot '{name}'{near}", position)


def check_one_value(slot: Slot, values: Sequence[Expression]) -> None:
    """Refuse what surely is a multifield for a slot that holds one value."""
    for value in values if not slot.multi else ():
        if (isinstance(value, VariableUse) and value.multi) or kinds_of(value) == ROW:
            raise RuleError(f"the slot '{slot.name}' holds one value, not a multifield", value.position)


def check_single(slot: Slot, number: int, position: Position) -> None:
    """Refuse none or several values for a slot that holds one."""
    if not slot.multi and number != 1:
        raise RuleError(f"the slot '{slot.name}' holds one value, not {number}", position)
