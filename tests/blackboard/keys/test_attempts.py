"""What nobody may do on a board with keys: each attempt is rejected and counted, and what it resembles succeeds.

Of twelve kinds of attempt these are: posting as a viewer, deleting, wildcards, forged history, forged snapshots, forged liveliness,
oversized payloads. The others are in test_connections.py.
"""

import queue
import threading

import pytest

from blackboard.link.configuration import MAX_PAYLOAD_BYTES

zenoh = pytest.importorskip("zenoh")

PATIENCE_S = 20.0
MOTIVATION = "ski/k2a/motivations/motivation/wander"
SCAN = "ski/k2a/observations/signal/laser_scan"
CORNER = "ski/k2a/hypotheses/symbol/corner/1"


@pytest.mark.parametrize(
    ("name", "key", "may"),
    [
        ("eve", MOTIVATION, "planner"),
        ("eve", "ski/k2a/@hosts/robot/beat", "k2a"),
        ("eve", "ski/k2a/@keeper/beat", None),
        ("eve", "ski/@agents/barn/report", "barn"),
        ("planner", CORNER, "mapper"),
        ("planner", "ski/k2a/control/agenda", "mapper"),
        ("planner", "ski/k2a/commands/velocity", "olga"),
        ("olga", "ski/k2a/commands/drive", "k2a"),
        ("olga", SCAN, "k2a"),
        ("olga", "ski/k2a/status/robot", "k2a"),
        ("k2a", "ski/other/observations/signal/laser_scan", None),
        ("k2a", CORNER, "mapper"),
        ("k2a", "ski/other/@hosts/robot/beat", None),
        ("mapper", SCAN, "k2a"),
        ("mapper", "ski/k2a/@hosts/robot/beat", "k2a"),
        ("mapper", MOTIVATION, "planner"),
        ("mapper", "ski/k2a/status/host/robot", None),
        ("barn", "ski/@agents/shed/report", "olga"),
        ("barn", "ski/@manager/1/beat", "olga"),
    ],
)
def test_nobody_posts_beyond_the_own_role(router, name, key, may):
    with router.open(name) as session:
        router.try_put(name, key, session)
    if may is not None:
        router.put(may, key)


def test_revoked_keys_post_nothing(router):
    with router.open("gone") as session:
        router.try_put("gone", "ski/gone/observations/signal/laser_scan", session)
    router.put("k2a", SCAN)


def test_renewed_keys_replace_those_before(router):
    with router.open("before") as session:
        router.try_put("mapper", CORNER, session)
    router.put("mapper", CORNER)


@pytest.mark.parametrize("name", ["eve", "k2a", "olga"])
def test_nobody_deletes(router, name):
    key = f"ski/k2a/status/component/{name}"
    with router.open(name) as session:
        session.delete(key)
        router.wait("rejected", "delete", name, key)
    assert not router.said("arrived", key)
    router.put("k2a", key)


@pytest.mark.parametrize(
    ("name", "key"), [("eve", "ski/**"), ("k2a", "ski/*/observations/signal/**"), ("planner", "ski/k2a/status/*")]
)
def test_a_wildcard_reaches_nothing_beyond_the_own_role(router, name, key):
    with router.open(name) as session:
        router.try_put(name, key, session)
    router.put("k2a", SCAN)


@pytest.mark.parametrize(
    ("name", "key", "may"),
    [
        ("eve", "ski/k2a/@late/motivations/motivation", "planner"),
        ("planner", "ski/k2a/@late/hypotheses/symbol", "mapper"),
        ("planner", "ski/k2a/@late/status/robot", "k2a"),
        ("mapper", "ski/k2a/@late/observations/signal", "k2a"),
        ("olga", "ski/k2a/@late/observations/signal", "k2a"),
        ("eve", "ski/k2a/@keeper/begin", "k2a"),
        ("olga", "ski/other/@keeper/begin", None),
    ],
)
def test_history_is_handed_in_by_those_who_may_post_it_and_clocks_begun_by_robots(router, name, key, may):
    with router.open(name) as session:
        answers = session.get(key, payload=b"forged")
        router.wait("rejected", "question", name, key)
        assert [answer for answer in answers if answer.ok is not None] == []
    assert ["asked", key] not in router.told
    if may is None:
        return
    with router.open(may) as session:
        assert [answer.ok.payload.to_bytes() for answer in session.get(key)] == [b"the keeper's word"]
    router.wait("asked", key)
    router.told.remove(["asked", key])


@pytest.mark.parametrize("name", ["eve", "olga", "k2a"])
@pytest.mark.parametrize(
    "key", ["ski/k2a/@keeper/snapshot", "ski/k2a/@keeper/lost", "ski/k2a/@keeper/clock", "ski/k2a/status/robot"]
)
def test_only_the_keeper_answers_for_the_board(router, name, key):
    with router.open(name) as session, router.open("mapper") as reader:
        session.declare_queryable(key, lambda query: query.reply(key, b"forged"), complete=True)
        router.wait("rejected", "offer to answer", name, key)
        answers = list(reader.get(key, target=zenoh.QueryTarget.ALL, consolidation=zenoh.ConsolidationMode.NONE))
    assert [answer.ok.payload.to_bytes() for answer in answers if answer.ok is not None] == [b"the keeper's word"]


def test_nobody_offers_a_history_of_zenohs_own(router):
    key = "ski/k2a/observations/signal/laser_scan/@adv/pub/1/2/_"
    with router.open("k2a") as session:
        session.declare_queryable(key, lambda query: None)
        router.wait("rejected", "offer to answer", "k2a", key)


def test_an_executor_obeys_an_operator_and_tells_everybody_how_it_fares(router):
    key, state = "ski/@agents/barn/order", "ski/@agents/barn/state"
    asked: queue.Queue[object] = queue.Queue()

    def answer() -> None:
        for _ in range(2):
            question = asked.get(timeout=PATIENCE_S)
            question.reply(question.key_expr, question.payload.to_bytes())
            question.drop()

    with router.open("barn") as session, router.open("eve") as viewer, router.open("olga") as operator:
        session.declare_queryable(key, asked.put)
        session.declare_queryable(state, asked.put)
        session.put("ski/@agents/barn/report", b"ready to answer")
        router.wait("arrived", "ski/@agents/barn/report", "ready to answer")
        thread = threading.Thread(target=answer)
        thread.start()
        refused = viewer.get(key, payload=b"forged")
        router.wait("rejected", "question", "eve", key)
        assert [reply for reply in refused if reply.ok is not None] == []
        assert [reply.ok.payload.to_bytes() for reply in operator.get(key, payload=b"start")] == [b"start"]
        assert [reply.ok.payload.to_bytes() for reply in viewer.get(state, payload=b"well?")] == [b"well?"]
        thread.join()
    assert asked.empty()


@pytest.mark.parametrize(
    ("name", "key", "may"),
    [
        ("eve", "ski/k2a/@hosts/robot/alive/1", "k2a"),
        ("mapper", "ski/k2a/@hosts/behaviours/alive/2", "k2a"),
        ("k2a", "ski/k2a/@hosts/mapper/alive/3", "mapper"),
        ("k2a", "ski/other/@hosts/robot/alive/4", None),
    ],
)
def test_only_the_own_hosts_are_announced(router, name, key, may):
    with router.open(name) as session:
        token = session.liveliness().declare_token(key)
        router.wait("rejected", "liveliness", name, key)
        token.undeclare()
    assert not router.said("alive", key)
    if may is not None:
        with router.open(may) as session:
            token = session.liveliness().declare_token(key)
            router.wait("alive", key, "SampleKind.PUT")
            token.undeclare()
            router.wait("alive", key, "SampleKind.DELETE")


def patient(router):
    configuration = router.configuration("k2a")
    congestion = configuration["transport"]["link"]["tx"]["queue"]["congestion_control"]
    congestion["block"]["wait_before_close"] = int(PATIENCE_S * 1e6)
    return configuration


def test_an_oversized_payload_goes_nowhere(router):
    with router.open("k2a", patient(router)) as session:
        session.put(SCAN, bytes(MAX_PAYLOAD_BYTES + 1), congestion_control=zenoh.CongestionControl.BLOCK)
        router.wait("rejected", "oversized payload", "k2a", SCAN)
        session.put(SCAN, bytes(MAX_PAYLOAD_BYTES), congestion_control=zenoh.CongestionControl.BLOCK)
        router.wait("arrived", SCAN, str(MAX_PAYLOAD_BYTES))
    assert not router.said("arrived", SCAN, str(MAX_PAYLOAD_BYTES + 1))


def test_one_too_large_to_be_put_together_goes_nowhere(router):
    with router.open("k2a", patient(router)) as session:
        session.put(SCAN, bytes(3 * MAX_PAYLOAD_BYTES), congestion_control=zenoh.CongestionControl.BLOCK)
        session.put(SCAN, b"after it", congestion_control=zenoh.CongestionControl.BLOCK)
        router.wait("arrived", SCAN, "after it")
    assert not router.said("arrived", SCAN, str(3 * MAX_PAYLOAD_BYTES))


def test_a_viewer_reads_what_others_post(router):
    with router.open("eve") as session, router.open("k2a") as robot:
        arrived: queue.Queue[str] = queue.Queue()
        session.declare_subscriber("ski/**", lambda sample: arrived.put(str(sample.key_expr)))
        answers = list(session.get("ski/k2a/@keeper/snapshot"))  # by then the subscription stands
        robot.put(SCAN, b"1")
        assert arrived.get(timeout=PATIENCE_S) == SCAN
    assert [answer.ok.payload.to_bytes() for answer in answers] == [b"the keeper's word"]


def test_what_is_handed_in_late_is_read_by_nobody(router):
    with router.open("olga") as session:
        session.declare_subscriber("ski/*/@late/**", lambda sample: None)
        router.wait("rejected", "reading", "olga", "ski/*/@late/**")


def test_good_work_is_not_counted_and_bad_is(keys, start_router):
    router = start_router(keys)
    for _ in range(3):
        router.put("k2a", SCAN)
    with router.open("mapper") as session:
        token = session.liveliness().declare_token("ski/k2a/@hosts/mapper/alive/7")
        router.wait("alive", "ski/k2a/@hosts/mapper/alive/7")
        assert len(list(session.get("ski/k2a/@late/hypotheses/symbol"))) == 1
        token.undeclare()
    with router.open("eve") as session:
        router.try_put("eve", SCAN, session)
        router.try_put("eve", MOTIVATION, session)
    assert router.close() == [{"post": 2}, {"eve": {"post": 2}}]
