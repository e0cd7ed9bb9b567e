"""The facts that stand in an environment of CLIPS, read without clipspy's fact objects.

Those objects retain their fact, and CLIPS 6.42 never gives back what was retained. So facts are asserted and retracted as text, by
their indices, and read where they stand in CLIPS's list, which is in the order of the indices. What an action may have changed is
looked for around the facts it can name and at the end of the list, not in all of it.
"""

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import clips
from clips._clips import ffi, lib
from clips.facts import slot_value

from rules.engines.clips_values import from_clips
from rules.engines.engine import FactChange
from rules.language.values import FactValue


class ClipsFacts:
    """Asserts, retracts and reads facts; `values` are those that stand, by index, as of the last look."""

    def __init__(self, environment: Any, slots: Mapping[str, tuple[str, ...]]) -> None:
        self.environment = environment
        self.slots = slots
        self.values: dict[int, FactValue] = {}
        self._order: list[int] = []  # the indices of `values`
        self._where: dict[int, Any] = {}  # where each stands

    def read_all(self) -> None:
        """Read all facts anew."""
        self.values, self._order, self._where = {}, [], {}
        for index, fact in self._after(None):
            self._add(index, fact)

    def assert_fact(self, text: str) -> tuple[int | None, bool]:
        """Assert a fact; return its index, None where CLIPS refuses it, and whether it is new."""
        try:
            index = self.environment.eval(f"(fact-index (assert {text}))")
        except clips.CLIPSError:
            index = None
        self.environment.clear_error_state()  # of a test that could not be evaluated, which does not match: no more than that
        if not isinstance(index, int) or index <= 0:
            return None, False
        if index in self.values:
            return index, False
        for found, fact in self._after(self._order[-1] if self._order else None):
            self._add(found, fact)
        return index, True

    def retract(self, index: int) -> None:
        """Retract a fact; KeyError where there is none of this index."""
        self._remove(index)
        self.environment.eval(f"(retract {index})")

    def look(self, named: Iterable[int]) -> tuple[FactChange, ...]:
        """Return what actions have changed that can name these facts, and bring `values` up to date."""
        perhaps = sorted(index for index in set(named) if index in self.values)
        gone, come = [], []
        for index in perhaps:
            old = self.values[index]
            fact = self._found(index)
            value = None if fact is None else self._value(fact)
            if value is None:
                gone.append(FactChange(index, old, False))
                self._remove(index)
                continue
            self._where[index] = fact
            if value.key != old.key:
                gone.append(FactChange(index, old, False))
                come.append(FactChange(index, value, True))
                self.values[index] = value
        for index, fact in self._after(self._order[-1] if self._order else None):
            self._add(index, fact)
            come.append(FactChange(index, self.values[index], True))
        return (*gone, *come)

    def _found(self, index: int) -> Any:
        """Return where a fact stands now, None if it does not; those before it are known to stand."""
        before = bisect_left(self._order, index) - 1
        found, fact = next(self._after(self._order[before] if before >= 0 else None), (None, None))
        return fact if found == index else None

    def _after(self, index: int | None) -> Iterator[tuple[int, Any]]:
        """Yield the facts that stand after that of an index, or all."""
        environment = self.environment._env
        fact = lib.GetNextFact(environment, ffi.NULL if index is None else self._where[index])
        while fact != ffi.NULL:
            yield lib.FactIndex(fact), fact
            fact = lib.GetNextFact(environment, fact)

    def _add(self, index: int, fact: Any) -> None:
        self.values[index] = self._value(fact)
        self._order.append(index)
        self._where[index] = fact

    def _remove(self, index: int) -> None:
        del self.values[index]
        del self._order[bisect_left(self._order, index)]
        del self._where[index]

    def _value(self, fact: Any) -> FactValue:
        relation = ffi.string(lib.DeftemplateName(lib.FactDeftemplate(fact))).decode()
        names = self.slots.get(relation)
        if names is None:
            return FactValue(relation, tuple(map(from_clips, slot_value(self.environment._env, fact))))
        values = (slot_value(self.environment._env, fact, slot=name) for name in names)
        return FactValue(relation, tuple(map(from_clips, values)), names)
