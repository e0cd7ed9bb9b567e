"""A whole run of the mission that says what its map means: corners, targets and traps against the true lab, and `ski find`."""

import json
from pathlib import Path

import numpy as np
import pytest
import shapely

from blackboard.command.main import main
from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN, Grid
from blackboard.journal import FILE_NAME, JournalWriter
from blackboard.kinds import CORNER, GRID, LINE, LINE_RELATION, TARGET, TRAP
from blackboard.mission import find_mission, load_mission
from blackboard.report.corner_scores import KNOWN_SIDE_M, SIDE_M, TrueCorner, corner_scores, true_corners
from blackboard.runner import Run, RunOptions


@pytest.fixture(scope="module")
def explored(tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, Path, list[int]]:
    """Return a run of five minutes, its folder, and how many frontier targets stood every 10 s."""
    folder = tmp_path_factory.mktemp("symbols")
    run = Run(load_mission(find_mission("explore-lab-symbols")), RunOptions(strict=True))
    counts: list[int] = []

    def count(elapsed_s: float, total_s: float) -> None:
        if round(elapsed_s) % 10 == 0:
            counts.append(sum(e.value.reason == "frontier" for e in run.board.entries(TARGET)))

    with JournalWriter(folder / FILE_NAME) as journal:
        run.board.journal = journal
        run.run(300.0, count)
    run.robot.close()
    return run, folder, counts


def seen(true: TrueCorner, lines: list[shapely.LineString]) -> bool:
    """Say whether both sides of a corner stand as lines, so that it could be found at all."""
    return all(any(line.distance(shapely.Point(place)) < 0.05 for line in lines) for place in true.beside)


def test_corners_are_found_where_corners_are(explored: tuple[Run, Path, list[int]]) -> None:
    run, _, _ = explored
    truth = run.robot.truth()
    assert truth is not None
    found = [e.value for e in run.board.entries(CORNER)]
    right = [c for c in found if any(true.is_met(c) for true in true_corners(truth, KNOWN_SIDE_M))]
    walls = [e.value for e in run.board.entries(LINE)]
    lines = [shapely.LineString([(w.start.x_m, w.start.y_m), (w.end.x_m, w.end.y_m)]) for w in walls]
    every = true_corners(truth, SIDE_M)
    could = [true for true in every if seen(true, lines)]
    met = [true for true in could if any(true.is_met(c) for c in found)]
    print(
        f"corners: {len(right)} of {len(found)} right; {len(met)} of {len(could)} whose sides are lines, of {len(every)}"
    )
    assert len(right) >= 0.7 * len(found)
    assert len(met) >= 0.85 * len(could)
    assert len(met) >= 0.3 * len(every)  # the sides of most things are too short for lines
    errors_m = [min(np.hypot(c.place.x_m - t.x_m, c.place.y_m - t.y_m) for t in every) for c in right]
    assert np.median(errors_m) < 0.02
    scores = corner_scores(found, truth)
    assert scores["corners_right_fraction"] == len(right) / len(found)
    assert scores["corners_found_fraction"] >= 0.3
    assert {c.shape for c in found} >= {"concave", "convex"}
    assert run.board.entries(LINE_RELATION)


def test_targets_lie_on_frontiers_and_none_is_left_where_all_is_known(explored: tuple[Run, Path, list[int]]) -> None:
    run, _, counts = explored
    assert max(counts[:10]) >= 2
    grid = Grid.from_tiles(e.value for e in run.board.entries(GRID))
    assert grid is not None
    undecided = np.argwhere((grid.cells > EMPTY_MAX) & (grid.cells < OCCUPIED_MIN)) * grid.cell_m
    for entry in run.board.entries(TARGET):
        place, stand = entry.value.place, entry.value.stand
        around = np.hypot(
            undecided[:, 1] + grid.x_min_m + grid.cell_m / 2 - place.x_m,
            undecided[:, 0] + grid.y_min_m + grid.cell_m / 2 - place.y_m,
        )
        reach_m = 1.1 * grid.cell_m if entry.value.reason == "frontier" else 0.5 + run.robot.description.radius_m * 2
        assert around.min() <= reach_m, f"{entry.key} has nothing unknown around it"
        assert grid.values_at(np.array([[stand.x_m, stand.y_m]]))[0] <= EMPTY_MAX
    assert counts[-1] == 0  # the lab is closed, and known
    assert len(run.board.entries(TARGET)) <= 4


def test_the_lab_holds_no_u_and_nothing_stands_in_the_way(explored: tuple[Run, Path, list[int]]) -> None:
    run, _, _ = explored
    assert [e.value.trap for e in run.board.entries(TRAP) if e.value.trap != "cycling"] == []


def test_find_tells_where_things_are_and_what_a_place_is_part_of(
    explored: tuple[Run, Path, list[int]], capsys: pytest.CaptureFixture[str]
) -> None:
    run, folder, _ = explored
    assert main(["find", "corner", "--near", "8,0.5", "--within", "0.2", "--in", str(folder), "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)
    assert found["value"]["shape"] == "concave"
    assert found["distance_m"] < 0.1
    standing = run.board.entries(CORNER)
    assert main(["find", "corner", "--in", str(folder)]) == 0
    assert len(capsys.readouterr().out.splitlines()) == len(standing)
    assert main(["find", "cell", "--near", "4,0", "--in", str(folder), "--json"]) == 0
    cell = json.loads(capsys.readouterr().out)
    assert cell["state"] == "occupied"
    assert {o["kind"] for o in cell["part_of"]} == {"observations/feature/line"}


def test_the_u_in_the_world_of_traps_is_found() -> None:
    mission = load_mission(find_mission("explore-lab-symbols"), {"robot": {"world": "trap"}})
    run = Run(mission, RunOptions(strict=True))
    run.run(200.0)
    run.robot.close()
    found = [e.value for e in run.board.entries(TRAP) if e.value.trap == "u-shape"]
    assert len(found) == 1
    assert (found[0].place.x_m, found[0].place.y_m) == pytest.approx(
        (4.45, 4.05), abs=0.2
    )  # 2.1 m deep, within its walls
    assert found[0].size_m == pytest.approx(2.75, abs=0.1)
