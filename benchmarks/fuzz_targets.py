"""Every decoder of what comes from outside, each as a function of bytes that may raise nothing but a SkiError.

For the properties in `tests/test_decoders.py` and the coverage-guided fuzzer `fuzz.py`.
"""

import contextlib
import gzip
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fuzz_seeds as seeds
import msgspec

from blackboard.checkpoint import read_checkpoint
from blackboard.errors import BoardError, MessageError, SkiError
from blackboard.journal import read_journal
from blackboard.keeper import checkpoint as keeper_checkpoint
from blackboard.keeper.checking import Checker, Refused, key_of
from blackboard.keeper.clock import KeptClock
from blackboard.keeper.journal_file import JournalFile, read_journalled
from blackboard.keeper.refused_file import read_refused
from blackboard.key_expressions import check_expression, matches
from blackboard.link.clock import ClockAnswer
from blackboard.link.envelope import (
    Envelope,
    KeeperBeat,
    LostQuestion,
    Origin,
    read_entry,
    read_origin,
    read_payload,
    read_told,
    split_batch,
    split_snapshot,
)
from blackboard.link.outbox import Outbox
from blackboard.messages.hosts import HostBeat
from blackboard.mission import load_mission, parse_settings
from blackboard.processes.protocol import AgentReport, ManagerBeat, Order, decode
from blackboard.processes.state_folder import StateFolder
from blackboard.vocabulary import Vocabulary
from blackboard.watching.summary import summarise
from blackboard.why import Record
from rules.language.templates import planning_templates
from rules.rule_files import RuleFileSet, program_of
from rules.storytelling.story_file import read_story
from sim.point_maps.reading import read_points
from sim.recordings.formats import open_recording
from sim.robot_file import load_robot
from sim.ros_map import load_ros_map
from sim.world_file import load_world_file

VOCABULARY = Vocabulary()
TEMPLATES = planning_templates(VOCABULARY)
HEARD = 200  # of a recording are read


@dataclass(frozen=True)
class Target:
    """A decoder, fed with bytes in a folder of its own, and good inputs to begin with. `binary`: no words in it."""

    name: str
    feed: Callable[[bytes, Path], Any]
    seeds: Callable[[], Sequence[bytes]]
    binary: bool = False


def _payload(data: bytes, folder: Path) -> None:
    summarise(data)
    for key in (None, "ski/k2a/status/robot"):
        try:
            read_entry(VOCABULARY, read_payload(key, data))
        except SkiError:
            continue
    try:
        Checker(VOCABULARY, 1_000_000).check(key_of(data), data, Origin("h", "b", "signal", 1))
    except Refused:
        return


def _envelopes(envelopes: Sequence[Envelope]) -> None:
    for envelope in envelopes:
        try:
            read_entry(VOCABULARY, read_payload(None, envelope.payload))
        except (MessageError, BoardError):
            continue


def _batch(data: bytes, folder: Path) -> None:
    _envelopes(split_batch(data))


def _snapshot(data: bytes, folder: Path) -> None:
    _envelopes(split_snapshot(data)[1])


def _told(data: bytes, folder: Path) -> None:
    for type_ in (KeeperBeat, HostBeat, LostQuestion, ClockAnswer):
        with contextlib.suppress(MessageError):
            read_told(data, type_)


def _clock_file(data: bytes, folder: Path) -> None:
    (folder / "clock.json").write_bytes(data)
    msgspec.json.encode(KeptClock(folder, lambda: 0.0).answer(b""))


def _clock_question(data: bytes, folder: Path) -> None:
    (folder / "clock.json").unlink(missing_ok=True)
    msgspec.json.encode(KeptClock(folder, lambda: 0.0).answer(data))


def _processes(data: bytes, folder: Path) -> None:
    for type_ in (Order, ManagerBeat, AgentReport):
        try:
            decode(data, type_)
        except SkiError:
            continue
    state = StateFolder("tcp/127.0.0.1:7799", folder)
    (state.path / "processes").mkdir(parents=True, exist_ok=True)
    (state.path / "processes" / "a.json").write_bytes(data)
    state.records()


def _journal(data: bytes, folder: Path) -> None:
    (folder / "board.jsonl").write_bytes(data)
    record = Record(read_journal(folder))
    record.explain(record.find("commands/drive"), depth=5)


def _kept_journal(data: bytes, folder: Path) -> None:
    (folder / "board.jsonl").write_bytes(data)
    (folder / "checkpoint.jsonl").write_bytes(data)
    (folder / "refused.jsonl").write_bytes(data)
    journal = JournalFile(folder)
    try:
        _envelopes([found for _, line in journal.lines(0) if (found := read_journalled(line)) is not None])
    finally:
        journal.close()
    list(read_refused(folder))
    keeper_checkpoint.read_checkpoint(folder)


def _outbox(data: bytes, folder: Path) -> None:
    for path in folder.glob("*.outbox"):
        path.unlink()
    (folder / "00000001.outbox").write_bytes(data)
    Outbox(folder).close()


def _checkpoint(data: bytes, folder: Path) -> None:
    path = folder / "a.checkpoint"
    path.write_bytes(data)
    path.chmod(0o600)
    checkpoint = read_checkpoint(path, seeds.IDENTITY)
    if checkpoint is not None:
        checkpoint.states(VOCABULARY)


def _mission(data: bytes, folder: Path) -> None:
    load_mission(_file(data, folder, "a.toml"))


def _settings(data: bytes, folder: Path) -> None:
    parse_settings(data.decode("utf-8", "surrogateescape").split("\0"))


def _rules(data: bytes, folder: Path) -> None:
    files = RuleFileSet([_file(data, folder, "a.clp")])
    program_of(files.read(), TEMPLATES)


def _story(data: bytes, folder: Path) -> None:
    read_story(_file(data, folder, "a.story"))


def _recording(name: str) -> Callable[[bytes, Path], None]:
    def feed(data: bytes, folder: Path) -> None:
        recording = open_recording(_file(data, folder, name))
        for number, _ in enumerate(recording.replay()):
            if number >= HEARD:
                return

    return feed


def _zipped(data: bytes, folder: Path) -> None:
    _recording("a.log.gz")(gzip.compress(data, 1), folder)


def _ros_map(data: bytes, folder: Path) -> None:
    (folder / "map.png").write_bytes(seeds.map_image())
    load_ros_map(_file(data, folder, "map.yaml"))


def _image(data: bytes, folder: Path) -> None:
    (folder / "map.png").write_bytes(data)
    load_ros_map(_file(seeds.map_yaml(), folder, "map.yaml"))


def _keys(data: bytes, folder: Path) -> None:
    text = data.decode("utf-8", "replace")
    with contextlib.suppress(BoardError):
        VOCABULARY.parse_key(text)
    expression, _, key = text.partition("|")
    check_expression(expression)
    matches(expression, key)


def _file(data: bytes, folder: Path, name: str) -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


TARGETS = (
    Target("attachment", lambda data, _: read_origin(data), lambda: [b"robot b1 signal 17", b"h-1 0.b large 1"]),
    Target("payload", _payload, seeds.lines),
    Target("batch", _batch, lambda: [seeds.batch()]),
    Target("snapshot", _snapshot, lambda: [seeds.snapshot()]),
    Target("told", _told, seeds.beats),
    Target("clock-file", _clock_file, lambda: [b'{"wall_s":1.0,"begin":0.0,"pace":1.0}']),
    Target("clock-question", _clock_question, lambda: [b'{"begin":0.0,"pace":2.0}', b"{}", b""]),
    Target("processes", _processes, seeds.orders),
    Target("journal", _journal, lambda: [seeds.journal()]),
    Target("kept-journal", _kept_journal, lambda: [seeds.kept_journal()]),
    Target("outbox", _outbox, lambda: [seeds.batch()]),
    Target("checkpoint", _checkpoint, lambda: [seeds.checkpoint()], binary=True),
    Target("mission", _mission, seeds.missions),
    Target("settings", _settings, lambda: [b"eou_grid.cell_m=0.1\0robot.world=lab", b"a.b=[1, 2"]),
    Target("rules", _rules, seeds.rule_texts),
    Target("story", _story, lambda: [b'files = "explore.clp"\n\n[[step]]\nsay = "x"\nassert = "(mode go)"\n']),
    Target("world", lambda data, folder: load_world_file(_file(data, folder, "a.toml")), seeds.worlds),
    Target("robot", lambda data, folder: load_robot(_file(data, folder, "a.toml")), seeds.robots),
    Target("carmen", _recording("a.log"), lambda: [seeds.carmen()]),
    Target("carmen-gz", _zipped, lambda: [seeds.carmen()]),
    Target("gzip", _recording("b.log.gz"), lambda: [seeds.zipped(seeds.carmen())], binary=True),
    Target("bag-ros1", _recording("a.bag"), lambda: [seeds.bag("ros1")], binary=True),
    Target("bag-mcap", _recording("a.mcap"), lambda: [seeds.bag("mcap")], binary=True),
    Target("bag-sqlite", _recording("a.db3"), lambda: [seeds.bag("sqlite3")], binary=True),
    Target("points", lambda data, folder: read_points(_file(data, folder, "a.txt")), seeds.points),
    Target("map-yaml", _ros_map, lambda: [seeds.map_yaml()]),
    Target("map-image", _image, lambda: [seeds.map_image(), seeds.map_image("PPM")], binary=True),
    Target("keys", _keys, lambda: [b"ski/*/**/line/3|ski/k2a/observations/feature/line/3", b"ski/$*a|ski/a"]),
)


def feed(target: Target, data: bytes, folder: Path) -> Exception | None:
    """Feed a target; return what it raised that is no SkiError."""
    try:
        target.feed(data, folder)
    except SkiError as error:
        if "\n" in str(error):
            return AssertionError(f"more than one line: {error!s}")
    except Exception as error:
        return error
    return None
