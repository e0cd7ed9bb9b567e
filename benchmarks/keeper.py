"""What the board keeper takes in a second, how long a late joiner waits, and what a slow reader costs the others.

python benchmarks/keeper.py [--posts N]

Each figure beside bare zenoh in the same run: one router in Python, the same payloads, nobody who checks, journals or answers for
what was lost. The keeper is a process of its own (`ski board serve`), and so is every poster and reader.
"""

import argparse
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from queue import Empty, SimpleQueue
from tempfile import TemporaryDirectory
from typing import Any

import msgspec

from blackboard.entry import Entry
from blackboard.journal import line_of
from blackboard.kinds import ODOM_FROM_ROBOT, TARGET
from blackboard.link.envelope import KeeperBeat, Origin, attachment_of
from blackboard.link.replica import Replica
from blackboard.link.session import Arrived, LinkParams, Session, open_router, open_session
from blackboard.messages.geometry import Point, Pose
from blackboard.messages.symbols import Target
from blackboard.vocabulary import Vocabulary

ROBOT = "bench"
KEY = f"ski/{ROBOT}/{ODOM_FROM_ROBOT.path}"
BARE = "bare/posts"
WINDOW = 2000  # posts on the way at once
MEMBERS = 10_000
READERS = 5
SLOW_S = 0.005
STALLED_S = 0.3  # without progress: something was dropped on the way
GIVE_UP_S = 100.0
SETTLE_S = 3.0  # what is on its way without anybody's word for it


def payload(number: int) -> bytes:
    """Return a small entry as it travels."""
    value = Pose(x_m=number * 0.001, y_m=1.5, heading_rad=0.25)
    entry = Entry(
        key=KEY, id=None, revision=number, event="revised", stamp_s=number * 0.001, source="poster", value=value
    )
    return line_of(entry, msgspec.json.encode(value))


@contextmanager
def router(port: int) -> Iterator[LinkParams]:
    """Run a bare router."""
    with process(_router, port):
        yield LinkParams(address=f"tcp/127.0.0.1:{port}")


@contextmanager
def keeper(port: int, folder: Path) -> Iterator[LinkParams]:
    """Run the keeper."""
    link = LinkParams(address=f"tcp/127.0.0.1:{port}")
    command = [sys.executable, "-m", "blackboard.command.main", "board", "serve", "--listen", link.address]
    serving = subprocess.Popen([*command, "--out", str(folder)], stdout=subprocess.PIPE, text=True)
    try:
        assert serving.stdout is not None
        while not serving.stdout.readline().startswith("listening"):
            pass
        yield link
    finally:
        serving.terminate()
        serving.wait()


@contextmanager
def process(role: Callable[..., None], *arguments: object) -> Iterator[Connection]:
    """Run a role in a process of its own; it says when it is ready."""
    context = get_context("spawn")
    here, there = context.Pipe()
    running = context.Process(target=role, args=(there, *arguments))
    running.start()
    here.recv()
    try:
        yield here
    finally:
        if running.is_alive():
            running.join(0.5)
            running.kill()
        running.join()


def _router(pipe: Connection, port: int) -> None:
    with open_router(LinkParams(address=f"tcp/127.0.0.1:{port}")):
        pipe.send("ready")
        pipe.recv()


def bare_poster(pipe: Connection, link: LinkParams, posts: int) -> None:
    """Post as fast as it goes, a window at a time, acknowledged by the reader."""
    with open_session(link) as session:
        heard: SimpleQueue[int] = SimpleQueue()
        session.subscribe("bare/beat", lambda arrived: heard.put(int(arrived.payload)))
        payloads = [payload(n) for n in range(1, posts + 1)]
        pipe.send("ready")
        pipe.recv()
        pipe.send(_post(session, BARE, payloads, heard))


def bare_reader(pipe: Connection, link: LinkParams) -> None:
    """Count what comes and say how far it has come, like the keeper's beat; no more than that."""
    with open_session(link) as session:
        come: SimpleQueue[int] = SimpleQueue()
        session.subscribe(BARE, lambda arrived: come.put(int(arrived.attachment.rsplit(b" ", 1)[1])))
        pipe.send("ready")
        up_to = told = 0
        while not pipe.poll():
            try:
                number = come.get(timeout=0.2)
            except Empty:
                session.put("bare/beat", str(up_to).encode())
                continue
            up_to = number if number == up_to + 1 else up_to
            if up_to - told >= WINDOW // 4:
                told = up_to
                session.put("bare/beat", str(up_to).encode())


def keeper_poster(pipe: Connection, link: LinkParams, posts: int) -> None:
    """Post as fast as it goes, a window at a time, acknowledged by the keeper."""
    with open_session(link) as session:
        heard: SimpleQueue[int] = SimpleQueue()

        def told(beat: KeeperBeat) -> None:
            heard.put(beat.lanes.get("poster", {}).get("b", {}).get("knowledge", 0))

        session.subscribe(f"ski/{ROBOT}/@keeper/beat", lambda a: told(msgspec.json.decode(a.payload, type=KeeperBeat)))
        payloads = [payload(n) for n in range(1, posts + 1)]
        pipe.send("ready")
        pipe.recv()
        pipe.send(_post(session, KEY, payloads, heard))


def _post(session: Session, key: str, payloads: list[bytes], heard: "SimpleQueue[int]") -> tuple[float, int]:
    """Return how long it takes until all is acknowledged, and how many had to be sent again."""
    attachments = [attachment_of(Origin("poster", "b", "knowledge", n)) for n in range(1, len(payloads) + 1)]
    started = moved_s = time.perf_counter()
    sent = acknowledged = again = 0
    while acknowledged < len(payloads):
        while sent < len(payloads) and sent - acknowledged < WINDOW:
            session.put(key, payloads[sent], attachments[sent], "knowledge")
            sent += 1
        with suppress(Empty):
            told = heard.get(timeout=STALLED_S)
            if told > acknowledged:
                acknowledged, moved_s = told, time.perf_counter()
        if time.perf_counter() - moved_s > STALLED_S:
            again += sent - acknowledged
            sent, moved_s = acknowledged, time.perf_counter()
    return time.perf_counter() - started, again


def rates(posts: int, port: int, folder: Path) -> None:
    """Print posts a second, bare and through the keeper."""
    with router(port) as link, process(bare_reader, link), process(bare_poster, link, posts) as poster:
        poster.send("go")
        bare_s, bare_again = poster.recv()
    with keeper(port + 1, folder) as link, process(keeper_poster, link, posts) as poster:
        poster.send("go")
        kept_s, again = poster.recv()
    print(
        f"posts a second: bare {posts / bare_s:.0f} ({bare_again} sent again), "
        f"checked and journalled {posts / kept_s:.0f} ({again} sent again), ratio {kept_s / bare_s:.2f}"
    )


def late_joiner(port: int, folder: Path) -> None:
    """Print how long it takes to have a board of 10,000 entries."""
    with keeper(port, folder) as link, open_session(link) as session:
        poster = Replica(session, Vocabulary(), ROBOT, "poster")
        poster.join(begin_s=0.0)
        for number in range(MEMBERS):
            place = Point(x_m=number * 0.01, y_m=0.5)
            poster.board.post(
                TARGET,
                Target(place=place, stand=place, reason="frontier", size_m=1.0),
                source="poster",
                id=f"t{number}",
            )
        _settle(poster)
        asked_s, joined_s, size = [], [], 0
        for joiner in range(5):
            started = time.perf_counter()
            size = len(session.ask(f"ski/{ROBOT}/@keeper/snapshot")[0].payload)
            asked_s.append(time.perf_counter() - started)
            started = time.perf_counter()
            replica = Replica(session, Vocabulary(), ROBOT, f"joiner{joiner}")
            replica.join()
            joined_s.append(time.perf_counter() - started)
            assert len(replica.board.entries(TARGET)) == MEMBERS
    with router(port + 1) as link, open_session(link) as session, process(_answerer, link, size):
        bare_s: list[float] = []
        while len(bare_s) < 5:
            started = time.perf_counter()
            if session.ask("bare/board"):  # else the router has not heard yet that somebody answers
                bare_s.append(time.perf_counter() - started)
    asked, joined, bare = (sorted(times)[2] for times in (asked_s, joined_s, bare_s))
    print(
        f"late joiner, {MEMBERS} entries ({size / 1e6:.1f} MB): bare answer {bare * 1e3:.0f} ms, "
        f"keeper's {asked * 1e3:.0f} ms (ratio {asked / bare:.1f}), on the replica after {joined * 1e3:.0f} ms"
    )


def _answerer(pipe: Connection, link: LinkParams, size: int) -> None:
    with open_session(link) as session:
        questions: SimpleQueue[Any] = SimpleQueue()
        session.serve("bare/board", questions.put)
        pipe.send("ready")
        while True:
            question = questions.get()
            question.reply(question.key, b"x" * size)
            question.finish()


def bare_counter(pipe: Connection, link: LinkParams, pause_s: float) -> None:
    """Count what comes, and send it when asked."""
    with open_session(link) as session:
        come: SimpleQueue[int] = SimpleQueue()

        def note(arrived: Arrived) -> None:
            come.put(1)
            if pause_s:
                time.sleep(pause_s)

        session.subscribe(BARE, note)
        pipe.send("ready")
        pipe.recv()
        pipe.send(come.qsize())


def bare_flood(pipe: Connection, link: LinkParams, posts: int) -> None:
    """Post as fast as it goes, and never look back."""
    with open_session(link) as session:
        payloads = [payload(n) for n in range(1, posts + 1)]
        pipe.send("ready")
        pipe.recv()
        started = time.perf_counter()
        for each in payloads:
            session.put(BARE, each, b"poster b knowledge 1", "knowledge")
        pipe.send(time.perf_counter() - started)
        time.sleep(SETTLE_S)


def bare_slow_reader(posts: int, port: int) -> None:
    """Print what four readers get of bare zenoh while a fifth is slow."""
    with router(port) as link, ExitStack() as running:
        counters = [
            running.enter_context(process(bare_counter, link, SLOW_S if i == 0 else 0.0)) for i in range(READERS)
        ]
        with process(bare_flood, link, posts) as poster:
            poster.send("go")
            posted_s = poster.recv()
            time.sleep(SETTLE_S)
            for each in counters:
                each.send("enough")
            come = [each.recv() for each in counters]
    lost = sum(posts - c for c in come[1:])
    print(
        f"bare zenoh, {posts} posts to {READERS} readers, one of them slow: posted in {posted_s:.1f} s, "
        f"{lost} lost to the other four"
    )


def reader(pipe: Connection, link: LinkParams, posts: int, pause_s: float) -> None:
    """Read with a replica, and send how many came, how many could not be had, and the longest time between two."""
    with open_session(link) as session:
        replica = Replica(session, Vocabulary(), ROBOT, f"reader-{time.monotonic_ns()}")
        replica.join()
        come, last_s, gap_s = 0, 0.0, 0.0

        def note(entry: Entry[Any]) -> None:
            nonlocal come, last_s, gap_s
            now_s = time.perf_counter()
            if come:
                gap_s = max(gap_s, now_s - last_s)
            come, last_s = come + 1, now_s
            if pause_s:
                time.sleep(pause_s)

        replica.board.subscribe(KEY, note)
        pipe.send("ready")
        tended_s = 0.0
        while come < posts and not pipe.poll():
            with suppress(Empty):
                replica.handle(replica.queue.get(timeout=0.1))
            if time.perf_counter() - tended_s > 0.2:
                tended_s = time.perf_counter()
                replica.tend()
        pipe.send((come, replica._inbox.skipped, gap_s))


def replica_poster(pipe: Connection, link: LinkParams, posts: int, state: Path) -> None:
    """Post with a replica, outbox on disk, as fast as it goes; send how long it took until all was acknowledged."""
    with open_session(link) as session:
        replica = Replica(session, Vocabulary(), ROBOT, "poster", state=state)
        replica.join(begin_s=0.0)
        pipe.send("ready")
        pipe.recv()
        started = time.perf_counter()
        for number in range(1, posts + 1):
            value = Pose(x_m=number * 0.001, y_m=1.5, heading_rad=0.25)
            replica.board.post(ODOM_FROM_ROBOT, value, source="poster", stamp_s=number * 0.001)
            if number % 100 == 0:
                _handle_all(replica)
                replica.tend()
        posted_s = time.perf_counter() - started
        _settle(replica)
        pipe.send((posted_s, time.perf_counter() - started))
        replica.close()


def _settle(replica: Replica) -> None:
    """Go on until the keeper has acknowledged everything."""
    while replica.unacknowledged:
        with suppress(Empty):
            replica.handle(replica.queue.get(timeout=0.05))
        replica.tend()


def _handle_all(replica: Replica) -> None:
    while True:
        try:
            replica.handle(replica.queue.get_nowait())
        except Empty:
            return


def slow_reader(posts: int, port: int, folder: Path) -> None:
    """Print what four readers get while a fifth is slow."""
    with keeper(port, folder) as link, ExitStack() as running:
        readers = [
            running.enter_context(process(reader, link, posts, SLOW_S if i == 0 else 0.0)) for i in range(READERS)
        ]
        with process(replica_poster, link, posts, folder / "state") as poster:
            poster.send("go")
            posted_s, acknowledged_s = poster.recv()
            told = [each.recv() if each.poll(GIVE_UP_S) else (0, posts, GIVE_UP_S) for each in readers[1:]]
        readers[0].send("enough")
        slow = readers[0].recv() if readers[0].poll(10.0) else (0, 0, 0.0)
    lost = sum(posts - come for come, _, _ in told)
    print(
        f"{posts} posts to {READERS} readers, one of them slow: posted in {posted_s:.1f} s, acknowledged after "
        f"{acknowledged_s:.1f} s, {lost} lost to the other four, longest gap {max(t[2] for t in told):.2f} s; "
        f"the slow one had {slow[0]} by then and {slow[1]} could not be had"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--posts", type=int, default=100_000)
    parser.add_argument("--port", type=int, default=7520, help="the first of ten")
    parser.add_argument("--only", choices=("rates", "late", "slow"))
    options = parser.parse_args()
    with TemporaryDirectory() as folder:
        if options.only in (None, "rates"):
            rates(options.posts, options.port, Path(folder) / "rates")
        if options.only in (None, "late"):
            late_joiner(options.port + 2, Path(folder) / "late")
        if options.only in (None, "slow"):
            bare_slow_reader(options.posts, options.port + 5)
            slow_reader(options.posts, options.port + 4, Path(folder) / "slow")


if __name__ == "__main__":
    main()
