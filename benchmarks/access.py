"""What keys cost: the router's processor time for a post, without keys, with them, and with counting what is rejected.

python benchmarks/access.py [--posts N] [--readers N]

A router in a process of its own passes posts of 300 bytes on to some readers; the poster keeps to a pace that loses none. Processor
time, not wall time: it does not depend on what else the machine does. The last row has a viewer that posts all the time, of
which everything is rejected.
"""

import argparse
import datetime
import json
import socket
import sys
import time
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event
from typing import Any

from blackboard.keys import folder
from blackboard.keys.rejections import Rejections
from blackboard.link.session import LinkParams, open_router, open_session

KEY = "ski/k2a/hypotheses/symbol/corner/1"
PACE_HZ = 4000
MODES = ("no keys", "keys", "keys, counting", "keys, counting, a viewer posts")


def route(pipe: Connection, params: LinkParams, counting: bool) -> None:
    """Be the router; tell how much processor time passes between two words from the other side."""
    rejections = Rejections()
    if counting:
        rejections.start()
    with open_router(params) as session:
        session.subscribe("ski/**", lambda arrived: None)
        pipe.send("ready")
        pipe.recv()
        begun_s = time.process_time()
        pipe.recv()
        used_s = time.process_time() - begun_s
    rejections.close()
    pipe.send((used_s, rejections.counts()))


def read(pipe: Connection, params: LinkParams, posts: int) -> None:
    """Be a reader until all posts have come; tell how many did."""
    came, done = [0], Event()

    def take(_: object) -> None:
        came[0] += 1
        if came[0] >= posts:
            done.set()

    with open_session(params) as session:
        session.subscribe(KEY, take)
        session.ask("ski/k2a/@keeper/clock", timeout_s=0.5)  # by then the subscription stands
        pipe.send("ready")
        done.wait(10.0 + posts / PACE_HZ)
        pipe.send(came[0])


def post_without_rights(pipe: Connection, params: LinkParams) -> None:
    """Be a viewer who posts, until told to stop."""
    with open_session(params) as session:
        pipe.send("ready")
        while not pipe.poll():
            session.put("ski/k2a/motivations/motivation/wander", bytes(300))


def measure(mode: str, keys: Path, posts: int, readers: int) -> dict[str, object]:
    """Return the router's processor time for a post in microseconds, the share that arrived, and what was rejected."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{free.getsockname()[1]}"
    secured = mode != MODES[0]

    def link(name: str) -> LinkParams:
        return LinkParams(address=address, keys=keys / "members" / name if secured else None)

    context = get_context("spawn")
    pipes, processes = [], []
    router = LinkParams(address=address, keys=keys if secured else None)
    jobs: list[tuple[Any, tuple[Any, ...]]] = [
        (route, (router, "counting" in mode)),
        *[(read, (link("eve"), posts))] * readers,
    ]
    if "viewer" in mode:
        jobs.append((post_without_rights, (link("eve"),)))
    try:
        for job, arguments in jobs:
            here, there = context.Pipe()
            process = context.Process(target=job, args=(there, *arguments))
            process.start()
            processes.append(process)
            pipes.append(here)
            here.recv()
        with open_session(link("mapper")) as session:
            pipes[0].send("begin")
            begun_s = time.monotonic()
            for n in range(posts):
                if n % 20 == 0:
                    time.sleep(max(0.0, begun_s + n / PACE_HZ - time.monotonic()))
                session.put(KEY, bytes(300))
            came = [pipe.recv() for pipe in pipes[1 : readers + 1]]
            pipes[0].send("end")
            used_s, counts = pipes[0].recv()
        if "viewer" in mode:
            pipes[-1].send("stop")
        return {
            "mode": mode,
            "router_us": round(1e6 * used_s / posts, 1),
            "arrived": round(sum(came) / (posts * readers), 4),
            "rejected": sum(counts.values()),
        }
    finally:
        for process in processes:
            process.join(5.0)
            process.kill()


def main() -> None:
    """Measure all modes, and print a line each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--posts", type=int, default=20_000)
    parser.add_argument("--readers", type=int, default=3)
    options = parser.parse_args()
    with TemporaryDirectory() as temporary:
        keys = Path(temporary) / "keys"
        now = datetime.datetime.now(datetime.UTC)
        folder.create(keys, ["localhost"], now)
        folder.add(keys, ["viewer"], "eve", now)
        folder.add(keys, ["knowledge"], "mapper", now)
        for mode in MODES:
            sys.stdout.write(json.dumps(measure(mode, keys, options.posts, options.readers)) + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
