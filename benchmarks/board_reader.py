"""A reader of a running board, a process of its own, for trials: notes when each message came, or reads slowly.

python benchmarks/board_reader.py ADDRESS EXPRESSION [--notes FILE] [--hold S]

A line of FILE is a time of the monotonic clock, which all processes of a machine share, and a key. With --hold each message takes
so long, on the thread that hands it over: what comes meanwhile piles up before this process.
"""

import argparse
import sys
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from queue import SimpleQueue

from blackboard.link.session import Arrived, LinkParams, open_session


def longest_gap_s(notes: Path, what: str, first_s: float, last_s: float) -> float:
    """Return the longest time without a message whose key holds `what`, of the times that reach into a stretch of time."""
    times = list(_times(notes, what))
    before = max((time_s for time_s in times if time_s <= first_s), default=first_s)
    inside = [time_s for time_s in times if first_s < time_s <= last_s]
    return max(b - a for a, b in pairwise([before, *inside, last_s]))


def _times(notes: Path, what: str) -> Iterator[float]:
    for line in notes.read_text().splitlines():
        time_s, _, key = line.partition(" ")
        if what in key:
            yield float(time_s)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("address")
    parser.add_argument("expression")
    parser.add_argument("--notes", type=Path)
    parser.add_argument("--hold", type=float, default=0.0, metavar="S")
    options = parser.parse_args()
    came: SimpleQueue[tuple[float, str]] = SimpleQueue()

    def take(arrived: Arrived) -> None:
        if options.hold > 0:
            time.sleep(options.hold)
        elif options.notes is not None:
            came.put((time.monotonic(), arrived.key))

    with open_session(LinkParams(address=options.address)) as session:
        session.subscribe(options.expression, take)
        print("reading", flush=True)
        if options.notes is None:
            sys.stdin.read()  # until the trial ends
            return
        with options.notes.open("w", buffering=1) as notes:
            while True:
                time_s, key = came.get()
                notes.write(f"{time_s:.6f} {key}\n")


if __name__ == "__main__":
    main()
