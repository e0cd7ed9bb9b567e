"""Whatever comes, one short printable line; and what comes from our boards, with what matters in it."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.board import Board
from blackboard.journal import JournalWriter
from blackboard.kinds import GRID, SONAR_SCAN
from blackboard.messages.geometry import pack_array
from blackboard.messages.sensing import SonarScan
from blackboard.messages.world import GridTile
from blackboard.vocabulary import Vocabulary
from blackboard.watching.summary import (
    SHOWN_CHARACTERS,
    printable,
    read_entry,
    size_words,
    summarise,
    summarise_value,
)

LONGEST = SHOWN_CHARACTERS * 12 + 1000  # every letter written out, and a source of 200 letters before


def test_a_scan_a_grid_tile_and_a_retraction(tmp_path: Path) -> None:
    board = Board(Vocabulary(), robot="k2a")
    with JournalWriter(tmp_path / "board.jsonl") as journal:
        board.journal = journal
        echoes = SonarScan(sensors=(0, 1, 2, 3, 4), ranges_m=(0.5, None, 2.25, 1.0, None))
        scan = board.post(SONAR_SCAN, echoes, source="robot", stamp_s=1)
        cells = np.full((64, 64), 128, dtype=np.uint8)
        cells[:16], cells[16:24] = 0, 255  # a quarter and an eighth
        tile = GridTile(column=0, row=-1, cell_m=0.05, cells=pack_array(cells))
        board.now_s = 2.0
        posted = board.post(GRID, tile, id="0_-1", source="eou_grid", supports=(scan.as_support(),))
        board.endorse(posted.key, who="me", verdict="against", why="no")
        board.retract(GRID, "0_-1", source="eou_grid")
    words = "column 0, row -1, cell_m 0.05, cells uint8[64 64] 25 % empty, 12 % occupied"
    assert [summarise(line) for line in (tmp_path / "board.jsonl").read_bytes().splitlines()] == [
        "r1 at 1.00 s by robot: sensors 5 numbers 0 to 4, ranges_m 5 numbers 0.5 to 2.25 (2 missing)",
        f"r1 at 2.00 s by eou_grid: {words} <- 1",
        f"r2 at 2.00 s by eou_grid: {words} [0 for, 1 against] <- 1",
        f"r3 retracted at 2.00 s by eou_grid: {words} [0 for, 1 against] <- 1",
    ]


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ({"a": 1, "b": [1.5, None], "c": {"d": True, "e": ""}}, 'a 1, b [1.5 -], c (d yes, e "")'),
        ([1, 2, 3], "[1 2 3]"),
        ({}, "{}"),
        (-0.0, "0"),
        ([], "[]"),
        ([None] * 5, "5 numbers (5 missing)"),
        (["a"] * 5, "5 items"),
        ([True] * 5, "5 items"),
        ([[[[[1]]]]], "[[[1 items]]]"),
        ("x" * 100, "x" * 60 + "... (100 letters)"),
        ({"cells": {"zlib_base64": "AA==", "dtype": "uint8", "shape": [1]}}, "cells an array that does not unpack"),
        ({"cells": {"zlib_base64": "", "dtype": "float99", "shape": [1]}}, "cells an array that does not unpack"),
        ({"line": "a\nb\x1b[2J\u202e"}, "line a\\nb\\x1b[2J\\u202e"),
    ],
)
def test_values_in_words(value: object, words: str) -> None:
    assert summarise_value(json.dumps(value).encode()) == words


def test_long_values_are_cut() -> None:
    words = summarise_value(json.dumps({f"field_{i}": i for i in range(1000)}).encode())
    assert len(words) == SHOWN_CHARACTERS
    assert words.endswith("...")


def test_what_is_no_json() -> None:
    assert summarise(b"") == "0 bytes that are no JSON"
    assert summarise(b"\xff\xfe") == "2 bytes that are no JSON"
    assert summarise(b"[" * 100_000) == "100000 bytes that are no JSON"
    assert summarise(b"1e999") == "5 bytes that are no JSON"
    assert read_entry(b"{}") is None


def test_sizes() -> None:
    sizes = [0, 999, 1000, 99_900, 1e6, 123e6, 5e9]
    assert [size_words(size) for size in sizes] == ["0 B", "999 B", "1.0 kB", "99.9 kB", "1.0 MB", "123 MB", "5000 MB"]


@given(st.binary(max_size=300))
def test_any_bytes_make_one_printable_line(payload: bytes) -> None:
    line = summarise(payload)
    assert line.isprintable()
    assert 0 < len(line) <= LONGEST


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=30,
)


@given(json_values, st.text(max_size=200))
def test_any_json_and_any_entry_make_one_printable_line(value: object, source: str) -> None:
    entry = {"key": "ski/r/x", "revision": 1, "event": "posted", "stamp_s": 0.0, "source": source, "value": value}
    for payload in (json.dumps(value).encode(), json.dumps(entry).encode()):
        line = summarise(payload)
        assert line.isprintable()
        assert len(line) <= LONGEST


@given(st.text())
def test_printable_keeps_what_is_printable(text: str) -> None:
    assert printable(text).isprintable()
    assert printable(text) == text or not text.isprintable()
