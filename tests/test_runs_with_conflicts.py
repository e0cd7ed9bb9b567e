"""A whole run in which what is seen and what is expected differ: each story, its reasons for and against, and its outcome."""

from pathlib import Path

import pytest

from blackboard.command.main import main
from blackboard.journal import FILE_NAME, JournalWriter, read_journal
from blackboard.kinds import CHANGE, MODEL_LINE, NEW_AREA_VISITED, RESOLUTION_TASK, TWO_PART_OBJECT, VERDICT
from blackboard.messages.conflicts import Change, ResolutionTask
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run, RunOptions


@pytest.fixture(scope="module")
def explored(tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, Path]:
    folder = tmp_path_factory.mktemp("conflicts")
    run = Run(load_mission(find_mission("explore-workshop-conflicts")), RunOptions(strict=True))
    with JournalWriter(folder / FILE_NAME) as journal:
        run.board.journal = journal
        run.run(370.0)
    run.robot.close()
    return run, folder


def tasks_at(run: Run, x: float, y: float) -> list[tuple[str, ResolutionTask]]:
    """Return the tasks about a place, in the order in which they were opened, with their ids."""
    found = [(str(e.id), e.value) for e in run.board.entries(RESOLUTION_TASK)]
    return [
        (i, t) for i, t in found if t.place is not None and abs(t.place.x_m - x) < 0.5 and abs(t.place.y_m - y) < 0.5
    ]


def changes_at(run: Run, x: float, y: float) -> list[Change]:
    changes = [e.value for e in run.board.entries(CHANGE)]
    return [c for c in changes if abs(c.place.x_m - x) < 0.5 and abs(c.place.y_m - y) < 0.5]


def why(folder: Path, key: str, capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["why", key, "--in", str(folder)]) == 0
    return capsys.readouterr().out


def test_the_mug_without_its_handle_and_the_second_view(
    explored: tuple[Run, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    run, folder = explored
    ((number, task),) = [(i, t) for i, t in tasks_at(run, 2.5, 2.7) if "mug" in t.hypothesis]
    assert (task.todo, task.outcome) == ("look again", "confirmed")
    (mug,) = run.board.entries(TWO_PART_OBJECT)
    assert (mug.value.place.x_m, mug.value.place.y_m) == (pytest.approx(2.5, abs=0.02), pytest.approx(2.7, abs=0.02))
    assert mug.value.body_radius_m == pytest.approx(0.15, abs=0.01)
    assert mug.value.part_bearing_rad == pytest.approx(0.785, abs=0.15)
    told = why(folder, f"motivations/resolution_task/{number}", capsys)
    assert "for (resolution_tasks, two_part_objects/body" in told
    assert "against (resolution_tasks, two_part_objects/part, until" in told
    assert "for (resolution_tasks, two_part_objects/part): its part sticks out at" in told
    assert "observations/signal/laser_scan" in told  # down to the readings


def test_the_post_that_was_never_a_mug(explored: tuple[Run, Path], capsys: pytest.CaptureFixture[str]) -> None:
    run, folder = explored
    ((number, task),) = [(i, t) for i, t in tasks_at(run, 4.6, 1.3) if "mug" in t.hypothesis]
    assert (task.todo, task.outcome) == ("look again", "denied")
    assert task.stand is not None
    assert "looked at all round, it has no part" in why(folder, f"motivations/resolution_task/{number}", capsys)


def test_the_chair_that_was_put_down_and_taken_away(explored: tuple[Run, Path]) -> None:
    run, _ = explored
    task = next(t for _, t in tasks_at(run, 3.4, 4.4) if "change" in t.hypothesis)
    assert (task.todo, task.outcome) == ("wait and see", "confirmed")
    assert 100.0 < task.opened_s < 130.0
    assert task.closed_s is not None
    assert task.closed_s >= task.not_before_s  # not before it has stayed for 90 s
    assert all(c.change == "gone" for c in changes_at(run, 3.4, 4.4))  # taken away, it has left the model


def test_the_person_who_stood_still_for_a_minute(explored: tuple[Run, Path]) -> None:
    run, _ = explored
    person = [t for _, t in tasks_at(run, 5.0, 2.5) if "change" in t.hypothesis]
    assert {(t.todo, t.outcome) for t in person} == {("wait and see", "denied")}
    assert any(t.closed_s is not None and t.closed_s - t.opened_s > 40.0 for t in person)
    assert changes_at(run, 5.0, 2.5) == []


def test_the_crate_that_was_moved(explored: tuple[Run, Path]) -> None:
    run, _ = explored
    assert {t.outcome for _, t in tasks_at(run, 5.6, 5.2) if "change" in t.hypothesis} == {"confirmed"}
    assert {(c.change, c.accepted) for c in changes_at(run, 5.6, 5.2)} == {("gone", True)}
    assert {t.outcome for _, t in tasks_at(run, 5.7, 1.0) if "change" in t.hypothesis} == {"confirmed"}
    assert {(c.change, c.accepted) for c in changes_at(run, 5.7, 1.0)} == {("appeared", True)}


def test_the_door_that_was_closed(explored: tuple[Run, Path]) -> None:
    run, _ = explored
    (door,) = [t for _, t in tasks_at(run, 6.5, 2.9) if "change" in t.hypothesis]
    assert (door.todo, door.outcome) == ("wait and see", "confirmed")
    assert [(c.change, c.accepted) for c in changes_at(run, 6.5, 2.9)] == [("appeared", True)]


def test_lines_of_people_and_of_moved_things_are_not_in_the_model(explored: tuple[Run, Path]) -> None:
    run, folder = explored
    lines = [e.value for e in run.board.entries(MODEL_LINE)]
    middles = [((w.start.x_m + w.end.x_m) / 2, (w.start.y_m + w.end.y_m) / 2) for w in lines]

    def at(x: float, y: float) -> int:
        return sum(abs(mx - x) < 0.4 and abs(my - y) < 0.4 for mx, my in middles)

    assert (at(5.6, 5.2), at(5.0, 2.5), at(3.4, 4.4)) == (0, 0, 0)  # the crate's old place, the person, the chair
    assert at(5.7, 1.0) >= 1  # where the crate stands now
    assert len(lines) >= 8
    retracted = [line for line in read_journal(folder) if "/model_line/" in line.key and line.event == "retracted"]
    assert any("the grid is empty along it" in e.why for line in retracted for e in line.endorsements)


def test_every_doubt_is_told_and_none_is_dropped(explored: tuple[Run, Path]) -> None:
    run, _ = explored
    hypotheses = {e.key for kind in (CHANGE, TWO_PART_OBJECT, NEW_AREA_VISITED) for e in run.board.entries(kind)}
    assert {e.value.hypothesis for e in run.board.entries(VERDICT)} == hypotheses
    for entry in run.board.entries(RESOLUTION_TASK):
        assert entry.endorsements
        assert entry.value.outcome == "open" or entry.value.closed_s is not None
    assert run.robot.summary()["collisions"] == 0
