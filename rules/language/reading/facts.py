"""Facts as `assert` and `deffacts` write them."""

from blackboard.errors import did_you_mean
from rules.language.errors import RuleError
from rules.language.reading.expressions import read_expression
from rules.language.reading.forms import Form, Node, name_of, word
from rules.language.reading.slots import check_one_value, check_single, slots_of
from rules.language.reading.surroundings import Place, Surroundings
from rules.language.reading.vocabulary import ARITIES, CONDITION_WORDS, FACT_ACTIONS, HINTS
from rules.language.syntax import Call, Expression, FactForm, Position, Template


def relation_of(form: Form, known: Surroundings) -> str:
    """Return the relation of a fact or pattern, and note that it is used."""
    name = name_of(form.items[0] if form.items else None, "the name of the relation", form.position)
    if name in CONDITION_WORDS:
        raise RuleError(f"'{name}' has a meaning in conditions and cannot name a relation", form.position)
    known.used.add(name)
    return name


def read_fact(node: Node, place: Place, known: Surroundings) -> FactForm:
    """Return the fact that a form writes."""
    if not isinstance(node, Form):
        raise RuleError("a fact stands in brackets: (relation ...)", node.position)
    relation = relation_of(node, known)
    template = known.templates.get(relation)
    if template is None:
        for item in node.items[1:]:
            if isinstance(item, Form) and item.head and not _is_function(item.head, known):
                raise RuleError(no_template(relation, item, known), item.position)
        fields = read_values(node, place, known)
        return FactForm(relation, fields, node.position)
    return _template_fact(node, template, place, known)


def no_template(relation: str, item: Form, known: Surroundings) -> str:
    """Say that slots are written for what is no template."""
    if relation in known.shadows:
        return f"'{relation}' is used as an ordered fact at {known.shadows[relation]}, so it has no slots"
    near = did_you_mean(relation, known.templates)
    if not near.startswith("; did"):
        near = "; is its deftemplate missing?"
    return f"there is no template '{relation}' with a slot '{item.head}'{near}"


def _is_function(name: str, known: Surroundings) -> bool:
    return name in known.functions or name in ARITIES or name in HINTS or name in FACT_ACTIONS


def _template_fact(form: Form, template: Template, place: Place, known: Surroundings) -> FactForm:
    names: list[str] = []
    fields: list[Expression] = []
    for slot, item in slots_of(form.items[1:], template, known):
        values = read_values(item, place, known)
        check_single(slot, len(values), item.position)
        check_one_value(slot, values)
        values = values or (empty(item.position),)
        names += [slot.name] * len(values)
        fields += values
    return FactForm(template.name, tuple(fields), form.position, tuple(names))


def read_values(form: Form, place: Place, known: Surroundings) -> tuple[Expression, ...]:
    """Return what is written behind the name of a relation or slot; `=(...)` is the same as `(...)`, as in CLIPS."""
    values: list[Expression] = []
    rest = form.items[1:]
    while rest:
        node = rest.pop(0)
        if word(node) == "=":
            if not rest or not isinstance(rest[0], Form):
                raise RuleError("'=' must be followed by an expression in brackets: =(...)", node.position)
            node = rest.pop(0)
        values.append(read_expression(node, place, known))
    return tuple(values)


def empty(position: Position) -> Expression:
    """Return the expression of an empty multifield."""
    return Call("create$", (), position)
