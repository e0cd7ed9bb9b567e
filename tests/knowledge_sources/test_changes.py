"""What differs from what has stood for long: a chair that stays, a person who goes, a thing that is gone, and walls that blur."""

from math import pi, radians

import numpy as np
import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.entry import Support
from blackboard.grid import Grid, tile_id
from blackboard.kinds import CHANGE, GRID, LASER_SCAN, ODOM_FROM_ROBOT, ROBOT, VERDICT
from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import LaserScan, LaserSensor, RobotDescription
from blackboard.uncertainty.theories import THEORIES, Theory
from blackboard.vocabulary import Vocabulary
from knowledge_sources.changes import Changes, ChangesParams
from knowledge_sources.long_standing import LongStanding

STEP = radians(1.0)
LASER = LaserSensor(mount=IDENTITY, max_range_m=8.0)
DESCRIPTION = RobotDescription(
    name="r", radius_m=0.2, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=1.0, lasers=(LASER,)
)
PARAMS = ChangesParams(settled_s=10.0, stay_s=30.0)
Box = tuple[float, float, float, float]


def grid_of(boxes: list[Box]) -> Grid:
    """Return a room of 4 by 4 m, empty but for its walls and these boxes (x, y from and to)."""
    grid = Grid(0.05)
    grid.cover(0.0, 0.0, 3.99, 3.99)
    grid.cells[:80, :80] = 0
    grid.cells[[0, 79], :80] = grid.cells[:80, [0, 79]] = 255
    for x0, y0, x1, y1 in boxes:
        grid.cells[round(y0 / 0.05) : round(y1 / 0.05), round(x0 / 0.05) : round(x1 / 0.05)] = 255
    return grid


class Room:
    """A robot at (0.5, 2) that looks along x, in a room where boxes come and go."""

    def __init__(self, theory: Theory = "endorsements") -> None:
        self.board = Board(Vocabulary())
        params = ChangesParams(settled_s=PARAMS.settled_s, stay_s=PARAMS.stay_s, theory=theory)
        self.source = Changes(params, name="changes")
        self.access = Access(self.board, "changes", [GRID, LASER_SCAN, *self.source.reads], self.source.posts)
        self.board.post(ROBOT, DESCRIPTION, source="robot")
        self.now_s = 0.0

    def live(self, seconds: int, boxes: list[Box], looking: bool = True) -> None:
        """Let time pass: a grid each second and, where it looks, five sweeps."""
        grid = grid_of(boxes)
        scan = self.sweep(grid)
        for _ in range(seconds):
            self.now_s += 1.0
            self.board.now_s = self.now_s
            self.board.post(ODOM_FROM_ROBOT, Pose(x_m=0.5, y_m=2.0, heading_rad=0.0), source="odometry")
            for tile in grid.take_changed():
                self.board.post(GRID, tile, id=tile_id(tile), source="grid")
            self.source.activate(self.board.entries(GRID)[0], self.access)
            for _ in range(5 if looking else 0):
                self.source.activate(self.board.post(LASER_SCAN, scan, source="robot"), self.access)

    def sweep(self, grid: Grid) -> LaserScan:
        angles = -pi / 2 + STEP * np.arange(181)
        steps = np.arange(0.02, 5.0, 0.01)
        x, y = 0.5 + steps * np.cos(angles)[:, None], 2.0 + steps * np.sin(angles)[:, None]
        solid = grid.values_at(np.stack([x.ravel(), y.ravel()], axis=1)).reshape(x.shape) >= 192
        ranges = steps[np.argmax(solid, axis=1)]
        return LaserScan(angle_min_rad=-pi / 2, angle_step_rad=STEP, ranges_m=tuple(ranges.round(3).tolist()))

    def standing(self) -> list[tuple[str, bool, str]]:
        outcomes = {e.value.hypothesis: e.value.outcome for e in self.board.entries(VERDICT)}
        return [(e.value.change, e.value.accepted, outcomes[e.key]) for e in self.board.entries(CHANGE)]


CHAIR: Box = (2.0, 1.8, 2.4, 2.2)


@pytest.mark.parametrize("theory", THEORIES)
def test_a_chair_that_stays_is_accepted_and_leaves_the_model_when_it_is_taken_away(theory: Theory) -> None:
    room = Room(theory)
    room.live(12, [])
    assert room.standing() == []
    room.live(3, [CHAIR])
    assert room.standing() == []  # it may be somebody walking by
    room.live(2, [CHAIR])
    assert room.standing() == [("appeared", False, "unresolved")]
    verdict = room.board.entries(VERDICT)[0].value
    assert verdict.lacking == ("stay",)
    assert verdict.wait_until_s == pytest.approx(room.board.entries(CHANGE)[0].value.first_s + 30.0)
    room.live(40, [CHAIR])
    assert room.standing() == [("appeared", True, "confirmed")]
    (chair,) = room.board.entries(CHANGE)
    assert (chair.value.place.x_m, chair.value.place.y_m) == (pytest.approx(2.2, abs=0.1), pytest.approx(2.0, abs=0.1))
    assert [(e.about, e.verdict) for e in chair.endorsements] == [("map", "for"), ("stay", "for")]
    room.live(2, [])
    assert room.standing() == []
    last = room.board.history.revisions(Support(chair.key, 1, 999))[-1]
    assert (last.event, last.endorsements[-1].verdict) == ("retracted", "against")
    assert "gone again" in last.endorsements[-1].why
    room.live(30, [])
    assert room.standing() == []  # and nothing is left of it


@pytest.mark.parametrize("theory", THEORIES)
def test_a_person_who_goes_is_denied(theory: Theory) -> None:
    room = Room(theory)
    room.live(12, [])
    room.live(20, [CHAIR])
    assert room.standing() == [("appeared", False, "unresolved")]
    room.live(2, [])
    assert room.standing() == []
    room.live(60, [])
    assert room.standing() == []


@pytest.mark.parametrize("theory", THEORIES)
def test_what_has_gone_is_accepted_as_gone(theory: Theory) -> None:
    room = Room(theory)
    room.live(12, [CHAIR])
    room.live(5, [])
    assert room.standing() == [("gone", False, "unresolved")]
    room.live(40, [])
    assert room.standing() == [("gone", True, "confirmed")]


def test_without_a_look_nothing_is_concluded() -> None:
    room = Room()
    room.live(12, [])
    room.live(5, [CHAIR])
    room.live(100, [CHAIR], looking=False)
    assert room.standing() == [("appeared", False, "unresolved")]
    room.live(1, [CHAIR])
    assert room.standing() == [("appeared", True, "confirmed")]


def test_a_blurred_wall_is_no_change_and_neither_is_a_newly_seen_one() -> None:
    room = Room()
    room.live(12, [])
    room.live(20, [(3.85, 1.0, 3.95, 3.0)])  # the wall, two cells thicker
    assert room.standing() == []
    long, unknown = LongStanding(10.0), Grid(0.05)
    unknown.cover(0.0, 0.0, 3.99, 3.99)
    long.look(unknown, 0.0)
    long.look(grid_of([CHAIR]), 100.0)
    long.look(grid_of([CHAIR]), 105.0)
    assert long.differences(105.0, 3.0, 0.15, 5) == []


def test_it_grows_with_the_grid() -> None:
    long, grid = LongStanding(10.0), grid_of([])
    for now_s in (0.0, 11.0):
        long.look(grid, now_s)
    larger = grid_of([CHAIR])
    larger.cover(-5.0, -5.0, 9.0, 9.0)
    long.look(larger, 12.0)
    long.look(larger, 16.0)
    (found,) = long.differences(16.0, 3.0, 0.15, 5)
    assert found.appeared
    assert found.places.mean(axis=0).tolist() == pytest.approx([2.2, 2.0])
    assert long.shown_occupied(found.places) == 1.0
