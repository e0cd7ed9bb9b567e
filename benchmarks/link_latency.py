"""From a post to the activation of a knowledge source in another process, against bare zenoh, in the same run.

python benchmarks/link_latency.py [--posts N]

Both ways go through a router on loopback in a process of its own. One process posts a small value every few milliseconds, another
hears it: bare, a callback looks at the clock; as hosts do it, the value is checked, stands on the replica, and wakes a knowledge
source that looks at the clock. The two are taken by turns, since the machine's mood changes. With `--keeper` the keeper
takes part, checking and journalling what passes.
"""

import argparse
import subprocess
import sys
import time
from functools import partial
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from queue import Empty
from tempfile import TemporaryDirectory
from typing import Any

import msgspec
import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource, NoParams
from blackboard.control import Control
from blackboard.entry import Entry
from blackboard.kinds import ODOMETRY
from blackboard.link import addresses
from blackboard.link.clock import ClockAnswer
from blackboard.link.envelope import Snapshot
from blackboard.link.replica import Replica
from blackboard.link.session import LinkParams, Question, Session, open_router, open_session
from blackboard.messages.geometry import IDENTITY
from blackboard.messages.sensing import Odometry
from blackboard.vocabulary import Vocabulary

ADDRESS = "tcp/127.0.0.1:{port}"
PAUSE_S = 0.003
BARE = "ski/bench/bare"
ROUNDS = 6


class Looker(KnowledgeSource[NoParams]):
    """Looks at the clock when it is woken."""

    triggers = (ODOMETRY,)

    def __init__(self) -> None:
        super().__init__(NoParams(), name="looker")
        self.seen: list[float] = []

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        self.seen.append(time.monotonic() - trigger.stamp_s)


def router(pipe: Connection, port: int) -> None:
    """Be a router that answers just what a replica asks when it joins."""
    with open_router(LinkParams(address=ADDRESS.format(port=port))) as session:
        answers = {
            "snapshot": msgspec.json.encode(Snapshot(boot="none", now_s=0.0, lanes={})) + b"\n",
            "clock": msgspec.json.encode(ClockAnswer(now_s=0.0, wall_s=0.0)),
        }
        for what, text in answers.items():
            session.serve(addresses.keeper("bench", what), partial(_answer, text))
        pipe.send("ready")
        pipe.recv()


def _answer(text: bytes, question: Question) -> None:
    question.reply(question.key, text)
    question.finish()


def listener(pipe: Connection, port: int, host: bool) -> None:
    """Hear posts, as a host or bare, and send the times on the way back at the end."""
    with open_session(LinkParams(address=ADDRESS.format(port=port))) as session:
        seen = _listen_as_host(pipe, session) if host else _listen_bare(pipe, session)
        pipe.send(seen)


def _listen_bare(pipe: Connection, session: Session) -> list[float]:
    seen: list[float] = []
    session.subscribe(BARE, lambda arrived: seen.append(time.monotonic() - float(arrived.attachment)))
    pipe.send("ready")
    pipe.recv()
    return seen


def _listen_as_host(pipe: Connection, session: Session) -> list[float]:
    sys.setswitchinterval(0.0005)  # as `ski host` does
    replica = Replica(session, Vocabulary(), "bench", "listener")
    replica.join()
    looker = Looker()
    control = Control(replica.board, [looker])
    pipe.send("ready")
    while not pipe.poll():
        try:
            replica.handle(replica.queue.get(timeout=0.2))
        except Empty:
            continue
        if control.waiting:
            control.run_cycle()
    pipe.recv()
    return looker.seen


def poster(pipe: Connection, port: int, host: bool, posts: int) -> None:
    """Post small values, stamped with this machine's one monotonic clock."""
    with open_session(LinkParams(address=ADDRESS.format(port=port))) as session:
        value = Odometry(pose=IDENTITY, forward_mps=0.3)
        raw = msgspec.json.encode(value)
        replica = Replica(session, Vocabulary(), "bench", "poster") if host else None
        if replica is not None:
            replica.join()
        for _ in range(posts):
            time.sleep(PAUSE_S)
            if replica is not None:
                replica.board.post(ODOMETRY, value, source="poster", stamp_s=time.monotonic())
            else:
                session.put(BARE, raw, repr(time.monotonic()).encode(), "signal")
        pipe.send("done")


def way_s(host: bool, port: int, posts: int) -> "np.ndarray[Any, Any]":
    """Return the times from post to activation (or callback) of one round, s."""
    context = get_context("spawn")
    here, there = context.Pipe()
    hearing = context.Process(target=listener, args=(there, port, host))
    hearing.start()
    here.recv()
    other, pipe = context.Pipe()
    posting = context.Process(target=poster, args=(pipe, port, host, posts))
    posting.start()
    other.recv()
    here.send("enough")
    seen = here.recv()
    posting.join()
    hearing.join()
    return np.array(seen[posts // 10 :])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--posts", type=int, default=1000, help="of one round")
    parser.add_argument("--port", type=int, default=7812)
    parser.add_argument("--keeper", action="store_true", help="with the keeper itself instead of a bare router")
    options = parser.parse_args()
    context = get_context("spawn")
    with TemporaryDirectory() as folder:
        if options.keeper:
            command = [sys.executable, "-m", "blackboard.command.main", "board", "serve"]
            command += ["--connect", ADDRESS.format(port=options.port), "--out", str(Path(folder) / "keeper")]
            serving = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
            assert serving.stdout is not None
            serving.stdout.readline()
        else:
            here, there = context.Pipe()
            process = context.Process(target=router, args=(there, options.port))
            process.start()
            here.recv()
        bare: list[Any] = []
        hosts: list[Any] = []
        for _ in range(ROUNDS):
            bare.append(way_s(False, options.port, options.posts))
            hosts.append(way_s(True, options.port, options.posts))
        if options.keeper:
            serving.terminate()
            serving.wait()
        else:
            here.send("enough")
            process.join()
    one, other = np.concatenate(bare), np.concatenate(hosts)
    for percent in (50, 99):
        a, b = np.percentile(one, percent) * 1e6, np.percentile(other, percent) * 1e6
        ratios = [np.percentile(y, percent) / np.percentile(x, percent) for x, y in zip(bare, hosts, strict=True)]
        spread = f"rounds {min(ratios):.2f} to {max(ratios):.2f}"
        print(f"p{percent}: bare {a:.0f} us, post to activation {b:.0f} us, ratio {b / a:.2f} ({spread})")


if __name__ == "__main__":
    main()
