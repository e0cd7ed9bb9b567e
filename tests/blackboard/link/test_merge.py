import itertools

from hypothesis import given
from hypothesis import strategies as st

from blackboard.board import Board
from blackboard.entry import Endorsement, Entry
from blackboard.kinds import TARGET
from blackboard.link.merge import NEVER, life_of, merged
from blackboard.messages.geometry import Point
from blackboard.messages.symbols import Target
from blackboard.vocabulary import Vocabulary

KEY = "ski/k2a/hypotheses/symbol/target/1"


def said(who, stamp_s, verdict="for", why="seen"):
    return Endorsement(who=who, verdict=verdict, why=why, stamp_s=stamp_s)


def entry(revision, stamp_s, x_m=0.0, event="revised", source="a", endorsements=(), value_from=None):
    value = Target(place=Point(x_m=x_m, y_m=0.0), stand=Point(x_m=0.0, y_m=0.0), reason="frontier", size_m=1.0)
    return Entry(
        key=KEY,
        id="1",
        revision=revision,
        event=event,
        stamp_s=stamp_s,
        source=source,
        value=value,
        endorsements=endorsements,
        value_from=value_from,
    )


def test_the_later_stamp_wins_whatever_the_revision():
    old, new = entry(9, 1.0, 1.0), entry(2, 3.0, 2.0)
    assert merged(old, new).value.place.x_m == 2.0
    assert merged(new, old).value.place.x_m == 2.0
    assert merged(old, new).revision == 9


def test_an_endorsement_that_crossed_a_revision_keeps_both():
    revised = entry(6, 10.0, 2.0)
    endorsed = entry(6, 10.1, 1.0, endorsements=(said("door", 10.1),), value_from=(5, 9.0))
    for one, other in ((revised, endorsed), (endorsed, revised)):
        both = merged(one, other)
        assert both.value.place.x_m == 2.0
        assert [e.who for e in both.endorsements] == ["door"]


def test_what_was_said_before_a_retraction_is_of_an_earlier_life():
    come = entry(8, 12.0, endorsements=(said("door", 3.0), said("door", 12.0)))
    assert [e.stamp_s for e in merged(None, come, 5.0).endorsements] == [12.0]


ENTRIES = st.builds(
    entry,
    st.integers(1, 5),
    st.sampled_from([1.0, 2.0, 3.0]),
    st.sampled_from([0.0, 1.0]),
    st.sampled_from(["posted", "revised", "retracted"]),
    st.sampled_from(["a", "b"]),
    st.lists(st.builds(said, st.sampled_from(["p", "q"]), st.sampled_from([1.0, 2.0])), max_size=2, unique=True).map(
        tuple
    ),
    st.one_of(st.none(), st.tuples(st.integers(1, 3), st.sampled_from([0.5, 1.0]))),
)


def shown(entry):
    if entry is None:
        return None
    endorsements = sorted(entry.endorsements, key=repr)
    return entry.event, entry.value, entry.revision, entry.stamp_s, entry.source, endorsements


@given(st.lists(ENTRIES, min_size=1, max_size=4))
def test_any_order_and_repetition_gives_the_same(entries):
    ends = []
    for order in itertools.permutations(entries):
        known, life_s = None, NEVER
        for come in (*order, *order):
            life_s = life_of(life_s, come)
            known = merged(known, come, life_s)
        ends.append(shown(known))
    assert all(end == ends[0] for end in ends)


@given(st.lists(ENTRIES, min_size=1, max_size=4))
def test_replicas_that_hear_in_any_order_show_the_same(entries):
    ends = []
    for order in itertools.permutations(entries):
        board = Board(Vocabulary(), robot="k2a")
        for come in (*order, *order):
            board.accept(come)
        ends.append(shown(board.newest(TARGET, "1")))
    assert all(end == ends[0] for end in ends)


def test_a_replica_revises_on_from_what_it_heard():
    here, there = Board(Vocabulary(), robot="k2a"), Board(Vocabulary(), robot="k2a")
    here.outgoing = lambda kind, entry, raw: there.accept(entry)
    here.now_s = 1.0
    here.post(TARGET, entry(1, 1.0).value, id="1", source="a")
    there.now_s = 1.5
    heard = []
    there.subscribe(KEY, heard.append)
    there.endorse(KEY, who="door", verdict="for", why="seen")
    here.now_s = 2.0
    here.retract(TARGET, "1", source="a")
    here.post(TARGET, entry(1, 1.0).value, id="1", source="a")
    assert [(e.event, e.revision) for e in heard][-1] == ("posted", 3)
    assert there.newest(TARGET, "1").endorsements == ()
