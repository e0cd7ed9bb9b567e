"""A whole run of the mission that says what its map means: corners, targets and traps against the true lab, and `ski find`."""

import json
from math import atan2, pi
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import shapely

from blackboard.command.main import main
from blackboard.component import WorldTruth
from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN, Grid
from blackboard.journal import FILE_NAME, JournalWriter
from blackboard.kinds import CORNER, GRID, LINE, LINE_RELATION, TARGET, TRAP
from blackboard.messages.geometry import wrap_angle
from blackboard.messages.symbols import Corner
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run, RunOptions

NEAR_M = 0.15  # three cells
BESIDE_M = 0.2
ARM_M = 0.4  # shorter sides of things are not asked for


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


class TrueCorner(NamedTuple):
    """A corner of the free floor: its place, its shape as the robot senses it, and a place on either side, BESIDE_M away."""

    x_m: float
    y_m: float
    shape: str
    beside: tuple[tuple[float, float], tuple[float, float]]


def true_corners(truth: WorldTruth, arm_m: float) -> list[TrueCorner]:
    """Return the corners of the free floor whose two sides are this long."""
    free = truth.floor.difference(truth.solid)
    found = []
    for part in getattr(free, "geoms", [free]):
        whole = shapely.geometry.polygon.orient(part.simplify(0.01))  # the free floor lies left of every ring
        for ring in (whole.exterior, *whole.interiors):
            points = np.array(ring.coords)[:-1]
            for before, here, after in zip(np.roll(points, 1, 0), points, np.roll(points, -1, 0), strict=True):
                come, go = here - before, after - here
                turn = wrap_angle(atan2(go[1], go[0]) - atan2(come[1], come[0]))
                if min(np.hypot(*come), np.hypot(*go)) >= arm_m and abs(turn) >= pi / 6:
                    back, on = here - come / np.hypot(*come) * BESIDE_M, here + go / np.hypot(*go) * BESIDE_M
                    shape = "concave" if turn > 0 else "convex"
                    beside = ((float(back[0]), float(back[1])), (float(on[0]), float(on[1])))
                    found.append(TrueCorner(float(here[0]), float(here[1]), shape, beside))
    return found


def fits(corner: Corner, true: TrueCorner) -> bool:
    near = np.hypot(corner.place.x_m - true.x_m, corner.place.y_m - true.y_m) <= NEAR_M
    return bool(near) and corner.shape in (true.shape, "unknown")


def seen(true: TrueCorner, lines: list[shapely.LineString]) -> bool:
    """Say whether both sides of a corner stand as lines, so that it could be found at all."""
    return all(any(line.distance(shapely.Point(place)) < 0.05 for line in lines) for place in true.beside)


def test_corners_are_found_where_corners_are(explored: tuple[Run, Path, list[int]]) -> None:
    run, _, _ = explored
    truth = run.robot.truth()
    assert truth is not None
    found = [e.value for e in run.board.entries(CORNER)]
    right = [c for c in found if any(fits(c, true) for true in true_corners(truth, 0.1))]
    walls = [e.value for e in run.board.entries(LINE)]
    lines = [shapely.LineString([(w.start.x_m, w.start.y_m), (w.end.x_m, w.end.y_m)]) for w in walls]
    every = true_corners(truth, ARM_M)
    could = [true for true in every if seen(true, lines)]
    met = [true for true in could if any(fits(c, true) for c in found)]
    print(
        f"corners: {len(right)} of {len(found)} right; {len(met)} of {len(could)} whose sides are lines, of {len(every)}"
    )
    assert len(right) >= 0.7 * len(found)
    assert len(met) >= 0.85 * len(could)
    assert len(met) >= 0.3 * len(every)  # the sides of most things are too short for lines
    errors_m = [min(np.hypot(c.place.x_m - t.x_m, c.place.y_m - t.y_m) for t in every) for c in right]
    assert np.median(errors_m) < 0.02
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
