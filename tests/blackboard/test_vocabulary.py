"""What is refused, and in which words; what is taken arrives unchanged."""

import json
import math
from typing import Any

import jsonschema
import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import BoardError, MessageError
from blackboard.kinds import GRID, LASER_SCAN, LINE, ODOMETRY, SONAR_SCAN, Kind, collection, slot
from blackboard.messages.base import Message
from blackboard.messages.geometry import PackedArray, Pose, pack_array
from blackboard.messages.sensing import MAX_SONARS, LaserScan, Odometry, SonarScan
from blackboard.messages.world import TILE_CELLS, GridTile
from blackboard.vocabulary import Vocabulary, checked, core_kinds, decode

KEY = "ski/k2a/observations/signal/odometry"


def odometry(x_m: Any = 1.0) -> Odometry:
    return Odometry(pose=Pose(x_m=x_m, y_m=0.0, heading_rad=0.0))


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (odometry(math.nan), "pose.x_m = nan: must be finite"),
        (odometry(math.inf), "pose.x_m = inf: must be finite"),
        (odometry(2e6), "pose.x_m = 2000000.0: Expected float <= 1000000.0"),
        (odometry("1"), "pose.x_m = '1': Expected float, got str"),
        (odometry(True), "pose.x_m = True: Expected float, got bool"),
        (odometry({1}), "pose.x_m"),
        (odometry(np.float64(1.0)), "plain numbers"),
        (Pose(x_m=0.0, y_m=0.0, heading_rad=0.0), "a Pose was posted, this key holds Odometry"),
    ],
)
def test_posting_refuses(value: Any, words: str) -> None:
    with pytest.raises(MessageError) as caught:
        checked(ODOMETRY, KEY, value)
    text = str(caught.value)
    assert text.startswith(KEY)
    assert words in text
    assert "\n" not in text


@pytest.mark.parametrize("bad", [math.nan, -1.0, 1e9, "x"])
def test_a_missing_echo_is_none_and_nothing_else(bad: Any) -> None:
    checked(SONAR_SCAN, "k", SonarScan(sensors=(0, 1), ranges_m=(None, 1.5)))
    with pytest.raises(MessageError, match=r"ranges_m\[1\] = "):
        checked(SONAR_SCAN, "k", SonarScan(sensors=(0, 1), ranges_m=(None, bad)))


def test_over_long_and_uneven_arrays() -> None:
    many = tuple(range(MAX_SONARS + 1))
    with pytest.raises(MessageError, match=f"sensors.*<= {MAX_SONARS}"):
        checked(SONAR_SCAN, "k", SonarScan(sensors=many, ranges_m=(None,) * len(many)))
    with pytest.raises(MessageError, match="2 values for 1 sensors"):
        decode(SONAR_SCAN, "k", b'{"sensors":[1],"ranges_m":[1.0,2.0]}')
    with pytest.raises(MessageError, match="must be a tuple, not a list"):
        checked(LASER_SCAN, "k", LaserScan(angle_min_rad=0.0, angle_step_rad=0.1, ranges_m=[1.0]))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b'{"pose":{"x_m":1,"y_m":0,"heading_rad":0},"speed":3}', "unknown field speed"),
        (b'{"pose":{"x_m":1,"y_m":0}}', "pose = .*missing required field heading_rad"),
        (b'{"pose":{"x_m":"a","y_m":0,"heading_rad":0}}', r"pose\.x_m = 'a': Expected float, got str"),
        (b'{"pose":{"x_m":NaN,"y_m":0,"heading_rad":0}}', "not JSON"),
        (b'{"pose":{"x_m":1e999,"y_m":0,"heading_rad":0}}', r"pose\.x_m.*(out of range|finite)"),
        (b"\xff\xfe", "not JSON"),
        (b"", "not JSON"),
        (b'"\x80"', "Expected object"),
        (b"[" * 100_000, "not JSON|Expected object"),
    ],
)
def test_decoding_refuses(data: bytes, words: str) -> None:
    with pytest.raises(MessageError, match=words) as caught:
        decode(ODOMETRY, KEY, data)
    assert str(caught.value).startswith(KEY)


@given(st.binary(max_size=300))
def test_any_bytes_are_taken_or_refused(data: bytes) -> None:
    for kind in (ODOMETRY, GRID, SONAR_SCAN):
        try:
            value = decode(kind, "k", data)
        except MessageError:
            continue
        assert isinstance(value, kind.type)


@given(st.lists(st.one_of(st.none(), st.floats(0, 1000)), max_size=MAX_SONARS))
def test_what_is_posted_arrives_unchanged(ranges: list[float | None]) -> None:
    scan = SonarScan(sensors=tuple(range(len(ranges))), ranges_m=tuple(ranges))
    value, raw = checked(SONAR_SCAN, "k", scan)
    assert value == scan
    assert decode(SONAR_SCAN, "k", raw) == scan
    jsonschema.validate(json.loads(raw), Vocabulary().schemas()[SONAR_SCAN.path])


def test_arrays_are_checked_against_shape_type_and_size() -> None:
    cells = pack_array(np.full((TILE_CELLS, TILE_CELLS), 128, np.uint8))
    tile = GridTile(column=-1, row=2, cell_m=0.05, cells=cells)
    value, raw = checked(GRID, "k", tile)
    assert value.cells.unpack().tolist() == [[128] * TILE_CELLS] * TILE_CELLS
    wrong = json.loads(raw)
    wrong["cells"]["shape"] = [TILE_CELLS, TILE_CELLS + 1]
    with pytest.raises(MessageError, match="holds 4096 bytes, shape and dtype say 4160"):
        decode(GRID, "k", msgspec.json.encode(wrong))
    with pytest.raises(ValueError, match="NaN or infinity"):
        pack_array(np.array([1.0, np.nan], np.float32))
    with pytest.raises(ValueError, match="does not unpack"):
        PackedArray(shape=(1,), dtype="uint8", zlib_base64="????")
    with pytest.raises(ValueError, match="over the limit"):
        PackedArray(shape=(100_000, 100_000), dtype="uint8", zlib_base64="")
    bomb = pack_array(np.zeros(1_000_000, np.uint8))
    with pytest.raises(ValueError, match=r"holds \d+ bytes"):
        PackedArray(shape=(10,), dtype="uint8", zlib_base64=bomb.zlib_base64)


def test_every_kind_has_a_valid_schema() -> None:
    for path, schema in Vocabulary().schemas().items():
        jsonschema.Draft202012Validator.check_schema(schema)
        assert schema["description"], path


def test_kinds() -> None:
    vocabulary = Vocabulary()
    assert vocabulary.parse_key("ski/k2a/observations/feature/line/3-0") == ("k2a", LINE, "3-0")
    assert vocabulary.parse_key("ski/k2a/commands/drive")[2] is None
    for key in (
        "ski/k2a/observations/feature/lime/3",
        "ski/k2a/commands/drive/1",
        "ski/k2a",
        "other/k2a/commands/drive",
    ):
        with pytest.raises(BoardError):
            vocabulary.parse_key(key)
    with pytest.raises(BoardError, match="did you mean 'observations/feature/line'"):
        vocabulary.at("observations/feature/lines")
    with pytest.raises(BoardError, match="declared twice"):
        Vocabulary([slot("observations/feature/line", Pose, "another")])
    with pytest.raises(BoardError, match="panel 'observation' is none of"):
        slot("observation/feature/x", Pose, "")
    with pytest.raises(BoardError, match="must be of the form"):
        collection("observations/x", Pose, "")
    own: Kind[Pose] = slot("hypotheses/symbol/mug", Pose, "a mug")
    assert own in Vocabulary([own])
    assert own not in vocabulary


def test_each_kind_is_declared_once() -> None:
    paths = [kind.path for kind in core_kinds()]
    assert len(paths) == len(set(paths)) > 15


class Notes(Message, frozen=True, kw_only=True):
    """Words without a limit of their own."""

    texts: tuple[str, ...]


def test_a_value_too_large_for_a_link_is_refused_where_it_is_posted() -> None:
    kind = slot("hypotheses/symbol/notes", Notes, "notes")
    checked(kind, "ski/r/notes", Notes(texts=("x" * 1_000_000,) * 9))
    with pytest.raises(MessageError, match="the limit is 10000000; post it in parts"):
        checked(kind, "ski/r/notes", Notes(texts=("x" * 1_000_000,) * 11))
