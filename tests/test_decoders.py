"""Bytes thrown at every decoder of what comes from outside: each ends soon, and raises nothing but errors of ours, of one line."""

from pathlib import Path

import pytest
from fuzz_seeds import journal, map_yaml, robots
from fuzz_targets import TARGETS, Target, feed
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from blackboard.errors import SkiError

BY_NAME = {target.name: target for target in TARGETS}
WORDS = st.sampled_from(
    [b"", b"\0", b"\n", b"\t", b'"', b"\\", b"\\ud800", b"\xff\xfe", b"\xe2\x80\xa8", b"NaN", b"inf", b"1e999", b"-0.0", b"null",
     b"9" * 400, b"9" * 5000, b"1" * 70_000, b"[" * 3000, b"(" * 3000, b'{"a":' * 3000, b"=", b"[]", b"{}", b"()", b"..", b"/"]
)  # fmt: skip
Edit = tuple[int, int, bytes, bool]
EDITS = st.lists(
    st.tuples(
        st.integers(0, 10_000), st.integers(0, 60), st.one_of(WORDS, st.binary(max_size=8), WORDS), st.booleans()
    ),
    min_size=1,
    max_size=4,
)


def edited(good: bytes, edits: list[Edit]) -> bytes:
    """Return good input with bytes replaced, taken out, put in, or doubled; places are taken round its end."""
    data = good
    for place, length, word, doubles in edits:
        at = place % (len(data) + 1)
        there = data[at : at + length]
        data = data[:at] + (there + there if doubles else word) + data[at + length :]
    return data


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_good_inputs_are_good(target: Target, tmp_path: Path) -> None:
    for good in target.seeds():
        target.feed(good, tmp_path)


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
@given(which=st.integers(0, 100), edits=EDITS, other=st.binary(max_size=200), spoils=st.booleans())
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_whatever_comes(
    target: Target, tmp_path: Path, which: int, edits: list[Edit], other: bytes, spoils: bool
) -> None:
    good = target.seeds()
    data = edited(good[which % len(good)], edits) if spoils else other
    fault = feed(target, data, tmp_path)
    assert fault is None, f"{type(fault).__name__}: {fault}"


FOUND = [
    ("journal", journal().replace(b"status", b"st\xabtus", 1)),
    ("journal", b'{"key":"' + b"[" * 3000 + b"\n"),
    ("journal", journal().replace(b'"limited_by":"', b'"limited_by":"\xdc', 1)),
    ("payload", b'{"key":"k","revision":1,"event":"posted","stamp_s":1,"source":"s","value":[' + b"9" * 400 + b",1" * 20 + b"]}"),
    ("processes", b'{"beg\x97n":0.0}'),
    ("kept-journal", b'{"a":' * 3000 + b"\n"),
    ("mission", b"a = " + b"[" * 3000),
    ("mission", b"a = " + b"9" * 5000),
    ("mission", b'[robot]\nuse = "' + b"e" * 400 + b'.py:A"\n'),
    ("settings", b"\n.b=[1, ~2"),
    ("settings", b"a.b=" + b"[" * 3000),
    ("settings", b"a.b=" + b"9" * 5000),
    ("story", b'files = "' + b"9" * 400 + b'"\n'),
    ("robot", robots()[0].replace(b"radius_m = 0.", b"radius_m = " + b"9" * 400 + b" # ")),
    ("robot", robots()[0].replace(b"_deg = ", b"_deg = " + b"9" * 400 + b" # ", 1)),
    ("rules", b"(deffacts a (n " + b"1" * 400_000 + b"x))"),
    ("rules", b"(deffacts a (n " + b"1" * 5000 + b"))"),
    ("keys", b"a\nb"),
    ("map-yaml", map_yaml().replace(b"map.png", b"m" * 400 + b".png")),
]  # fmt: skip


@pytest.mark.parametrize(("name", "data"), FOUND, ids=[f"{name}-{number}" for number, (name, _) in enumerate(FOUND)])
def test_what_fuzzers_have_found(name: str, data: bytes, tmp_path: Path) -> None:
    fault = feed(BY_NAME[name], data, tmp_path)
    assert fault is None, f"{type(fault).__name__}: {fault}"


@given(text=st.text(max_size=60))
@example("a\nb\x1b[2J\u202e\ud800")
def test_errors_are_one_line_whatever_they_quote(text: str) -> None:
    said = str(SkiError(f"no '{text}'"))
    assert said.isprintable()
    assert "\n" not in said
