"""Triggers, ratings, budget, failures: which knowledge source runs when."""

from collections.abc import Callable
from typing import Any

import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import KnowledgeSource, NoParams, Trigger
from blackboard.control import Control, ControlParams
from blackboard.entry import Entry
from blackboard.errors import ComponentFailed, MissionError
from blackboard.kinds import ACTIVATION, ACTIVATION_TIME, AGENDA, COMPONENT, ODOM_FROM_ROBOT, ODOMETRY, Kind
from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import Odometry
from blackboard.vocabulary import Vocabulary

Log = list[tuple[str, int]]


class Recorder(KnowledgeSource[NoParams]):
    """Notes its activations in a log, and does what it is told."""

    posts = (ODOM_FROM_ROBOT,)

    def __init__(
        self,
        name: str,
        log: Log,
        *triggers: Trigger[Any] | Kind[Any],
        rating: float = 0.0,
        work: int = 1,
        act: Callable[[Entry[Any], Access], object] | None = None,
        finish: Callable[[Access], object] | None = None,
    ) -> None:
        super().__init__(NoParams(), name=name)
        self.triggers = triggers or (ODOMETRY,)
        self.rating, self.work = rating, work
        self._log, self._act, self._finish = log, act, finish

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        self._log.append((self.name, trigger.revision))
        if self._act is not None:
            self._act(trigger, board)

    def finish(self, board: Access) -> None:
        if self._finish is not None:
            self._finish(board)


def post(board: Board, stamp_s: float = 0.0, forward_mps: float = 0.0) -> None:
    board.now_s = stamp_s
    board.post(ODOMETRY, Odometry(pose=IDENTITY, forward_mps=forward_mps), source="robot")


def test_the_highest_rating_goes_first_and_the_oldest_among_equals() -> None:
    board, log = Board(Vocabulary()), Log()
    sources = [Recorder("low", log, rating=1), Recorder("high", log, rating=9), Recorder("also_low", log, rating=1)]
    control = Control(board, sources)
    post(board)
    post(board)
    control.run_cycle()
    assert log == [("high", 1), ("high", 2), ("low", 1), ("also_low", 1), ("low", 2), ("also_low", 2)]


def test_a_burst_waits_for_the_next_cycle() -> None:
    board, log = Board(Vocabulary()), Log()
    control = Control(
        board,
        [Recorder("heavy", log, rating=1, work=6), Recorder("light", log, rating=9)],
        ControlParams(work_per_cycle=8),
    )
    for _ in range(3):
        post(board)
    assert control.run_cycle() == 3  # three light ones; a heavy one would exceed 8
    agenda = board.newest(AGENDA)
    assert agenda is not None
    assert [(w.source, w.records) for w in agenda.value.waiting] == [("heavy", 3)]
    assert control.run_cycle() == 6
    post(board)
    assert control.run_cycle() == 7  # light again first, then one heavy: 1 + 6
    assert log[3:] == [("heavy", 1), ("light", 4), ("heavy", 2)]
    control.run_cycle()
    control.run_cycle()
    assert control.waiting == 0
    agenda = board.newest(AGENDA)
    assert agenda is not None
    assert agenda.value.waiting == ()


def test_the_first_record_runs_however_heavy() -> None:
    board, log = Board(Vocabulary()), Log()
    control = Control(board, [Recorder("heavy", log, work=1000)], ControlParams(work_per_cycle=8))
    post(board)
    assert control.run_cycle() == 1000


def test_conditions_of_triggers() -> None:
    board, log = Board(Vocabulary()), Log()
    control = Control(
        board,
        [
            Recorder("third", log, Trigger(ODOMETRY, every=3)),
            Recorder("counted", log, Trigger(ODOMETRY, every=10, count=lambda o: int(o.forward_mps))),
            Recorder("calm", log, Trigger(ODOMETRY, min_interval_s=1.0)),
            Recorder("fast", log, Trigger(ODOMETRY, when=lambda e: e.value.forward_mps > 4)),
        ],
    )
    for i in range(1, 8):
        post(board, stamp_s=0.3 * i, forward_mps=float(i))
        control.run_cycle()
    by_name = {name: [r for n, r in log if n == name] for name, _ in log}
    assert by_name == {"third": [3, 6], "counted": [4, 6], "calm": [1, 5], "fast": [5, 6, 7]}


def test_a_source_that_raises_is_named_shown_and_left_out() -> None:
    def fail(trigger: Entry[Any], board: Access) -> None:
        raise ZeroDivisionError("division by zero")

    board, log = Board(Vocabulary()), Log()
    control = Control(board, [Recorder("bad", log, rating=2, act=fail), Recorder("good", log)])
    for _ in range(3):
        post(board)
        control.run_cycle()
    assert log == [("bad", 1), ("good", 1), ("good", 2), ("good", 3)]
    status = board.newest(COMPONENT, "bad")
    assert status is not None
    assert (status.value.state, status.value.error) == ("failed", "ZeroDivisionError: division by zero")
    assert (status.value.trigger_key, status.value.trigger_revision) == ("ski/robot/observations/signal/odometry", 1)
    activation = board.newest(ACTIVATION, "bad")
    assert activation is not None
    assert activation.value.outcome == "failed"

    strict = Control(Board(Vocabulary()), [], strict=True)
    assert strict.waiting == 0
    board = Board(Vocabulary())
    control = Control(board, [Recorder("bad", log, act=fail)], strict=True)
    post(board)
    with pytest.raises(ComponentFailed, match=r"bad failed on ski/robot/.*odometry revision 1: ZeroDivisionError"):
        control.run_cycle()


def test_an_unfit_post_fails_the_source_and_not_the_board() -> None:
    board, log = Board(Vocabulary()), Log()
    nan = Pose(x_m=float("nan"), y_m=0.0, heading_rad=0.0)
    control = Control(board, [Recorder("bad", log, act=lambda t, b: b.post(ODOM_FROM_ROBOT, nan))])
    post(board)
    control.run_cycle()
    status = board.newest(COMPONENT, "bad")
    assert status is not None
    assert "odom_from_robot: x_m = nan: must be finite" in status.value.error
    assert board.newest(ODOM_FROM_ROBOT) is None


def test_a_predicate_that_raises_fails_its_source_only() -> None:
    board, log = Board(Vocabulary()), Log()
    broken = Trigger(ODOMETRY, when=lambda e: 1 / 0 > 1)
    control = Control(board, [Recorder("bad", log, broken), Recorder("good", log)])
    post(board)
    control.run_cycle()
    assert log == [("good", 1)]
    assert board.newest(COMPONENT, "bad") is not None


def test_a_full_agenda_drops_the_oldest_and_counts() -> None:
    board, log = Board(Vocabulary()), Log()
    control = Control(board, [Recorder("slow", log)], ControlParams(agenda_limit=3))
    for _ in range(5):
        post(board)
    control.run_cycle()
    assert log == [("slow", 3), ("slow", 4), ("slow", 5)]
    agenda = board.newest(AGENDA)
    assert agenda is not None
    assert agenda.value.dropped == 2


def test_finishing_drains_and_lets_sources_post_what_they_hold_back() -> None:
    board, log = Board(Vocabulary()), Log()
    control = Control(
        board,
        [
            Recorder("holder", log, work=50, finish=lambda b: b.post(ODOM_FROM_ROBOT, IDENTITY)),
            Recorder("reader", log, ODOM_FROM_ROBOT),
        ],
        ControlParams(work_per_cycle=1),
    )
    post(board)
    post(board)
    control.finish()
    assert log == [("holder", 1), ("holder", 2), ("reader", 1)]
    assert control.waiting == 0


def test_sources_that_wake_each_other_cannot_hang_the_end() -> None:
    board, log = Board(Vocabulary()), Log()
    again = Recorder("again", log, ODOM_FROM_ROBOT, act=lambda t, b: b.post(ODOM_FROM_ROBOT, IDENTITY))
    control = Control(board, [again], ControlParams(work_per_cycle=10, agenda_limit=20))
    board.post(ODOM_FROM_ROBOT, IDENTITY, source="again")
    control.run_cycle()
    assert len(log) == 10
    control.finish()
    assert len(log) < 1000


def test_measured_times_stand_beside_and_are_not_recorded() -> None:
    board, log = Board(Vocabulary()), Log()
    recorded: list[str] = []
    board.journal = lambda entry, raw: recorded.append(entry.key)
    control = Control(board, [Recorder("source", log)])
    post(board)
    control.run_cycle()
    times = board.newest(ACTIVATION_TIME, "source")
    assert times is not None
    assert times.value.activations == 1
    assert "ski/robot/control/activation/source" in recorded
    assert not [key for key in recorded if "activation_time" in key]


def test_params_are_checked() -> None:
    with pytest.raises(MissionError, match="work_per_cycle = 0 is outside 1 and more"):
        ControlParams(work_per_cycle=0)
