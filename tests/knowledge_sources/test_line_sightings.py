"""Which lines were in view and not seen."""

from knowledge_sources.line_sightings import Missed

VIEWS = [("a", "b"), ("a", "b"), ("a",)]


def test_missed_in_a_row_and_forgotten_when_seen() -> None:
    missed = Missed()
    assert missed.note(VIEWS, 3, ["c"]) == [("a", 1)]
    assert missed.note(VIEWS, 3, ["b"]) == [("a", 2)]
    assert missed.note(VIEWS, 3, ["a"]) == []
    assert missed.note(VIEWS, 2, []) == [("a", 1), ("b", 1)]
    missed.forget("a")
    assert missed.note(VIEWS, 2, ["b"]) == [("a", 1)]


def test_no_view_no_miss() -> None:
    assert Missed().note([], 1, []) == []
