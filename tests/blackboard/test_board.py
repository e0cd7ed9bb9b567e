"""The life of entries: posted, revised, retracted, endorsed; read by key, kind, level, area and time; watched; kept."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.access import Access
from blackboard.board import MAX_ENDORSEMENTS, Board
from blackboard.entry import Entry, Support, stretches
from blackboard.errors import BoardError, MessageError
from blackboard.history import HistoryParams
from blackboard.kinds import COMPONENT, DRIVE, LINE, ODOM_FROM_ROBOT, ODOMETRY, RESPONSE
from blackboard.messages.control import ComponentStatus
from blackboard.messages.geometry import IDENTITY, Point, Pose
from blackboard.messages.motion import Response
from blackboard.messages.sensing import Odometry
from blackboard.messages.world import Line
from blackboard.uncertainty.endorsements import standing
from blackboard.vocabulary import Vocabulary


def board(**bounds: int) -> Board:
    return Board(Vocabulary(), robot="k2a", history=HistoryParams(**bounds))


def pose(x_m: float = 0.0) -> Pose:
    return Pose(x_m=x_m, y_m=0.0, heading_rad=0.0)


def odometry(x_m: float = 0.0) -> Odometry:
    return Odometry(pose=pose(x_m))


def line(x_m: float) -> Line:
    start, end = Point(x_m=x_m, y_m=0.0), Point(x_m=x_m, y_m=2.0)
    return Line(start=start, end=end, alpha_rad=0.0, rho_m=abs(x_m), sigma_rho_m=0.01, support=9)


def test_posted_revised_retracted() -> None:
    b = board()
    heard: list[Entry[Any]] = []
    b.subscribe("ski/*/observations/feature/line/*", heard.append)
    b.now_s = 1.0
    first = b.post(LINE, line(1.0), id="0-1", source="finder")
    b.now_s = 2.0
    second = b.post(LINE, line(2.0), id="0-1", source="finder")
    b.retract(LINE, "0-1", source="finder")
    again = b.post(LINE, line(3.0), id="0-1", source="finder")
    assert [(e.event, e.revision, e.stamp_s) for e in heard] == [
        ("posted", 1, 1.0),
        ("revised", 2, 2.0),
        ("retracted", 3, 2.0),
        ("posted", 4, 2.0),
    ]
    assert (first.key, second.value.rho_m, heard[2].value.rho_m) == ("ski/k2a/observations/feature/line/0-1", 2.0, 2.0)
    assert b.newest(LINE, "0-1") is again
    assert b.at(first.key) is again


def test_an_endless_back_and_forth_keeps_what_stands() -> None:
    board = Board(Vocabulary())
    access = Access(board, "doubter", (), (ODOMETRY,))
    entry = access.post(ODOMETRY, Odometry(pose=IDENTITY))
    access.endorse(entry, "for", "it was there first", about="age")
    for i in range(MAX_ENDORSEMENTS + 20):
        entry = access.endorse(entry, "against" if i % 2 else "for", str(i), about="mood")
    assert len(entry.endorsements) == MAX_ENDORSEMENTS
    assert [(e.about, e.why) for e in standing(entry.endorsements)] == [("age", "it was there first"), ("mood", "519")]


def test_a_slot_has_one_owner_but_anyone_may_endorse() -> None:
    b = board()
    b.post(LINE, line(1.0), id="7", source="finder")
    with pytest.raises(BoardError, match=r"belongs to finder; other may endorse it, not post it"):
        b.post(LINE, line(2.0), id="7", source="other")
    with pytest.raises(BoardError, match="belongs to finder; other may not post it"):
        b.post(LINE, line(2.0), id="8", source="other")
    with pytest.raises(BoardError, match="not retract it"):
        b.retract(LINE, "7", source="other")
    other = Access(b, "other", [LINE], [])
    entry = b.newest(LINE, "7")
    assert entry is not None
    other.endorse(entry, "against", "nothing seen there from the other side")
    b.post(LINE, line(1.1), id="7", source="finder")  # the owner's revision keeps what was said
    revised = b.newest(LINE, "7")
    assert revised is not None
    assert revised.revision == 3
    assert revised.source == "finder"
    assert [(e.who, e.verdict, e.why) for e in revised.endorsements] == [
        ("other", "against", "nothing seen there from the other side")
    ]


def test_shared_collections_have_an_owner_for_each_id() -> None:
    b = board()
    b.post(RESPONSE, Response(forward=1.0), id="avoid", source="avoid")
    b.post(RESPONSE, Response(forward=0.5), id="wander", source="wander")
    assert [e.id for e in b.entries(RESPONSE)] == ["avoid", "wander"]
    with pytest.raises(BoardError, match="belongs to avoid"):
        b.post(RESPONSE, Response(), id="avoid", source="wander")


def test_reading_by_kind_level_area_and_time() -> None:
    b = board()
    for i in range(5):
        b.now_s = float(i)
        b.post(LINE, line(float(i)), id=str(i), source="finder")
    b.post(ODOMETRY, odometry(), source="robot")
    assert [e.id for e in b.entries(LINE, area=(0.5, 1.0, 2.5, 9.0))] == ["1", "2"]
    assert [e.id for e in b.entries(LINE, since_s=1.0, until_s=3.0)] == ["1", "2", "3"]
    assert [e.id for e in b.select("**/line/*", area=(3.5, 0, 9, 1))] == ["4"]
    assert [e.key for e in b.select(level="signal")] == ["ski/k2a/observations/signal/odometry"]
    assert len(b.select(panel="observations")) == 6
    assert b.select(panel="commands") == []
    assert b.select("ski/k2a/observations/signal/*", area=(-1, -1, 1, 1)) == []  # a reading has no place on the map


def test_errors_name_the_way_out() -> None:
    b = board()
    with pytest.raises(BoardError, match="needs an id"):
        b.post(LINE, line(0.0), source="finder")
    with pytest.raises(BoardError, match="takes no id"):
        b.post(ODOMETRY, odometry(), id="1", source="robot")
    with pytest.raises(BoardError, match="id 'a/b'"):
        b.post(LINE, line(0.0), id="a/b", source="finder")
    with pytest.raises(BoardError, match="nothing stands there to be retracted"):
        b.retract(LINE, "9", source="finder")
    b.post(ODOMETRY, odometry(), source="robot", stamp_s=5.0)
    with pytest.raises(BoardError, match=r"4\.900000 s is older than the standing revision's 5\.000000 s"):
        b.post(ODOMETRY, odometry(), source="robot", stamp_s=4.9)
    with pytest.raises(BoardError, match="robot name 'a b'"):
        Board(Vocabulary(), robot="a b")


def test_a_refused_value_changes_nothing() -> None:
    b = board()
    told: list[Entry[Any]] = []
    b.subscribe("**", told.append)
    with pytest.raises(MessageError):
        b.post(ODOMETRY, odometry(float("nan")), source="robot")
    assert (b.posts, told, b.select()) == (0, [], [])
    b.post(ODOMETRY, odometry(1.0), source="robot")
    with pytest.raises(MessageError):
        b.post(ODOMETRY, odometry(1e7), source="robot")
    entry = b.newest(ODOMETRY)
    assert entry is not None
    assert (entry.revision, entry.value.pose.x_m) == (1, 1.0)


def test_access_holds_to_what_was_declared() -> None:
    access = Access(board(), "finder", [ODOMETRY], [LINE])
    with pytest.raises(BoardError, match="finder read 'commands/drive' without declaring it"):
        access.newest(DRIVE)
    with pytest.raises(BoardError, match="finder posted 'observations/signal/odometry' without declaring it"):
        access.post(ODOMETRY, odometry())
    assert access.entries(LINE) == []


def test_what_a_reflex_looked_at_becomes_its_supports() -> None:
    b = board()
    posted = b.post(ODOMETRY, odometry(), source="robot")
    access = Access(b, "avoid", [ODOMETRY, DRIVE], [])
    access.newest(ODOMETRY)
    access.newest(DRIVE)
    assert access.take_seen() == (posted,)
    assert access.take_seen() == ()


def test_around_a_stamp() -> None:
    b = board()
    for stamp in (1.0, 2.0, 3.0):
        b.post(ODOM_FROM_ROBOT, pose(stamp), source="odometry", stamp_s=stamp)

    def stamps(at_s: float) -> list[float | None]:
        return [e and e.stamp_s for e in b.around(ODOM_FROM_ROBOT, at_s)]

    assert stamps(2.5) == [2.0, 3.0]
    assert stamps(2.0) == [2.0, 3.0]
    assert stamps(0.5) == [None, 1.0]
    assert stamps(9.0) == [3.0, None]


def test_supports_of_what_stands_are_kept_down_to_the_readings() -> None:
    b = board(slot_revisions=3, member_revisions=2)
    reading = b.post(ODOMETRY, odometry(1.0), source="robot")
    derived = b.post(ODOM_FROM_ROBOT, pose(1.0), source="odometry", supports=(reading.as_support(),))
    b.post(LINE, line(1.0), id="0", source="finder", supports=(derived.as_support(),))
    for i in range(50):
        e = b.post(ODOMETRY, odometry(float(i)), source="robot")
        b.post(ODOM_FROM_ROBOT, pose(float(i)), source="odometry", supports=(e.as_support(),))
    assert b.revisions(derived.as_support()) == [derived]
    assert b.revisions(reading.as_support()) == [reading]
    assert b.revisions(Support(reading.key, 2, 2)) == []  # nothing names it any more
    b.retract(LINE, "0", source="finder")
    for i in range(2000):  # the retracted line itself is forgotten in its turn, and its supports with it
        b.post(COMPONENT, ComponentStatus(state="running"), id=f"c{i}", source="c")
        b.retract(COMPONENT, f"c{i}", source="c")
    assert b.revisions(derived.as_support()) == []
    assert b.revisions(reading.as_support()) == []


def test_the_ends_of_a_stretch_are_kept() -> None:
    b = board(slot_revisions=2)
    for i in range(10):
        b.post(ODOMETRY, odometry(float(i)), source="robot")
        if i == 5:
            key = b.key(ODOMETRY)
            b.post(LINE, line(1.0), id="0", source="finder", supports=(Support(key, 5, 6),))
    assert [e.revision for e in b.revisions(Support(key, 5, 6))] == [5, 6]


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 40)), max_size=300))
def test_memory_stays_bounded(steps: list[tuple[int, int]]) -> None:
    b = board(slot_revisions=4, member_revisions=2, pinned_limit=10, retired_limit=3)
    newest: Entry[Any] = b.post(ODOMETRY, odometry(), source="robot")
    for what, number in steps:
        name = str(number % 5)
        if what == 0:
            newest = b.post(ODOMETRY, odometry(float(number)), source="robot", supports=(newest.as_support(),))
        elif what == 1:
            support = Support(newest.key, max(1, newest.revision - number), newest.revision)
            b.post(LINE, line(1.0), id=name, source="finder", supports=(support,))
        elif what == 2 and b.newest(LINE, name) is not None:
            b.retract(LINE, name, source="finder")
    assert len(b.history) <= 4 + 10 + 5 * 2 + 3 * 2
    assert b.revisions(newest.as_support()) == [newest]


def test_stretches_join_what_follows() -> None:
    b = board()
    entries = [b.post(ODOMETRY, odometry(float(i)), source="robot") for i in range(6)]
    key = entries[0].key
    assert stretches([*entries[:3], entries[4]]) == (Support(key, 1, 3), Support(key, 5, 5))
