"""Which relations a program uses as ordered facts although the board has templates of the same names."""

from collections.abc import Iterable, Iterator, Sequence

from rules.language.reading.forms import Form, Node, word
from rules.language.reading.vocabulary import CONDITION_WORDS
from rules.language.syntax import Position


def shadows(forms: Iterable[Form], names: set[str]) -> dict[str, Position]:
    """Return those of the names that stand with bare fields somewhere, with the first place of each.

    The thesis's rules assert `(target ?x ?y)`: they are to run beside a board that has targets of its own.
    """
    found: dict[str, Position] = {}
    for form in forms:
        for relation in _relations(form):
            fields = relation.items[1:]
            if relation.head in names and fields and not isinstance(fields[0], Form):
                found.setdefault(relation.head, relation.position)
    return found


def _relations(form: Form) -> Iterator[Form]:
    """Yield the patterns and facts of a construct."""
    if form.head == "deffacts":
        yield from (item for item in form.items[2:] if isinstance(item, Form))
    if form.head == "defrule":
        arrow = next((i for i, item in enumerate(form.items) if word(item) == "=>"), len(form.items))
        yield from _patterns(form.items[1:arrow])
        yield from _asserted(form.items[arrow:])


def _patterns(items: Sequence[Node]) -> Iterator[Form]:
    for item in items:
        if isinstance(item, Form):
            if item.head in CONDITION_WORDS:
                yield from _patterns(item.items[1:])
            else:
                yield item


def _asserted(items: Sequence[Node]) -> Iterator[Form]:
    for item in items:
        if isinstance(item, Form):
            if item.head == "assert":
                yield from (fact for fact in item.items[1:] if isinstance(fact, Form))
            elif item.head == "if":
                yield from _asserted(item.items)
