"""The facts that stand in an environment of CLIPS, read without clipspy's fact objects.

Those objects retain their fact, and CLIPS 6.42 never gives back what was retained. So facts are asserted and retracted as text, by
their indices, and read where they stand.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import clips
from clips._clips import ffi, lib
from clips.facts import slot_value

from rules.engines.clips_values import from_clips
from rules.language.values import FactValue


class ClipsFacts:
    """Asserts, retracts and reads facts."""

    def __init__(self, environment: Any, slots: Mapping[str, tuple[str, ...]]) -> None:
        self.environment = environment
        self.slots = slots

    def assert_written(self, text: str) -> int | None:
        """Assert a fact and return its index, also where the same stands already; None where CLIPS refuses it."""
        try:
            index = self.environment.eval(f"(fact-index (assert {text}))")
        except clips.CLIPSError:
            return None
        self.environment.clear_error_state()  # of a test that could not be evaluated, which does not match: no more than that
        return index if isinstance(index, int) and index > 0 else None

    def retract(self, index: int) -> None:
        self.environment.eval(f"(retract {index})")

    def standing(self) -> Iterator[tuple[int, Any]]:
        """Yield the index of each fact and where it is, which is true until something changes."""
        fact = lib.GetNextFact(self.environment._env, ffi.NULL)
        while fact != ffi.NULL:
            yield lib.FactIndex(fact), fact
            fact = lib.GetNextFact(self.environment._env, fact)

    def value(self, fact: Any) -> FactValue:
        """Return the fact that is there."""
        template = lib.FactDeftemplate(fact)
        relation = ffi.string(lib.DeftemplateName(template)).decode()
        names = self.slots.get(relation)
        if names is None:
            return FactValue(relation, tuple(map(from_clips, slot_value(self.environment._env, fact))))
        values = (slot_value(self.environment._env, fact, slot=name) for name in names)
        return FactValue(relation, tuple(map(from_clips, values)), names)
