import msgspec
from hypothesis import given
from hypothesis import strategies as st

from blackboard.board import Board
from blackboard.entry import Endorsement, Entry
from blackboard.journal import line_of
from blackboard.keeper.standing import Standing
from blackboard.link.envelope import Origin, read_entry, read_payload
from blackboard.messages.geometry import Point
from blackboard.messages.symbols import Target
from blackboard.vocabulary import Vocabulary

VOCABULARY = Vocabulary()
KEYS = [f"ski/k2a/hypotheses/symbol/target/{i}" for i in (1, 2)]


def entry(key, revision, stamp_s, x_m, event, source, said, value_from):
    return Entry(
        key=key,
        id=key[-1],
        revision=revision,
        event=event,
        stamp_s=stamp_s,
        source=source,
        value=Target(place=Point(x_m=x_m, y_m=0.0), stand=Point(x_m=0.0, y_m=0.0), reason="frontier", size_m=1.0),
        endorsements=tuple(Endorsement(who=w, verdict="for", why="seen", stamp_s=s) for w, s in said),
        value_from=value_from,
    )


ENTRIES = st.builds(
    entry,
    st.sampled_from(KEYS),
    st.integers(1, 5),
    st.sampled_from([1.0, 2.0, 3.0]),
    st.sampled_from([0.0, 1.0]),
    st.sampled_from(["posted", "revised", "retracted"]),
    st.sampled_from(["a", "b"]),
    st.lists(st.tuples(st.sampled_from(["door", "line"]), st.sampled_from([0.5, 1.0, 2.5])), max_size=2, unique=True),
    st.one_of(st.none(), st.just((1, 1.0))),
)


def stand(entries):
    standing = Standing(VOCABULARY, 100)
    for number, come in enumerate(entries, 1):
        payload = line_of(come, msgspec.json.encode(come.value))
        standing.take(Origin("h", "b", "knowledge", number), payload, come)
    return standing


def told(payload):
    come = read_entry(VOCABULARY, read_payload(msgspec.json.decode(payload)["key"], payload))[1]
    return msgspec.structs.asdict(come)


@given(st.lists(ENTRIES, max_size=8), st.randoms())
def test_in_any_order_and_however_often_the_keeper_holds_what_every_replica_holds(entries, order):
    sent = entries * 2
    order.shuffle(sent)
    kept = {e["key"]: e for e in (told(held.payload) for held in stand(sent).entries())}
    replica = Board(VOCABULARY, robot="k2a")
    replica.outgoing = lambda *post: None
    for come in entries:
        replica.accept(come)
    assert kept == {e.key: msgspec.structs.asdict(e) for e in replica.select()}


@given(st.lists(ENTRIES, max_size=8))
def test_a_late_joiner_gets_the_same_board(entries):
    first = stand(entries)
    second = Standing(VOCABULARY, 100)
    for origin, payload in [*first.tombstones(), *first.entries()]:
        key = msgspec.json.decode(payload)["key"]
        second.take(origin, payload, read_entry(VOCABULARY, read_payload(key, payload))[1])
    assert sorted(e.payload for e in second.entries()) == sorted(e.payload for e in first.entries())


def test_what_was_retracted_does_not_come_back_and_retractions_are_bounded():
    standing = Standing(VOCABULARY, 1)
    posted = [entry(key, 1, 1.0, 0.0, "posted", "a", (), None) for key in KEYS]
    retracted = [entry(key, 2, 2.0, 0.0, "retracted", "a", (), None) for key in KEYS]
    for number, come in enumerate([posted[0], retracted[0], posted[0], posted[1], retracted[1]], 1):
        payload = line_of(come, msgspec.json.encode(come.value))
        standing.take(Origin("h", "b", "knowledge", number), payload, come)
    assert standing.entries() == []
    assert [told(e.payload)["key"] for e in standing.tombstones()] == [KEYS[1]]


def test_a_payload_is_kept_as_it_came():
    payload = b'{"stamp_s":1.0, "key":"%s","revision":1,"event":"posted","source":"a","value":{}}' % KEYS[0].encode()
    standing = Standing(VOCABULARY, 10)
    standing.take(Origin("h", "b", "knowledge", 1), payload, entry(KEYS[0], 1, 1.0, 0.0, "posted", "a", (), None))
    assert [e.payload for e in standing.entries()] == [payload]
    for expression in ("ski/**", "ski/*/hypotheses/**", KEYS[0]):
        assert [(key, e.payload) for key, e in standing.matching(expression)] == [(KEYS[0], payload)]
    for expression in ("ski/*/status/**", KEYS[1]):
        assert list(standing.matching(expression)) == []
