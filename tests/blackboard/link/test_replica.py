"""Replicas of one board through a real keeper: everything arrives once, in order, whatever was lost on the way."""

from queue import Empty
from threading import Thread

import msgspec
import pytest

from blackboard.entry import Entry
from blackboard.errors import LinkError
from blackboard.keeper.service import Keeper
from blackboard.kinds import BATTERY, TARGET, VELOCITY
from blackboard.link import sender as module
from blackboard.link.replica import Replica
from blackboard.link.session import LinkParams, open_session
from blackboard.messages.geometry import Point
from blackboard.messages.motion import Velocity
from blackboard.messages.sensing import Battery
from blackboard.messages.symbols import Target
from blackboard.vocabulary import Vocabulary

WAIT_S = 20.0


def target(x_m=0.0):
    return Target(place=Point(x_m=x_m, y_m=0.0), stand=Point(x_m=0.0, y_m=0.0), reason="frontier", size_m=1.0)


class Deaf:
    """A session that loses some of what it sends, as a full queue on the way does."""

    def __init__(self, session, lose):
        self._session, self._lose, self.sent = session, lose, 0

    def put(self, key, *rest, **named):
        self.sent += 1
        if "@" in key or not self._lose(self.sent):
            self._session.put(key, *rest, **named)

    def __getattr__(self, name):
        return getattr(self._session, name)


@pytest.fixture
def join(keeper, address):
    """Return a function that joins the board as a host, through a session of its own."""
    sessions, replicas = [], []

    def make(host, *, state=None, lose=None, **options):
        session = open_session(LinkParams(address=address))
        sessions.append(session)
        replica = Replica(
            session if lose is None else Deaf(session, lose), Vocabulary(), "k2a", host, state=state, **options
        )
        replicas.append(replica)
        replica.join()
        return replica

    yield make
    for replica in replicas:
        replica.close()
    for session in sessions:
        session.close()


def run_until(holds, *replicas):
    """Run the replicas' loops until something holds; it fails only where that never happens."""
    rounds = 0
    while not holds():
        rounds += 1
        assert rounds < 20_000, "it never happened"
        for replica in replicas:
            try:
                replica.handle(replica.queue.get(timeout=0.001))
            except Empty:
                replica.tend()


def heard_by(replica, kind=TARGET):
    heard: list[Entry] = []
    replica.board.subscribe(f"ski/k2a/{kind.path}{'/*' if kind.collection else ''}", heard.append)
    return heard


def test_a_post_stands_on_the_other_replica_and_wakes_its_subscribers(join):
    one, other = join("one"), join("other")
    heard = heard_by(other)
    posted = one.board.post(TARGET, target(1.0), id="7", source="finder", stamp_s=3.0)
    run_until(lambda: heard, one, other)
    (entry,) = heard
    assert (entry.key, entry.revision, entry.stamp_s, entry.source, entry.value) == (
        posted.key,
        1,
        3.0,
        "finder",
        target(1.0),
    )
    assert other.board.newest(TARGET, "7") is entry


def test_endorsements_of_another_process_reach_the_owner(join):
    one, other = join("one"), join("other")
    heard = heard_by(other)
    one.board.post(TARGET, target(), id="7", source="finder")
    run_until(lambda: heard, one, other)
    other.board.endorse(heard[0].key, who="door", verdict="against", why="it is a door")
    run_until(lambda: one.board.newest(TARGET, "7").endorsements, one, other)
    assert one.board.newest(TARGET, "7").endorsements[0].who == "door"


def test_what_is_lost_on_the_way_arrives_all_the_same_in_order(join):
    one, other = join("one", lose=lambda n: n % 3 == 0), join("other")
    heard = heard_by(other)
    for n in range(60):
        one.board.post(TARGET, target(float(n)), id="7", source="finder", stamp_s=float(n))
    run_until(lambda: len(heard) == 60 and not one.unacknowledged, one, other)
    assert [entry.value.place.x_m for entry in heard] == [float(n) for n in range(60)]


def test_the_end_of_a_lane_arrives_though_nothing_follows_it(join):
    one, other = join("one", lose=lambda n: True), join("other")
    heard = heard_by(other)
    one.board.post(TARGET, target(), id="7", source="finder")
    run_until(lambda: heard, one, other)


def test_commands_that_were_lost_are_kept_and_never_handed_on(join, keeper):
    one, other = join("one", lose=lambda n: n == 1), join("other")
    heard = heard_by(other, VELOCITY)
    for n in (1, 2):
        velocity = Velocity(forward_mps=0.1 * n, turn_radps=0.0, valid_until_s=float(n))
        one.board.post(VELOCITY, velocity, source="coordinator", stamp_s=float(n))
    run_until(lambda: heard and not one.unacknowledged, one, other)
    assert [entry.revision for entry in heard] == [2]
    lines = (keeper.folder / "k2a" / "board.jsonl").read_text().splitlines()
    assert sum("commands/velocity" in line for line in lines) == 2


def test_a_late_joiner_has_the_board_and_nobody_is_told(join):
    one = join("one")
    for n in range(5):
        one.board.post(TARGET, target(float(n)), id=str(n), source="finder")
    one.board.retract(TARGET, "0", source="finder")
    run_until(lambda: not one.unacknowledged, one)
    late = join("late")
    assert [e.id for e in late.board.entries(TARGET)] == ["1", "2", "3", "4"]
    late.board.post(TARGET, target(), id="0", source="finder")
    assert late.board.newest(TARGET, "0").revision == 3


def test_a_killed_host_hands_in_what_it_had_not_been_able_to_send(join, tmp_path):
    killed = join("one", state=tmp_path, lose=lambda n: True)
    other = join("other")
    heard = heard_by(other)
    for n in range(3):
        killed.board.post(TARGET, target(float(n)), id=str(n), source="finder")
    again = join("one", state=tmp_path)
    assert [e.id for e in again.board.entries(TARGET)] == ["0", "1", "2"]
    run_until(lambda: len(heard) == 3, other)


def test_a_flood_is_handed_in_in_batches(join, monkeypatch):
    monkeypatch.setattr(module, "WINDOW", 50)
    one, other = join("one"), join("other")
    heard = heard_by(other)
    for n in range(3000):
        one.board.post(TARGET, target(float(n)), id=str(n % 10), source="finder", stamp_s=float(n))
    run_until(lambda: len(heard) == 3000 and not one.unacknowledged, one, other)
    assert [entry.stamp_s for entry in heard] == [float(n) for n in range(3000)]


def test_what_is_no_entry_is_counted_and_passed_over(join, address):
    one = join("one")
    with open_session(LinkParams(address=address)) as session:
        key = "ski/k2a/hypotheses/symbol/target/7"
        for payload, attachment in ((b"{}", b"x b knowledge 1"), (b"\xff", b"x b knowledge 2"), (b"{}", b"nonsense")):
            session.put(key, payload, attachment)
        run_until(lambda: sum(one.refused.values()) == 3, one)
    assert one.refused == {"message": 2, "attachment": 1}


def test_a_keeper_that_comes_back_gets_what_was_posted_meanwhile(join, keeper, tmp_path, address):
    one = join("one")
    one.board.post(BATTERY, Battery(charge_fraction=0.9), source="robot", stamp_s=1.0)
    run_until(lambda: not one.unacknowledged, one)
    keeper.stop()
    keeper.close()
    one.board.post(BATTERY, Battery(charge_fraction=0.8), source="robot", stamp_s=2.0)
    again = Keeper(LinkParams(address=address), keeper.folder, Vocabulary())
    again.open()
    thread = Thread(target=again.run)
    thread.start()
    try:
        run_until(lambda: not one.unacknowledged, one)
    finally:
        again.stop()
        thread.join()
        again.close()
    lines = (keeper.folder / "k2a" / "board.jsonl").read_text().splitlines()
    assert [line.count('"revision":2') for line in lines if "battery" in line] == [0, 1]


def test_a_keeper_that_is_gone_is_not_said_to_refuse(join, keeper, monkeypatch):
    monkeypatch.setattr(module, "LATE_AFTER_S", 0.001)
    one = join("one")
    asked = []
    ask_later = one._session.ask_later
    monkeypatch.setattr(one._session, "ask_later", lambda key, *rest: (asked.append(key), ask_later(key, *rest)))
    run_until(lambda: one.keeper_heard_s > 0, one)
    keeper.stop()
    keeper.close()
    one.board.post(BATTERY, Battery(charge_fraction=0.8), source="robot", stamp_s=2.0)
    run_until(lambda: sum("@late" in key for key in asked) > 2 * module.NOT_TAKEN, one)
    assert one.trouble == ""


def test_without_a_keeper_there_is_one_line(address):
    with pytest.raises(LinkError, match="no keeper answers"):
        open_session(LinkParams(address=address))


def test_a_router_without_a_keeper_is_told(address):
    from blackboard.link.session import open_router

    with open_router(LinkParams(address=address)), open_session(LinkParams(address=address)) as session:
        lonely = Replica(session, Vocabulary(), "k2a", "one")
        with pytest.raises(LinkError, match="no keeper answers for the board of 'k2a'"):
            lonely.join(timeout_s=0.1)


def test_nothing_that_waited_ends_up_under_another_key(join, address):
    """Who may post targets posts one that says it is a velocity, numbered so that it must wait for others before it."""
    one, other = join("one"), join("other")
    heard, forged = heard_by(one), heard_by(one, VELOCITY)
    velocity = Velocity(forward_mps=0.5, turn_radps=0.0, valid_until_s=9.0)
    line = b'{"key":"ski/k2a/commands/velocity","revision":1,"event":"posted","stamp_s":0.0,"source":"c","value":%s}'
    payload = line % msgspec.json.encode(velocity)
    with open_session(LinkParams(address=address)) as session:
        session.put("ski/k2a/hypotheses/symbol/target/7", payload, b"x b knowledge 2")
        session.put("ski/k2a/hypotheses/symbol/target/7", payload, b"x b knowledge 1")
        run_until(lambda: one.refused.get("message", 0) == 2, one)
    other.board.post(TARGET, target(), id="1", source="finder")
    run_until(lambda: len(heard) == 1, one, other)
    assert forged == []


def test_nobody_takes_a_number_in_a_lane_where_the_key_does_not_belong(join, address):
    one, other = join("one"), join("other")
    heard = heard_by(one, BATTERY)
    origin = f"other {other.boot} signal 1".encode()
    with open_session(LinkParams(address=address)) as session:
        for key in ("ski/k2a/hypotheses/symbol/target/7", "ski/k2a/hypotheses/symbol/unheard_of/7"):
            session.put(key, b'{"key":"%s","value":0}' % key.encode(), origin)
        run_until(lambda: one.refused.get("message", 0) == 2, one)
    other.board.post(BATTERY, Battery(charge_fraction=0.5), source="robot", stamp_s=1.0)
    run_until(lambda: len(heard) == 1 and not other.unacknowledged, one, other)
