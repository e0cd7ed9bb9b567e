"""Gathers what `ski doctor` judges: tries the address, asks the keeper, listens for a while."""

import datetime
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import msgspec

from blackboard.entry import Entry
from blackboard.errors import BoardError, KeysError, LinkError, MessageError
from blackboard.keeper.status import BoardStatus, KeeperStatus
from blackboard.key_expressions import matches
from blackboard.keys.material import member_material
from blackboard.kinds import (
    ACTIVATION,
    COMMUNICATION_ERROR,
    COMPONENT,
    FOCUS,
    HOST,
    LEVELLED_PANELS,
    MISSION,
    PROCESS,
    RULE_ERROR,
)
from blackboard.link.address import parse_address
from blackboard.link.addresses import KEEPER_STATUS
from blackboard.link.envelope import read_entry, read_payload
from blackboard.link.session import LinkParams, Session, open_session
from blackboard.messages.hosts import HostBeat
from blackboard.vocabulary import Vocabulary
from blackboard.watching.listening import Listener
from blackboard.watching.probe import connects, tls_trouble
from blackboard.watching.setup_facts import HostFacts, KeeperFacts, RobotFacts, SetupFacts, StreamFacts

READINGS = "observations/signal"
ASKED = ("status/**", f"{ACTIVATION.path}/*", f"{FOCUS.path}/*", f"{RULE_ERROR.path}/*", f"{READINGS}/**")
VERSION = version("sensory-knowledge-integrator")


def gather(params: LinkParams, listen_s: float, expected: Mapping[str, str]) -> SetupFacts:
    """Return what can be found out; listening takes `listen_s`. Raises LinkError where the address is none."""
    address = parse_address(params.address)
    facts = SetupFacts(address=params.address, version=VERSION, answers="nobody", expected=expected)
    try:
        facts = replace(facts, member=_member(params.keys))
        trouble = connects(address)
        if trouble:
            return replace(facts, trouble=trouble)
        with open_session(params) as session:
            return _asked(session, facts, listen_s)
    except KeysError as error:
        return replace(facts, answers="refused", trouble=str(error))
    except LinkError as error:
        return _unlinked(params, facts, str(error))


def _member(keys: Path | None) -> str:
    if keys is None:
        return ""
    member = member_material(keys, datetime.datetime.now(datetime.UTC))[1]
    return f"{member.name} ({', '.join(member.roles)})"


def _unlinked(params: LinkParams, facts: SetupFacts, said: str) -> SetupFacts:
    """Something listens, and there is no link to it."""
    address = parse_address(params.address)
    refused = tls_trouble(address, params.keys)
    if refused is not None:
        if params.keys is None:
            return replace(facts, answers="certificates")
        return replace(facts, answers="refused", trouble=refused or said)
    if params.keys is not None and address.loopback:
        with suppress(LinkError), open_session(LinkParams(address=address.endpoint("tcp"))):
            return replace(facts, answers="no certificates")
    return replace(facts, answers="something else")


def _asked(session: Session, facts: SetupFacts, listen_s: float) -> SetupFacts:
    if _status(session) is None:
        return replace(facts, answers="a router")
    came = Listener(session, "ski/**")
    beating = Listener(session, "ski/*/@hosts/*/beat")
    counts: Counter[str] = Counter()
    heard: dict[str, bytes] = {}
    for arrived in came.until(time.monotonic() + listen_s):
        if arrived is not None:
            counts[_path(arrived.key)] += 1
            heard[arrived.key] = arrived.payload
    beats = [beat for a in beating.take(0.1) if (beat := _beat(a.key, a.payload)) is not None]
    status = _status(session)
    if status is None:
        return replace(facts, answers="a router", trouble="the keeper answered, and then no more")
    entries = _newest(session, heard)
    hosts = [host for board in status.boards for host in _hosts(board, entries, beats)]
    return replace(
        facts,
        answers="a keeper",
        keeper=_keeper(status),
        robots=tuple(_robot(board, entries, counts) for board in status.boards),
        hosts=tuple(sorted(hosts, key=lambda host: (host.robot, host.name))),
    )


def _status(session: Session) -> KeeperStatus | None:
    for answer in session.ask(KEEPER_STATUS):
        if not answer.error:
            try:
                return msgspec.json.decode(answer.payload, type=KeeperStatus)
            except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
                return None
    return None


def _newest(session: Session, heard: Mapping[str, bytes]) -> list[tuple[str, str, Entry[Any]]]:
    """Return robot, kind's path and entry of what is asked for, as the keeper has it or as it was heard, where that is newer.

    Kinds that this vocabulary lacks are passed over.
    """
    vocabulary = Vocabulary()
    found: dict[str, tuple[str, str, Entry[Any]]] = {}
    expressions = [f"ski/*/{pattern}" for pattern in ASKED]
    standing = [(answer.key, answer.payload) for expression in expressions for answer in session.ask(expression)]
    live = [(key, payload) for key, payload in heard.items() if any(matches(e, key) for e in expressions)]
    for key, payload in [*standing, *live]:
        try:
            kind, entry = read_entry(vocabulary, read_payload(key, payload))
        except (BoardError, MessageError):
            continue
        if key not in found or entry.revision > found[key][2].revision:
            found[key] = (vocabulary.parse_key(key)[0], kind.path, entry)
    return [one for one in found.values() if one[2].event != "retracted"]


def _keeper(status: KeeperStatus) -> KeeperFacts:
    refused: Counter[str] = Counter(status.refused)
    examples: dict[str, str] = {}
    for board in status.boards:
        refused.update(board.refused)
        examples |= board.refusals
    return KeeperFacts(
        version=status.version,
        folder=status.folder,
        journal_trouble=next((board.trouble for board in status.boards if board.trouble), ""),
        refused=refused,
        refused_example=examples,
        rejected=status.rejected,
        overflowed=status.overflowed,
    )


def _robot(board: BoardStatus, entries: Iterable[tuple[str, str, Entry[Any]]], counts: Counter[str]) -> RobotFacts:
    ours = [(path, entry) for robot, path, entry in entries if robot == board.robot]
    resting = {str(entry.id) for path, entry in ours if path == FOCUS.path and not entry.value.enabled}
    return RobotFacts(
        name=board.robot,
        clock_s=board.now_s,
        mission=next((entry.value.state for path, entry in ours if path == MISSION.path), ""),
        readings=tuple(
            StreamFacts(name=path, count=entry.revision, stamp_s=entry.stamp_s)
            for path, entry in ours
            if path.startswith(READINGS)
        ),
        activations=tuple(
            StreamFacts(
                name=str(entry.id),
                count=entry.revision,
                stamp_s=entry.stamp_s,
                woken_by=_path(entry.value.trigger_key).partition("/")[2],
                wakers_came=counts[_path(entry.value.trigger_key)],
                rests=str(entry.id) in resting,
            )
            for path, entry in ours
            if path == ACTIVATION.path
        ),
        failed={str(e.id): e.value.error for path, e in ours if path == COMPONENT.path and e.value.state == "failed"},
        rule_errors={str(e.id): e.value.text for path, e in ours if path == RULE_ERROR.path},
        unanswered={str(e.id): e.value.waited_s for path, e in ours if path == COMMUNICATION_ERROR.path},
        given_up={
            str(e.id): e.value.last_line for path, e in ours if path == PROCESS.path and e.value.state == "failed"
        },
    )


def _hosts(
    board: BoardStatus, entries: Iterable[tuple[str, str, Entry[Any]]], beats: Iterable[tuple[str, str, HostBeat]]
) -> Iterator[HostFacts]:
    for robot, path, entry in entries:
        if robot != board.robot or path != HOST.path:
            continue
        told, name = entry.value, str(entry.id)
        heard = {beat.boot: beat for r, host, beat in beats if (r, host) == (robot, name) and not beat.leaving}
        yield HostFacts(
            robot=robot,
            name=name,
            state=told.state,
            version=told.version,
            machine=told.machine,
            components=told.components,
            offset_s=told.offset_s,
            round_trip_s=told.round_trip_s,
            missed=sum(beat.missed for beat in heard.values()),
            boots=max(1, len(heard)),
            lacking=sum(lane.missing for lane in board.lanes if lane.host == name),
        )


def _beat(key: str, payload: bytes) -> tuple[str, str, HostBeat] | None:
    """Return robot, host and beat."""
    chunks = key.split("/")
    try:
        return chunks[1], chunks[3], msgspec.json.decode(payload, type=HostBeat)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError, IndexError):
        return None


def _path(key: str) -> str:
    """Return robot and kind's path of a key: without `ski/` and, of a member, without its id."""
    chunks = key.split("/")
    return "/".join(chunks[1 : 5 if len(chunks) > 2 and chunks[2] in LEVELLED_PANELS else 4])
