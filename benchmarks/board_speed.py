"""What a post costs that triggers one knowledge source, against a plain callback in the same run.

python benchmarks/board_speed.py
"""

from time import perf_counter
from typing import Any

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import KnowledgeSource, NoParams
from blackboard.control import Control
from blackboard.entry import Entry
from blackboard.journal import JournalWriter
from blackboard.kinds import ODOM_FROM_ROBOT, ODOMETRY
from blackboard.messages.geometry import IDENTITY
from blackboard.messages.sensing import Odometry
from blackboard.vocabulary import Vocabulary

ROUNDS, POSTS = 9, 5000


class Silent(KnowledgeSource[NoParams]):
    """Is woken and posts nothing."""

    triggers = (ODOMETRY,)

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        pass


class Answering(Silent):
    """Posts an answer each time."""

    posts = (ODOM_FROM_ROBOT,)

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        board.post(ODOM_FROM_ROBOT, trigger.value.pose, supports=(trigger,))


def callback_us() -> float:
    """Return what calling a list of functions with a new object costs: publish and subscribe without a board."""
    heard: list[object] = []
    subscribers = [heard.append]
    started = perf_counter()
    for i in range(POSTS):
        value = Odometry(pose=IDENTITY, forward_mps=float(i % 10))
        for subscriber in subscribers:
            subscriber(value)
    return (perf_counter() - started) / POSTS * 1e6


def post_us(source: KnowledgeSource[NoParams] | None, journal: JournalWriter | None = None) -> float:
    """Return what a post with one activation costs, the activation's own record on the control panel included."""
    board = Board(Vocabulary())
    board.journal = journal
    control = Control(board, [source] if source is not None else [])
    started = perf_counter()
    for i in range(POSTS):
        board.now_s = i * 0.1
        board.post(ODOMETRY, Odometry(pose=IDENTITY, forward_mps=float(i % 10)), source="robot")
        control.run_cycle()
    return (perf_counter() - started) / POSTS * 1e6


def main() -> None:
    import tempfile
    from pathlib import Path
    from statistics import median

    rows: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as folder, JournalWriter(Path(folder) / "board.jsonl") as journal:
        for _ in range(ROUNDS):
            rows.setdefault("plain callback", []).append(callback_us())
            rows.setdefault("post, nobody listens", []).append(post_us(None))
            rows.setdefault("post that triggers one source", []).append(post_us(Silent(NoParams(), name="s")))
            rows.setdefault("the same, and it posts an answer", []).append(post_us(Answering(NoParams(), name="s")))
            rows.setdefault("the same, all written to board.jsonl", []).append(
                post_us(Answering(NoParams(), name="s"), journal)
            )
    base = median(rows["plain callback"])
    for name, times in rows.items():
        print(f"{name:38} {median(times):7.2f} us   {median(times) / base:6.1f} x a plain callback")


if __name__ == "__main__":
    main()
