"""Who gets in at all on a board with keys, and that nobody goes round the keeper.

Of twelve kinds of attempt these are: no certificate, a foreign authority's, an expired one, plain TCP, a direct peer. The others
are in test_attempts.py.
"""

import contextlib
import datetime
import queue
import shutil
import socket
from pathlib import Path
from typing import Any

import pytest

from blackboard.keys import folder
from blackboard.keys.certificates import Pair, make_member

zenoh = pytest.importorskip("zenoh")

PATIENCE_S = 20.0
MOTIVATION = "ski/k2a/motivations/motivation/wander"
Configuration = dict[str, Any]


def no_certificate(configuration: Configuration, tls: Configuration, where: Path, keys: Path) -> None:
    del tls["connect_certificate"], tls["connect_private_key"]
    tls["enable_mtls"] = False


def foreign_authority(configuration: Configuration, tls: Configuration, where: Path, keys: Path) -> None:
    now = datetime.datetime.now(datetime.UTC)
    folder.create(where / "foreign", ["robot.lan"], now)
    show(tls, folder.add(where / "foreign", ["robot"], "k2a", now, robots=["k2a"]))


def expired_certificate(configuration: Configuration, tls: Configuration, where: Path, keys: Path) -> None:
    now = datetime.datetime.now(datetime.UTC)
    authority = Pair(*((keys / "authority" / name).read_bytes() for name in ("ca.pem", "key.pem")))
    pair = make_member(authority, "k2a.1", now - datetime.timedelta(days=3), 2)
    (where / "cert.pem").write_bytes(pair.certificate)
    (where / "key.pem").write_bytes(pair.key)
    show(tls, where)


def wrong_certificate(configuration: Configuration, tls: Configuration, where: Path, keys: Path) -> None:
    show(tls, keys / "keeper")


def plain_connection(configuration: Configuration, tls: Configuration, where: Path, keys: Path) -> None:
    endpoint = configuration["connect"]["endpoints"][0]
    configuration["connect"]["endpoints"] = [endpoint.replace("tls/", "tcp/")]
    configuration["transport"]["link"]["protocols"] = ["tcp"]


def show(tls: Configuration, where: Path) -> None:
    tls["connect_certificate"] = str(where / "cert.pem")
    tls["connect_private_key"] = str(where / "key.pem")


@pytest.mark.parametrize(
    "attempt", [no_certificate, foreign_authority, expired_certificate, wrong_certificate, plain_connection]
)
def test_without_good_keys_nobody_gets_in(router, tmp_path, attempt):
    configuration = router.configuration("k2a")
    router.open("k2a", configuration).close()
    attempt(configuration, configuration["transport"]["link"]["tls"], tmp_path, router.keys)
    with pytest.raises(zenoh.ZError):
        router.open("k2a", configuration)
    router.wait("rejected", attempt.__name__.replace("_", " "))


def test_a_member_cannot_pass_for_the_keeper(keys, tmp_path, start_router):
    pretended = tmp_path / "pretended"
    shutil.copytree(keys, pretended)
    honest = start_router(pretended)
    honest.open("k2a").close()
    for name in ("cert.pem", "key.pem"):
        shutil.copy(keys / "members" / "olga" / name, pretended / "keeper" / name)
    with pytest.raises(zenoh.ZError):
        start_router(pretended).open("k2a")


def test_a_keeper_is_known_by_its_name(router):
    configuration = router.configuration("k2a")
    router.open("k2a", configuration).close()
    endpoint = configuration["connect"]["endpoints"][0]
    configuration["connect"]["endpoints"] = [endpoint.replace("127.0.0.1", "127.0.0.2")]
    configuration["transport"]["link"]["tls"]["verify_name_on_connect"] = True
    with pytest.raises(zenoh.ZError):
        router.open("k2a", configuration)


def other_mode(router: Any, name: str, mode: str) -> Configuration:
    configuration = router.configuration(name)
    configuration["mode"] = mode
    configuration["scouting"]["gossip"] = {"enabled": True}
    return configuration


def test_a_direct_peer_has_no_more_rights(router):
    peers = [router.open(name, other_mode(router, name, "peer")) for name in ("eve", "planner")]
    with router.open("k2a") as reader, peers[0] as session, peers[1] as good:
        arrived: queue.Queue[str] = queue.Queue()
        reader.declare_subscriber("ski/k2a/**", lambda sample: arrived.put(sample.payload.to_string()))
        assert len(list(reader.get("ski/k2a/@keeper/clock"))) == 1  # by then the subscription stands
        router.try_put("eve", MOTIVATION, session)
        payload = router.payload()
        good.put(MOTIVATION, payload)
        router.wait("arrived", MOTIVATION, payload)
        assert arrived.get(timeout=PATIENCE_S) == payload


def test_nobody_is_a_second_router(router):
    key = "ski/k2a/@keeper/snapshot"
    with router.open("eve", other_mode(router, "eve", "router")) as session, router.open("mapper") as reader:
        session.declare_queryable(key, lambda query: query.reply(key, b"forged"), complete=True)
        session.put(MOTIVATION, b"from a router")
        router.wait("rejected", "offer to answer", "eve", key)
        answers = list(reader.get(key, target=zenoh.QueryTarget.ALL, consolidation=zenoh.ConsolidationMode.NONE))
    assert [answer.ok.payload.to_bytes() for answer in answers if answer.ok is not None] == [b"the keeper's word"]
    router.put("planner", MOTIVATION)
    assert not router.said("arrived", MOTIVATION, "from a router")


@pytest.mark.skipif(not Path("/proc/self/net/tcp").exists(), reason="listening sockets are looked up in Linux's /proc")
def test_clients_listen_nowhere(router):
    before = listening()
    with router.open("k2a"):
        assert listening() == before
        with socket.socket() as other:
            other.bind(("127.0.0.1", 0))
            other.listen()
            assert len(listening()) == len(before) + 1


def listening() -> set[str]:
    """Return the listening sockets of this process."""
    own = set()
    for descriptor in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(OSError):
            own.add(str(descriptor.readlink()))
    rows = [
        line.split() for name in ("tcp", "tcp6") for line in Path(f"/proc/self/net/{name}").read_text().splitlines()
    ]
    return {row[9] for row in rows if row[3] == "0A" and f"socket:[{row[9]}]" in own}
