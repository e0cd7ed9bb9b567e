"""Control and reflexes after a restart: sources, triggers, motivations and switches go on as they stand."""

from collections.abc import Mapping, Sequence
from typing import Any

import pytest

from behaviours.arbitration_network import ArbitrationNetwork
from behaviours.superposition import SuperpositionParams
from blackboard.access import Access
from blackboard.board import Board
from blackboard.checkpoint import dumped, loaded
from blackboard.component import Behaviour, KnowledgeSource, NoParams, Progress, Trigger
from blackboard.control import Control
from blackboard.entry import Entry
from blackboard.errors import CheckpointError
from blackboard.kinds import BEHAVIOUR, COMPONENT, FOCUS, MOTIVATION, ODOMETRY, RESPONSE, SWITCH, VELOCITY
from blackboard.messages.control import ComponentStatus, Focus
from blackboard.messages.geometry import IDENTITY
from blackboard.messages.motion import Motivation, Response, Switch
from blackboard.messages.sensing import Odometry, RobotDescription
from blackboard.mission import Wiring
from blackboard.reflexes import Reflexes
from blackboard.resumption import show_anew
from blackboard.vocabulary import Vocabulary

VOCABULARY = Vocabulary()
ROUND = RobotDescription(name="round", radius_m=0.3, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=0.5)


class Counter(KnowledgeSource[NoParams]):
    """Counts its activations; draws a number with each."""

    derived = ("seen",)

    def __init__(self, every: int = 1, rating: float = 1.0) -> None:
        super().__init__(NoParams(), name="counter")
        self.triggers = (Trigger(ODOMETRY, every=every),)
        self.rating = rating
        self.count = 0
        self.seen: list[int] = []
        self.drawn: list[int] = []

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        self.count += 1
        self.seen.append(trigger.revision)
        self.drawn.append(int(self.rng.integers(1000)))


def after(board: Board) -> Board:
    """Return the board that a process finds which takes the place of another."""
    there = Board(VOCABULARY, robot=board.robot)
    there.load(board.select())
    there.now_s = board.now_s
    return there


def kept(part: Control | Reflexes) -> Mapping[str, object]:
    states = loaded(dumped(part.states()), VOCABULARY, ["tests"])
    assert isinstance(states, dict)
    return states


def tell(board: Board, count: int) -> None:
    for _ in range(count):
        board.now_s += 0.1
        board.post(ODOMETRY, Odometry(pose=IDENTITY, forward_mps=0.0, turn_radps=0.0), source="robot")


def test_a_source_goes_on_from_its_state_and_its_triggers_count_on() -> None:
    board = Board(VOCABULARY)
    first, lived = Counter(every=3), Counter(every=3)
    control, other = Control(board, [first]), Control(board, [lived])
    tell(board, 5)
    control.run_cycle()
    other.run_cycle()
    there, second = after(board), Counter(every=3)
    resumed = Control(there, [second])
    resumed.resume(kept(control))
    assert second.count == 1
    for place in (board, there):
        tell(place, 1)
    resumed.run_cycle()
    other.run_cycle()
    assert (second.count, second.drawn) == (2, lived.drawn)
    assert second.seen == [6]  # what is derived is no part of the state


def test_what_waited_is_done() -> None:
    board = Board(VOCABULARY)
    control = Control(board, [Counter()])
    tell(board, 2)
    there, second = after(board), Counter()
    resumed = Control(there, [second])
    resumed.resume(kept(control))
    tell(there, 1)
    resumed.run_cycle()
    assert second.seen == [1, 2, 3]


def test_the_focus_that_stands_counts() -> None:
    board = Board(VOCABULARY)
    board.post(FOCUS, Focus(rating=5.0, enabled=False), id="counter", source="rules")
    source = Counter()
    control = Control(board, [source])
    control.resume()
    tell(board, 1)
    assert control.waiting == 0


def test_a_source_that_had_failed_works_again_and_says_so() -> None:
    board = Board(VOCABULARY)
    board.post(COMPONENT, ComponentStatus(state="failed", error="it broke"), id="counter", source="counter")
    control = Control(board, [Counter()])
    control.resume()
    status = board.newest(COMPONENT, "counter")
    assert status is not None
    assert status.value == ComponentStatus(state="running")


def test_a_state_of_another_version_is_refused_and_the_source_begins_anew() -> None:
    board, source = Board(VOCABULARY), Counter()
    with pytest.raises(CheckpointError, match="has no 'count'"):
        source.resume({"rng": source.rng, "drawn": []}, Access(board, "counter", (), ()))
    control = Control(board, [source])
    control.resume({"counter": {"rng": source.rng, "drawn": [1]}})
    status = board.newest(COMPONENT, "counter")
    assert status is not None
    assert status.value.state == "running"
    assert "begins anew: what was kept has no 'count'" in status.value.error
    assert source.drawn == []


def test_that_it_begins_anew_is_said_once() -> None:
    board = Board(VOCABULARY)
    for _ in range(3):
        show_anew(board, "counter", "it is a lock")
    assert [entry.revision for entry in board.entries(COMPONENT)] == [1]


class Goer(Behaviour[NoParams]):
    """Answers with what it was selected with, and counts how often it was selected."""

    motivated = True
    parameters = ("speed",)
    optional = 1

    def __init__(self) -> None:
        super().__init__(NoParams(), name="goer")
        self.selections: list[Sequence[float | str]] = []
        self.answers = 0

    def select(self, parameters: tuple[float | str, ...]) -> None:
        self.selections.append(parameters)
        self.answers = 0

    def respond(self, board: Access) -> Response:
        self.answers += 1
        return Response(forward=1.0, left=0.0)

    def progress(self) -> Progress:
        return Progress(outcome="underway", remaining_m=float(self.answers))

    def adjusts(self) -> Mapping[str, Switch]:
        return {"other": Switch(gain=0.5)} if self.answers < 3 else {}


class Other(Behaviour[NoParams]):
    """Never answers."""

    def __init__(self) -> None:
        super().__init__(NoParams(), name="other")

    def respond(self, board: Access) -> None:
        return None


def reflexes(board: Board) -> tuple[Reflexes, Goer]:
    goer = Goer()
    network = ArbitrationNetwork(SuperpositionParams(), name="coordinator")
    wired = [(goer, Wiring(gain=2.0, level="explore")), (Other(), Wiring())]
    return Reflexes(board, wired, network, ROUND, switches_of="rules"), goer


def motivate(board: Board, number: int, *, on: bool = True) -> None:
    value = Motivation(on=on, number=number, parameters=(0.5,) if on else ())
    board.post(MOTIVATION, value, id="goer", source="rules")


def cycle(board: Board, part: Reflexes, count: int = 1) -> None:
    for _ in range(count):
        board.now_s += 0.1
        part.respond()


def acknowledged(board: Board) -> tuple[bool, int]:
    status = board.newest(BEHAVIOUR, "goer")
    assert status is not None
    return status.value.selected, status.value.acknowledged


def test_a_motivation_that_stands_is_answered_from_the_state_that_was_kept() -> None:
    board = Board(VOCABULARY)
    before, _ = reflexes(board)
    motivate(board, 7)
    cycle(board, before, 2)
    there = after(board)
    now, goer = reflexes(there)
    now.resume(kept(before))
    cycle(there, now)
    assert (goer.selections, goer.answers) == ([(0.5,)], 3)
    assert acknowledged(there) == (True, 7)
    assert there.newest(VELOCITY) is not None


def test_without_a_state_it_is_taken_up_anew_by_the_same_number() -> None:
    board = Board(VOCABULARY)
    before, _ = reflexes(board)
    motivate(board, 7)
    cycle(board, before, 2)
    there = after(board)
    now, goer = reflexes(there)
    now.resume()
    cycle(there, now)
    assert (goer.selections, goer.answers) == ([(0.5,)], 1)
    assert acknowledged(there) == (True, 7)


@pytest.mark.parametrize("on", [True, False])
def test_one_that_came_meanwhile_is_taken_up(on: bool) -> None:
    board = Board(VOCABULARY)
    before, _ = reflexes(board)
    motivate(board, 7)
    cycle(board, before, 2)
    states = kept(before)
    motivate(board, 8, on=on)
    there = after(board)
    now, goer = reflexes(there)
    now.resume(states)
    cycle(there, now)
    assert acknowledged(there) == (on, 8)
    assert goer.answers == (1 if on else 2)
    assert (there.newest(RESPONSE, "goer") is not None) == on


def test_a_state_of_an_earlier_motivation_does_not_count() -> None:
    board = Board(VOCABULARY)
    before, _ = reflexes(board)
    motivate(board, 7)
    cycle(board, before, 2)
    states = kept(before)
    motivate(board, 8)
    cycle(board, before, 2)
    there = after(board)
    now, goer = reflexes(there)
    now.resume(states)
    cycle(there, now)
    assert (goer.selections, goer.answers) == ([(0.5,)], 1)
    assert acknowledged(there) == (True, 8)


def test_switches_stay_as_rules_have_set_them_and_go_when_nobody_wants_them() -> None:
    board = Board(VOCABULARY)
    before, _ = reflexes(board)
    motivate(board, 7)
    cycle(board, before, 2)
    board.post(SWITCH, Switch(gain=9.0, level="explore"), id="goer", source="rules")
    there = after(board)
    now, _ = reflexes(there)
    now.resume(kept(before))
    cycle(there, now)
    switch = there.newest(SWITCH, "goer")
    assert switch is not None
    assert switch.value.gain == 9.0
    assert there.newest(SWITCH, "other.goer") is None  # its third answer does not want it any more
