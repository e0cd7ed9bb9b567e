"""Rates, ages and sizes of what comes; which keys share a row."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from blackboard.errors import BoardError, MissionError
from blackboard.vocabulary import Vocabulary
from blackboard.watching.patterns import expression_of
from blackboard.watching.table import Row, TableParams, Traffic
from blackboard.watching.table_view import age_words, rate_words, sorted_rows, table_of

SCAN = "ski/k2a/observations/signal/sonar_scan"
TARGET = "ski/k2a/hypotheses/symbol/target"


def payload(key: str, stamp_s: float, source: str = "robot", event: str = "revised") -> bytes:
    entry = {"key": key, "revision": 1, "event": event, "stamp_s": stamp_s, "source": source, "value": {}}
    return json.dumps(entry).encode()


def traffic(**params: float) -> Traffic:
    return Traffic(Vocabulary(), TableParams(**params), began_s=100.0)  # type: ignore[arg-type]


def test_a_stream_of_ten_a_second() -> None:
    seen = traffic(window_s=2.0)
    for i in range(50):  # every 0.1 s from 100.1 to 105.0; stamps from 0.0 to 4.9
        seen.came(SCAN, payload(SCAN, 0.1 * i), b"wheels boot signal 1", 100.1 + 0.1 * i)
    (row,) = seen.rows(105.05)
    assert row.rate_hz == pytest.approx(10.0)
    assert row.age_s == pytest.approx(0.05)
    assert (row.key, row.type, row.source, row.host, row.members) == (SCAN, "SonarScan", "robot", "wheels", 1)
    assert row.size_bytes == len(payload(SCAN, 4.9))
    assert seen.rate_hz(105.05) == row.rate_hz
    assert seen.entries == 50
    (row,) = seen.rows(110.0)  # it has stopped five seconds ago
    assert (row.rate_hz, row.age_s) == (0.0, pytest.approx(5.0))


def test_a_stream_faster_than_what_is_remembered() -> None:
    seen = traffic(window_s=2.0, arrivals=10)
    for i in range(1000):
        seen.came(SCAN, payload(SCAN, 0.0), b"", 100.0 + 0.001 * (i + 1))
    assert seen.rows(101.001)[0].rate_hz == pytest.approx(1000.0)


def test_what_stood_before_has_an_age_and_no_rate_and_never_hides_what_came() -> None:
    seen = traffic()
    seen.came(SCAN, payload(SCAN, 60.0), b"", 101.0)
    seen.stood(SCAN, payload(SCAN, 59.0), b"", 101.5)
    seen.stood(f"{TARGET}/a", payload(TARGET, 20.0, "frontiers"), b"", 101.5)
    target, scan = seen.rows(102.0)
    assert (target.rate_hz, target.age_s, target.source) == (0.0, pytest.approx(41.0), "frontiers")
    assert (scan.rate_hz, scan.age_s) == (pytest.approx(0.5), pytest.approx(1.0))


def test_large_collections_share_a_row_until_they_are_small_again() -> None:
    seen = traffic()
    for i, source in enumerate(["a", "a", "b"]):
        seen.came(f"{TARGET}/{i}", payload(TARGET, float(i), source), b"h b knowledge 1", 101.0)
    (row,) = seen.rows(102.0, fold_from=3)
    assert (row.key, row.members, row.source, row.host) == (f"{TARGET}/*", 3, "2 of them", "h")
    assert row.rate_hz == pytest.approx(1.5)
    assert row.age_s == pytest.approx(1.0)
    assert len(seen.rows(102.0)) == len(seen.rows(102.0, fold_from=4)) == 3
    seen.came(f"{TARGET}/1", payload(TARGET, 2.0, "a", "retracted"), b"", 102.0)
    assert [row.key for row in seen.rows(102.0, fold_from=3)] == [f"{TARGET}/0", f"{TARGET}/2"]


def test_what_is_no_entry_is_shown_too() -> None:
    seen = traffic()
    seen.came("ski/k2a/@keeper/beat", b'{"boot": "x"}', b"", 101.0)
    seen.came("a\nb", b"\xff", b"\xff", 101.0)
    assert [(row.key, row.type, row.age_s) for row in seen.rows(102.0)] == [
        ("a\\nb", "", None),
        ("ski/k2a/@keeper/beat", "", None),
    ]
    assert seen.clock_s(102.0) is None


@given(st.lists(st.tuples(st.sampled_from("abc"), st.floats(0, 1000), st.floats(0, 1000)), max_size=30))
def test_ages_and_rates_are_never_negative(arrivals: list[tuple[str, float, float]]) -> None:
    seen = Traffic(Vocabulary(), began_s=0.0)
    for name, stamp_s, at_s in sorted(arrivals, key=lambda one: one[2]):
        seen.came(f"{TARGET}/{name}", payload(TARGET, stamp_s), b"", at_s)
    for row in seen.rows(1000.0):
        assert row.rate_hz >= 0
        assert row.age_s is not None
        assert row.age_s >= 0


def test_parameters_are_checked() -> None:
    with pytest.raises(MissionError, match="window_s = 0"):
        TableParams(window_s=0)


def row(key: str, rate_hz: float, age_s: float | None, size_bytes: int, members: int = 1) -> Row:
    return Row(
        key=key, type="T", source="s", host="h", rate_hz=rate_hz, age_s=age_s, size_bytes=size_bytes, members=members
    )


def test_orders() -> None:
    rows = [row("a", 1, None, 10), row("b", 5, 3, 30), row("c", 1, 1, 20)]
    orders = {by: "".join(r.key for r in sorted_rows(rows, by)) for by in ("key", "rate", "age", "size")}
    assert orders == {"key": "abc", "rate": "bac", "age": "cba", "size": "bca"}


def test_numbers_for_people() -> None:
    assert [age_words(s) for s in (None, 0.04, 9.9, 42, 150, 10_000)] == ["-", "0.0 s", "9.9 s", "42 s", "2 min", "3 h"]
    assert [rate_words(hz) for hz in (0, 0.02, 0.2, 10, 1234.5)] == ["", "0.02", "0.2", "10.0", "1234.5"]


def text_of(rows: list[Row], height: int | None, width: int = 100) -> list[str]:
    console = Console(width=width, force_terminal=False, no_color=True)
    with console.capture() as capture:
        console.print(table_of(rows, "title", width, height))
    return [line.rstrip() for line in capture.get().splitlines()]


def test_the_table_keeps_to_its_height_and_counts_the_rest() -> None:
    rows = [row(f"ski/k2a/[bold]{i}", 1.0, 0.5, 1500, members=i + 1) for i in range(20)]
    lines = text_of(rows, 10)
    assert len(lines) == 10
    assert lines[0] == "title"
    assert lines[1].split() == ["key", "kind", "source", "host", "rate", "/s", "age", "size"]
    assert lines[2].split() == ["k2a/[bold]0", "T", "s", "h", "1.0", "0.5", "s", "1.5", "kB"]
    assert lines[3].startswith("k2a/[bold]1 (2) ")
    assert lines[-1].startswith("... 13 more")
    assert len(text_of(rows, None)) == 22


@pytest.mark.parametrize("width", [20, 40, 60, 80, 100, 160])
def test_no_line_is_wider_than_the_terminal_and_keys_come_first(width: int) -> None:
    long = Row(
        key="ski/k2a/hypotheses/symbol/target/frontier-12", type="MissionStatus", source="frontier_targets",
        host="knowledge_sources", rate_hz=1.0, age_s=3.0, size_bytes=12_345,
    )  # fmt: skip
    lines = text_of([long], None, width)
    assert max(map(len, lines)) <= width
    assert len(lines) == 3
    whole = "k2a/hypotheses/symbol/target/frontier-12"
    assert (whole in lines[2]) == (width >= 100)
    assert ("host" in lines[1], "kind" in lines[1], "source" in lines[1]) == {
        20: (False, False, False), 40: (False, False, False), 60: (False, False, False), 80: (False, False, True),
        100: (False, True, True), 160: (True, True, True),
    }[width]  # fmt: skip


def test_patterns() -> None:
    assert expression_of("**") == "ski/**"
    assert expression_of("commands/*") == "ski/*/commands/*"
    assert expression_of("commands/drive") == "ski/*/commands/drive/**"
    assert expression_of("ski/k2a/commands") == "ski/k2a/commands/**"
    assert expression_of("ski/k2a/@hosts/**") == "ski/k2a/@hosts/**"
    for pattern in ("", "a//b", "a/**/**", "a b#"):
        with pytest.raises(BoardError):
            expression_of(pattern)
