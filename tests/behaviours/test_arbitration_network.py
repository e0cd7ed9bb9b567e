from collections.abc import Callable, Mapping
from math import atan2, hypot, isfinite
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.arbitration_network import LONGEST, switch_output
from blackboard.component import Behaviour, NoParams
from blackboard.entry import Entry
from blackboard.errors import MissionError
from blackboard.kinds import BEHAVIOUR, COMPONENT, MOTIVATION, RESPONSE, SWITCH, VELOCITY
from blackboard.messages.motion import Motivation, Response, Switch, Velocity
from blackboard.mission import load_mission
from blackboard.runner import Run, RunOptions

parts = st.floats(-100.0, 100.0)
gains = st.floats(0.0, 100.0)
thresholds = st.floats(0.0, 1000.0)


@pytest.mark.parametrize(
    ("gain", "threshold", "length", "passes"),
    [
        (1.0, 0.0, 0.8, 0.8),  # a binary switch that is on
        (0.0, 0.0, 0.8, None),  # and off
        (2.0, 0.3, 0.8, 1.0),  # 2 (0.8 - 0.3)
        (0.5, 0.2, 1.0, 0.4),
        (1.0, 0.8, 0.8, None),  # does not exceed the threshold
        (3.0, 1.0, 0.8, None),
    ],
)
def test_output_is_gain_times_what_exceeds_the_threshold(
    gain: float, threshold: float, length: float, passes: float | None
) -> None:
    response = Response(forward=0.6 * length, left=-0.8 * length)
    output = switch_output(response, Switch(gain=gain, threshold=threshold))
    if passes is None:
        assert output is None
    else:
        assert output is not None
        assert (output.forward, output.left) == (pytest.approx(0.6 * passes), pytest.approx(-0.8 * passes))


def test_turns_pass_by_the_gain() -> None:
    turn = Response(turn_radps=0.5)
    assert switch_output(turn, Switch()) == turn
    assert switch_output(turn, Switch(gain=0.4, threshold=2.0)) == Response(turn_radps=pytest.approx(0.2))
    assert switch_output(turn, Switch(gain=0.0)) is None
    both = switch_output(Response(forward=0.5, turn_radps=0.5), Switch(threshold=1.0))
    assert both == Response(turn_radps=0.5)


def test_to_stand_still_is_an_answer_that_a_switch_without_threshold_passes() -> None:
    assert switch_output(Response(), Switch()) == Response()
    assert switch_output(Response(), Switch(gain=0.5)) == Response()
    assert switch_output(Response(), Switch(threshold=0.1)) is None


@given(parts, parts, parts, gains, thresholds)
def test_a_switch_keeps_the_direction_and_the_limits_and_mirrors(
    forward: float, left: float, turn: float, gain: float, threshold: float
) -> None:
    switch = Switch(gain=gain, threshold=threshold)
    output = switch_output(Response(forward=forward, left=left, turn_radps=turn), switch)
    mirrored = switch_output(Response(forward=forward, left=-left, turn_radps=-turn), switch)
    assert (output is None) == (mirrored is None)
    if output is None or mirrored is None:
        return
    assert (mirrored.forward, mirrored.left, mirrored.turn_radps) == (output.forward, -output.left, -output.turn_radps)
    length = hypot(output.forward, output.left)
    assert isfinite(length)
    assert length <= LONGEST * (1 + 1e-9)
    assert abs(output.turn_radps) <= 100.0
    if length > 1e-6:
        assert atan2(output.left, output.forward) == pytest.approx(atan2(left, forward), abs=1e-6)


@given(parts, gains, thresholds, thresholds)
def test_a_higher_threshold_never_lets_more_through(forward: float, gain: float, low: float, more: float) -> None:
    def length(threshold: float) -> float:
        output = switch_output(Response(forward=forward), Switch(gain=gain, threshold=threshold))
        return 0.0 if output is None else abs(output.forward)

    assert length(low + more) <= length(low) + 1e-9


class Ahead(Behaviour[NoParams]):
    """Always wants the same: full speed ahead."""

    def respond(self, board: Any) -> Response | None:
        return Response(forward=1.0)


class Dampen(Behaviour[NoParams]):
    """Asks for nothing itself, and makes 'ahead' weaker while it is selected."""

    motivated = True

    def respond(self, board: Any) -> Response | None:
        return Response()

    def adjusts(self) -> Mapping[str, Switch]:
        return {"ahead": Switch(threshold=0.25)}


MISSION = """
[robot]
use = "sim.simulated:SimulatedRobot"
world = "world.toml"
[[behaviour]]
use = "{here}:Dampen"
name = "dampen"
inhibits = ["left"]
[[behaviour]]
use = "{here}:Ahead"
name = "ahead"
level = "explore"
threshold = 0.5
gain = 1.5
[[behaviour]]
use = "{here}:Ahead"
name = "left"
selected = false
[coordinator]
use = "behaviours.arbitration_network:ArbitrationNetwork"
weave_rad = 0
cruise_mps = 0.1
"""
WORLD = """
[floor]
outline = [[0, 0], [9, 0], [9, 9], [0, 9], [0, 0]]
"""
WANDERING = """
[robot]
use = "sim.simulated:SimulatedRobot"
[[behaviour]]
use = "behaviours.avoid_obstacles:AvoidObstacles"
[[behaviour]]
use = "behaviours.random_wander:RandomWander"
level = "explore"
[coordinator]
use = "behaviours.{coordinator}"
"""
Start = Callable[..., Run]


@pytest.fixture
def start(tmp_path: Path) -> Start:
    def begin(**changes: str) -> Run:
        text = MISSION.format(here=Path(__file__).as_posix())
        for old, new in changes.items():
            text = text.replace(old, new)
        (tmp_path / "world.toml").write_text(WORLD, encoding="utf-8")
        (tmp_path / "m.toml").write_text(text, encoding="utf-8")
        run = Run(load_mission(tmp_path / "m.toml"), RunOptions(strict=False))
        run.cycle()
        return run

    return begin


def velocity(run: Run) -> Entry[Velocity]:
    run.cycle()
    entry = run.board.newest(VELOCITY)
    assert entry is not None
    return entry


def set_switch(run: Run, id: str, switch: Switch) -> None:
    run.board.post(SWITCH, switch, id=id, source="coordinator")


def test_the_wiring_stands_on_the_board_and_what_switches_do_is_among_the_reasons(start: Start) -> None:
    run = start()
    wired = {entry.id: entry.value for entry in run.board.entries(SWITCH)}
    assert wired == {
        "dampen": Switch(),
        "ahead": Switch(gain=1.5, threshold=0.5, level="explore"),
        "left": Switch(),
        "explore": Switch(),
    }
    command = velocity(run)
    assert command.value.forward_mps == pytest.approx(0.1 * 0.75)  # 1.5 (1 - 0.5)
    assert [s.key.split("/", 2)[2] for s in command.supports] == ["commands/response/ahead", "control/switch/ahead"]


def test_a_level_is_switched_as_a_whole(start: Start) -> None:
    run = start()
    set_switch(run, "explore", Switch(gain=2.0, threshold=0.5))
    assert velocity(run).value.forward_mps == pytest.approx(0.1 * 0.5)  # 2 (0.75 - 0.5)
    set_switch(run, "explore", Switch(gain=0.0))
    revision = velocity(run).revision
    assert velocity(run).revision == revision  # nobody commands any more


def test_a_behaviour_adjusts_anothers_switch_while_it_answers_and_the_setting_comes_back(start: Start) -> None:
    run = start()
    board = run.board
    board.post(MOTIVATION, Motivation(on=True, number=1), id="dampen", source="test")
    command = velocity(run)
    assert command.value.forward_mps == pytest.approx(0.1 * 0.5)  # 1.5 (1 - 0.5) - 0.25
    adjusted = board.newest(SWITCH, "ahead.dampen")
    assert adjusted is not None
    assert (adjusted.value, adjusted.source) == (Switch(threshold=0.25), "dampen")
    assert [s.key.split("/", 2)[2] for s in adjusted.supports] == ["motivations/motivation/dampen"]
    assert adjusted.key in [s.key for s in command.supports]
    set_switch(run, "ahead", Switch(gain=1.0, level="explore"))  # set meanwhile
    assert velocity(run).value.forward_mps == pytest.approx(0.1 * 0.75)
    assert board.newest(SWITCH, "ahead.dampen") == adjusted  # told once
    board.post(MOTIVATION, Motivation(on=False, number=2), id="dampen", source="test")
    assert velocity(run).value.forward_mps == pytest.approx(0.1)
    assert board.newest(SWITCH, "ahead.dampen") is None


def test_what_is_switched_off_neither_inhibits_nor_adjusts(start: Start) -> None:
    run = start(**{"selected = false": ""})
    board = run.board
    board.post(MOTIVATION, Motivation(on=True, number=1), id="dampen", source="test")
    run.cycle()
    assert board.newest(RESPONSE, "left") is None
    assert board.newest(SWITCH, "ahead.dampen") is not None
    set_switch(run, "dampen", Switch(gain=0.0))
    run.cycle()
    assert board.newest(RESPONSE, "left") is not None
    assert board.newest(SWITCH, "ahead.dampen") is None


def test_who_adjusts_what_is_not_there_fails_with_the_nearest_name(start: Start) -> None:
    run = start(**{'name = "ahead"': 'name = "aheat"'})
    run.board.post(MOTIVATION, Motivation(on=True, number=1), id="dampen", source="test")
    run.cycle()
    failed, status = run.board.newest(COMPONENT, "dampen"), run.board.newest(BEHAVIOUR, "dampen")
    assert failed is not None
    assert "the switch of 'ahead', which this mission does not have; did you mean 'aheat'?" in failed.value.error
    assert status is not None
    assert status.value.state == "failed"
    assert velocity(run).value.forward_mps > 0.0


def test_with_neutral_switches_it_drives_as_superposition_does(tmp_path: Path) -> None:
    def drive(coordinator: str) -> bytes:
        (tmp_path / "m.toml").write_text(WANDERING.format(coordinator=coordinator), encoding="utf-8")
        run = Run(load_mission(tmp_path / "m.toml"), RunOptions(seed=2, strict=True))
        run.run(15.0)
        track = run.true_trajectory()
        assert track is not None
        return track.tobytes()

    assert drive("arbitration_network:ArbitrationNetwork") == drive("superposition:Superposition")


def test_wrong_wiring_is_refused(start: Start) -> None:
    with pytest.raises(MissionError, match=r"gain = 101\.0 is outside \[0, 100\]"):
        start(**{"gain = 1.5": "gain = 101"})
    with pytest.raises(MissionError, match="level = 'left'"):
        start(**{'level = "explore"': 'level = "left"'})
