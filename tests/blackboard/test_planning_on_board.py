"""The planner's place on the board: it hears of every post, and where it fails the rest goes on."""

from collections.abc import Sequence

import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import NoParams, Parts, Planner
from blackboard.entry import Entry
from blackboard.errors import BoardError, ComponentFailed
from blackboard.kinds import BATTERY, COMPONENT, MISSION, TARGET, Kind
from blackboard.messages.base import Message
from blackboard.messages.motion import MissionStatus
from blackboard.messages.sensing import Battery
from blackboard.planning import Planning
from blackboard.vocabulary import Vocabulary

VOCABULARY = Vocabulary()
PARTS = Parts(behaviours={}, levels=[], sources={}, vocabulary=VOCABULARY, owners={})


class EmptyBattery(Planner[NoParams]):
    """Gives up when the battery is empty, and breaks when it is more than full."""

    posts: Sequence[Kind[Message]] = (MISSION,)
    heard: list[str]

    def start(self, parts: Parts) -> None:
        self.heard = []

    def note(self, entry: Entry[Message]) -> None:
        self.heard.append(entry.key)

    def decide(self, board: Access) -> None:
        battery = board.newest(BATTERY)
        if battery is not None and battery.value.charge_fraction == 0.0:
            board.post(MISSION, MissionStatus(state="given up"))
        if battery is not None and battery.value.charge_fraction == 1.0:
            board.retract(TARGET, "none")


def planning(*, strict: bool = False) -> tuple[Board, Planning, EmptyBattery]:
    board = Board(VOCABULARY, robot="k2a")
    planner = EmptyBattery(NoParams(), name="rules")
    return board, Planning(board, planner, PARTS, strict=strict), planner


def test_it_hears_of_posts_and_acts() -> None:
    board, at_work, planner = planning()
    board.post(BATTERY, Battery(charge_fraction=0.0), source="robot")
    at_work.decide()
    status = board.newest(MISSION)
    assert status is not None
    assert status.source == "rules"
    assert planner.heard == [board.key(BATTERY), board.key(MISSION)]


def test_one_that_fails_is_named_and_left_out() -> None:
    board, at_work, _ = planning()
    board.post(BATTERY, Battery(charge_fraction=1.0), source="robot")
    at_work.decide()
    at_work.decide()
    [failed] = board.entries(COMPONENT)
    assert (failed.id, failed.value.state) == ("rules", "failed")
    assert "without declaring it" in failed.value.error
    board.post(BATTERY, Battery(charge_fraction=0.0), source="robot")
    at_work.decide()
    assert board.newest(MISSION) is None


def test_under_strict_it_ends_the_run() -> None:
    board, at_work, _ = planning(strict=True)
    board.post(BATTERY, Battery(charge_fraction=1.0), source="robot")
    with pytest.raises(ComponentFailed, match="rules failed"):
        at_work.decide()


def test_it_posts_only_what_it_declared() -> None:
    _, at_work, _ = planning()
    with pytest.raises(BoardError, match="without declaring it"):
        at_work._access.retract(TARGET, "none")
