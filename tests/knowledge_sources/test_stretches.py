"""Stretches: from the first to the last revision of every key, in the order in which the keys came."""

from blackboard.entry import Entry, Support
from blackboard.messages.geometry import IDENTITY, Pose
from knowledge_sources.stretches import Stretches


def entry(key: str, revision: int) -> Entry[Pose]:
    return Entry(key=key, id=None, revision=revision, event="revised", stamp_s=0.0, source="s", value=IDENTITY)


def test_stretches_widen() -> None:
    stretches = Stretches()
    assert stretches.supports() == []
    stretches.add((entry("b", 3), entry("a", 5)))
    stretches.add((entry("b", 7), entry("a", 5), entry("b", 4)))
    stretches.add((entry("b", 2),))
    assert stretches.supports() == [Support("b", 2, 7), Support("a", 5, 5)]


def test_stretches_join_others_and_forget() -> None:
    stretches, others = Stretches(), Stretches()
    stretches.add((entry("b", 3),))
    others.add((entry("b", 9), entry("c", 1)))
    stretches.merge(others.supports())
    assert stretches.supports() == [Support("b", 3, 9), Support("c", 1, 1)]
    assert others.supports() == [Support("b", 9, 9), Support("c", 1, 1)]
    stretches.clear()
    assert stretches.supports() == []
