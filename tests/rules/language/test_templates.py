"""Every kind of the vocabulary as a template: names, facts of entries that rules can read, and the way back."""

from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from blackboard.entry import Entry
from blackboard.kinds import BATTERY, TARGET, Kind
from blackboard.messages.geometry import PackedArray, pack_array
from blackboard.vocabulary import Vocabulary
from rules.checks.slot_values import slots_hold
from rules.language.errors import RuleError
from rules.language.reader import read_text
from rules.language.syntax import Constant
from rules.language.templates import KindTemplate, kind_templates, name_value, planning_templates
from rules.language.values import NIL, FactValue, Symbol, Value, same, written

VOCABULARY = Vocabulary()
TEMPLATES = kind_templates(VOCABULARY)
inspect = msgspec.inspect


def values_of(type_: inspect.Type) -> st.SearchStrategy[Any]:
    """Values of a field's type, within its limits."""
    match type_:
        case inspect.Metadata(type=inner):
            return values_of(inner)
        case inspect.UnionType(types=types):
            return st.one_of(*map(values_of, types))
        case inspect.LiteralType(values=values):
            return st.sampled_from(values)
        case inspect.NoneType():
            return st.none()
        case inspect.BoolType():
            return st.booleans()
        case inspect.IntType(ge=low, le=high):
            return st.integers(0 if low is None else int(low), min(int(high or 99), 99))
        case inspect.FloatType(ge=low, le=high):
            return st.floats(
                max(-100.0, low if low is not None else -100.0), min(100.0, high if high is not None else 100.0)
            )
        case inspect.StrType(min_length=low, max_length=high):
            return st.text('aB1 -_."\\äé?;(', min_size=low or 0, max_size=min(high or 12, 12))
        case inspect.VarTupleType(item_type=item, min_length=low):
            return st.lists(values_of(item), min_size=low or 0, max_size=max(low or 0, 2)).map(tuple)
        case inspect.TupleType(item_types=items):
            return st.tuples(*map(values_of, items))
        case inspect.DictType():
            return st.just({})
        case inspect.StructType(cls=cls) if cls is PackedArray:
            return st.just(pack_array(np.zeros((0, 2))))
        case inspect.StructType(cls=cls, fields=fields):
            return st.fixed_dictionaries({field.name: values_of(field.type) for field in fields}).map(
                lambda f: cls(**f)
            )
    raise NotImplementedError(type_)


def entries(kind: Kind[Any]) -> st.SearchStrategy[Entry[Any]]:
    info = inspect.type_info(kind.type)
    return st.builds(
        lambda value, stamp_s: Entry(
            key=f"ski/k2a/{kind.path}" + ("/a.1" if kind.collection else ""),
            id="a.1" if kind.collection else None,
            revision=1,
            event="posted",
            stamp_s=stamp_s,
            source="test",
            value=value,
        ),
        values_of(info),
        st.floats(0, 1e6),
    )


def with_checked_arrays(kind: Kind[Any]) -> bool:
    return "__post_init__" in vars(kind.type)


KINDS = [kind for kind in VOCABULARY if not with_checked_arrays(kind)]


def test_names_are_those_of_the_kinds_and_unique() -> None:
    names = [template.name for template in planning_templates(VOCABULARY)]
    assert len(set(names)) == len(names)
    assert TEMPLATES[TARGET.path].template.name == "target"
    assert TEMPLATES["hypotheses/feature/model_line"].template.name == "model-line"
    assert [slot.name for slot in TEMPLATES[TARGET.path].template.slots][:5] == [
        "id",
        "key",
        "stamp-s",
        "place-x-m",
        "place-y-m",
    ]
    assert [slot.name for slot in TEMPLATES[BATTERY.path].template.slots][:2] == ["key", "stamp-s"]


def test_slots_have_names_of_their_own() -> None:
    for made in TEMPLATES.values():
        names = [slot.name for slot in made.template.slots]
        assert len(set(names)) == len(names), made.template.name


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.path)
@settings(max_examples=settings.default.max_examples // 10)  # for each of some forty kinds
@given(data=st.data())
def test_an_entry_is_a_fact_whose_slots_hold_what_they_should(kind: Kind[Any], data: st.DataObject) -> None:
    made = TEMPLATES[kind.path]
    fact = made.fact(data.draw(entries(kind)))
    assert fact.slots == tuple(slot.name for slot in made.template.slots)
    holds = slots_hold(made)
    for slot, value in zip(made.template.slots, fact.fields, strict=True):
        assert isinstance(value, tuple) is slot.multi
        for one in value if isinstance(value, tuple) else (value,):
            assert holds[slot.name].can_be(one) or one == NIL, (slot.name, one)
    assert written_and_read(fact, made) == fact


def written_and_read(fact: FactValue, made: KindTemplate) -> FactValue:
    """The fact as rules would assert it."""
    from rules.language.actions import ActionCompiler

    program = read_text(f"(deffacts d {fact})", templates=[made.template])
    return ActionCompiler(program, {}).fact(program.deffacts[0].facts[0])({}, {})


@given(entries(TARGET))
def test_a_value_comes_back_from_its_slots(entry: Entry[Any]) -> None:
    made = TEMPLATES[TARGET.path]
    fact = made.fact(entry)
    slots = {
        name: value
        for name, value in zip(fact.slots or (), fact.fields, strict=True)
        if name not in ("id", "key", "stamp-s")
    }
    assert made.value(slots) == entry.value


@pytest.mark.parametrize(
    ("slots", "told"),
    [
        ({"charge": 1.0}, "'battery' has no slot 'charge' to post; known: charge-fraction"),
        ({"charge-fraction": 1.5}, "post: 'battery': Expected float <= 1.0 - at charge_fraction"),
        ({"charge-fraction": Symbol("full")}, "post: 'battery': Expected float, got str - at charge_fraction"),
    ],
)
def test_what_cannot_be_posted_names_the_slot(slots: dict[str, Any], told: str) -> None:
    with pytest.raises(RuleError) as caught:
        TEMPLATES[BATTERY.path].value(slots)
    assert str(caught.value) == told


def test_a_number_posted_as_an_integer_is_a_float_where_the_field_is_one() -> None:
    value = BATTERY.type(charge_fraction=1)
    entry = Entry(key="ski/k2a/x", id=None, revision=1, event="posted", stamp_s=1, source="t", value=value)
    found = TEMPLATES[BATTERY.path].fact(entry).slot("charge-fraction")
    assert (type(found), found) == (float, 1.0)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("a 1", Symbol("a-1")),
        ("3", 3),
        ("0", 0),
        ("12-3", Symbol("12-3")),
        ("007", Symbol("_007")),
        ("1e5", Symbol("_1e5")),
        ("", Symbol("-")),
    ],
)
def test_names_are_words_that_rules_can_write(name: str, said: Value) -> None:
    assert same(name_value(name), said)
    (fact,) = read_text(f"(deffacts d (x {written(said)}))").deffacts[0].facts
    assert isinstance(fact.fields[0], Constant)
    assert same(fact.fields[0].value, said)
