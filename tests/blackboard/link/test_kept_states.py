"""What a host keeps for its next process: of this run only, and a disk that takes nothing stops nobody."""

from pathlib import Path

import pytest

from blackboard.assembly import assemble
from blackboard.board import Board
from blackboard.link.clock import ClockAnswer, MissionClock
from blackboard.link.kept_states import KeptStates
from blackboard.link.stages import Stages
from blackboard.mission import find_mission, load_mission
from blackboard.placement import placement

MISSION = load_mission(find_mission("wander-lab"))


def clock(began_wall_s: float, now_s: float = 30.0, pace: float = 2.0) -> MissionClock:
    it = MissionClock()
    it.measured(0.0, 0.001, 0.0, ClockAnswer(now_s=now_s, wall_s=began_wall_s + now_s / pace, pace=pace))
    return it


def kept(folder: Path, clock: MissionClock, seed: int = 0) -> tuple[KeptStates, Stages]:
    assembly = assemble(MISSION, seed)
    plan = next(plan for plan in placement(MISSION) if plan.behaviours)
    board = Board(assembly.vocabulary)
    return KeptStates(folder, MISSION, seed, "b1", board, clock), Stages(board, assembly, plan)


def test_the_next_process_of_this_run_finds_the_states(tmp_path: Path) -> None:
    before, stages = kept(tmp_path, clock(1000.0))
    before.keep(30.0, stages)
    after, _ = kept(tmp_path, clock(1000.0, now_s=95.0))
    assert after.restored().keys() == stages.states().keys()


@pytest.mark.parametrize("began", [clock(1060.0), MissionClock()], ids=["another", "not begun"])
def test_another_run_of_the_mission_begins_anew(
    tmp_path: Path, began: MissionClock, capsys: pytest.CaptureFixture[str]
) -> None:
    before, stages = kept(tmp_path, clock(1000.0))
    before.keep(30.0, stages)
    after, _ = kept(tmp_path, began)
    assert after.restored() == {}
    said = capsys.readouterr().err
    assert said.endswith("components.checkpoint: of another run of this mission; its components begin anew\n")
    assert said.count("\n") == 1


def test_a_run_with_another_seed_begins_anew(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before, stages = kept(tmp_path, clock(1000.0))
    before.keep(30.0, stages)
    assert kept(tmp_path, clock(1000.0), seed=1)[0].restored() == {}
    assert "of another mission" in capsys.readouterr().err


def test_a_disk_that_takes_nothing_is_said_once_and_stops_nobody(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    it, stages = kept(tmp_path, clock(1000.0))
    (tmp_path / "components.checkpoint.new").mkdir()  # where it would be written aside
    it.keep(30.0, stages)
    it.keep(32.0, stages)
    assert capsys.readouterr().err.count("cannot be written") == 1
