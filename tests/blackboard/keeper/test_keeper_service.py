import json
from queue import SimpleQueue

import msgspec
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from blackboard.keeper.status import KeeperStatus
from blackboard.link.addresses import KEEPER_STATUS, host_alive, host_beat, late
from blackboard.link.envelope import (
    Envelope,
    KeeperBeat,
    LostQuestion,
    join_batch,
    read_origin,
    split_batch,
    split_snapshot,
)
from blackboard.link.session import LinkParams, open_session
from blackboard.messages.hosts import HostBeat

WAIT_S = 20.0


def send(session, messages, heard, holds):
    """Post until the keeper's beat says so: what is dropped on the way is sent again."""
    while True:
        for message in messages:
            session.put(message.key, message.payload, message.attachment, "signal")
        beat = heard.get(timeout=WAIT_S)
        if holds(beat):
            return beat


def beats(session, robot="k2a"):
    """Return a queue of what the keeper tells about a robot's board."""
    heard = SimpleQueue()
    session.subscribe(f"ski/{robot}/@keeper/beat", lambda a: heard.put(msgspec.json.decode(a.payload, type=KeeperBeat)))
    return heard


def until(heard, holds):
    """Return the first of what is heard for which `holds`."""
    while True:
        item = heard.get(timeout=WAIT_S)
        if holds(item):
            return item


def held(host="robot", boot="b1", lane="signal", *, up_to):
    return lambda beat: beat.lanes.get(host, {}).get(boot, {}).get(lane, 0) >= up_to


def ask(session, key, question=b""):
    return session.ask(key, question, timeout_s=WAIT_S)


def status_of(session):
    return msgspec.json.decode(ask(session, KEEPER_STATUS)[0].payload, type=KeeperStatus)


def test_what_is_posted_is_acknowledged_and_there_for_late_joiners(keeper, client, battery):
    heard = beats(client)
    beat = send(client, [battery(n) for n in (1, 2, 3)], heard, held(up_to=3))
    assert beat.boot == keeper.boot
    header, envelopes = split_snapshot(ask(client, "ski/k2a/@keeper/snapshot")[0].payload)
    assert (header.boot, header.now_s, header.lanes) == (keeper.boot, None, {"robot": {"b1": {"signal": 3}}})
    assert [(e.origin.number, e.payload) for e in envelopes] == [(3, battery(3).payload)]
    assert [(a.key, a.payload) for a in ask(client, "ski/k2a/**")] == [(battery(3).key, battery(3).payload)]
    assert ask(client, "ski/k2a/commands/**") == []
    assert len(ask(client, "ski/*/observations/signal/*")) == 1


def test_a_board_that_nobody_has_posted_to_is_empty(client):
    header, envelopes = split_snapshot(ask(client, "ski/nobody/@keeper/snapshot")[0].payload)
    assert (header.lanes, envelopes) == ({}, [])
    assert status_of(client).boards == []


def test_who_missed_some_gets_them_and_who_lost_some_hands_them_in(keeper, client, battery):
    heard = beats(client)
    send(client, [battery(n) for n in (1, 2, 5)], heard, held(up_to=2))
    batch = [Envelope(read_origin(battery(n).attachment), battery(n).payload) for n in (3, 4, 5)]
    answer = ask(client, late("k2a", "observations/signal"), join_batch(batch))[0]
    assert msgspec.json.decode(answer.payload, type=KeeperBeat).lanes == {"robot": {"b1": {"signal": 5}}}
    question = LostQuestion(host="robot", boot="b1", lane="signal", first=2, last=9)
    lost = split_batch(ask(client, "ski/k2a/@keeper/lost", msgspec.json.encode(question))[0].payload)
    assert {e.origin.number: e.payload for e in lost} == {n: battery(n).payload for n in (2, 3, 4, 5)}
    assert status_of(client).missing == 0


def test_questions_that_make_no_sense_are_refused(client, battery):
    send(client, [battery(1)], beats(client), held(up_to=1))
    for key, question in [
        ("ski/k2a/@keeper/lost", b"{}"),
        ("ski/k2a/@keeper/lost", b"\xff"),
        ("ski/k2a/@late/observations/signal", b"\n\n x"),
        ("ski/k2a/@late/nothing/at_all", b""),
        ("ski/k2a/@keeper/clock", b'{"begin": 1.0}'),
        ("ski/k2a/@keeper/clock", b'{"begin": null, "end": 1}'),
    ]:
        assert [bool(a.error) for a in ask(client, key, question)] == [True], key


def test_one_clock_for_a_robot(client, keeper):
    def clock(question=b""):
        what = "begin" if question else "clock"
        return json.loads(ask(client, f"ski/k2a/@keeper/{what}", question)[0].payload)

    assert clock()["now_s"] is None
    assert clock(b'{"begin": 100.0, "pace": 2.0}')["now_s"] >= 100.0
    first, second = clock(b'{"begin": 0.0}'), clock()
    assert 100.0 <= first["now_s"] <= second["now_s"]
    assert second["now_s"] - first["now_s"] == pytest.approx(2.0 * (second["wall_s"] - first["wall_s"]), abs=1e-5)


def beat_of(boot, **more):
    said = HostBeat(boot=boot, pid=7, machine="m", version="1", components=("grid",), lanes={"signal": 4}, **more)
    return msgspec.json.encode(said)


def test_hosts_that_come_and_go_stand_on_the_status_panel(client, address, battery):
    heard = SimpleQueue()
    client.subscribe("ski/k2a/status/host/*", lambda a: heard.put(json.loads(a.payload)))

    def state(is_):
        return until(heard, lambda entry: entry["value"]["state"] == is_)

    with open_session(LinkParams(address=address)) as host:
        host.announce(host_alive("k2a", "map", "m1"))
        host.put(host_beat("k2a", "map"), beat_of("m1"))
        alive = until(heard, lambda entry: entry["value"]["components"] == ["grid"])
        assert (alive["key"], alive["source"], alive["value"]["boot"]) == ("ski/k2a/status/host/map", "keeper", "m1")
        state("hung")
    dead = state("dead")
    assert dead["revision"] > alive["revision"]
    with open_session(LinkParams(address=address)) as host:
        host.announce(host_alive("k2a", "map", "m2"))
        host.put(host_beat("k2a", "map"), beat_of("m2"))
        assert state("alive")["value"]["boot"] == "m2"
        host.put(host_beat("k2a", "map"), beat_of("m2", leaving=True))
        assert ask(host, "ski/k2a/status/host/map")  # by now the farewell has come
    state("stopped")


def test_what_a_host_says_it_sent_and_never_came_is_missing(client, battery):
    heard = beats(client)
    send(client, [battery(n, host="map", boot="m1") for n in (1, 2, 3)], heard, held("map", "m1", up_to=3))
    client.put(host_beat("k2a", "map"), beat_of("m1"))
    while status_of(client).missing == 0:
        pass  # the keeper gives them time to arrive
    lane = next(lane for lane in status_of(client).boards[0].lanes if lane.host == "map")
    assert (lane.posted, lane.held, lane.missing) == (4, 3, 1)
    send(client, [battery(4, host="map", boot="m1")], heard, held("map", "m1", up_to=4))
    assert status_of(client).missing == 0


def test_beats_and_tokens_that_name_no_host_are_refused(client):
    client.announce("ski/k2a/@hosts/h/**")
    client.announce("ski/k2a/@hosts/h/alive/*")
    client.put("ski/k2a/@hosts/**", beat_of("m1"))
    client.put("ski/k2a/@hosts/map/beat", beat_of("m 1"))
    client.put("ski/k2a/@hosts/map/beat", b"{}")
    while status_of(client).refused.get("host", 0) < 3:
        pass
    assert status_of(client).clients == 0


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    key=st.sampled_from(
        [
            "ski/k2a/observations/signal/battery",
            "ski/k2a/nothing",
            "ski/x/@hosts/h/beat",
            "ski/k2a/@hosts/h/beat",
            "ski/@keeper/status",
            "ski/k2a/@keeper/beat",
            "ski/é/status/host/x",
        ]
    ),
    payload=st.one_of(st.binary(max_size=300), st.text(max_size=100).map(str.encode)),
    attachment=st.one_of(
        st.binary(max_size=60),
        st.builds("{} {} {} {}".format, *[st.text(max_size=9)] * 4).map(str.encode),
        st.just(b"h b signal 1"),
    ),
)
def test_whatever_bytes_come_the_keeper_lives_on_and_nothing_stands(keeper, client, key, payload, attachment):
    client.put(key, payload, attachment)
    for asked in ("ski/k2a/@keeper/lost", "ski/k2a/@late/observations/signal", "ski/k2a/@keeper/begin"):
        assert len(client.ask(asked, payload, timeout_s=WAIT_S)) <= 1
    assert sum(board.standing for board in status_of(client).boards) == 0
