"""The mug and its handle: round bodies in a sweep, where a part was looked for, and the story of section 2.6 on a board."""

from math import atan2, cos, hypot, pi, radians, sin

import numpy as np
import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.kinds import LASER_SCAN, ODOM_FROM_ROBOT, ROBOT, TWO_PART_OBJECT, VERDICT
from blackboard.messages.conflicts import Verdict
from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import LaserScan, LaserSensor, RobotDescription
from blackboard.uncertainty.theories import THEORIES, Theory
from blackboard.vocabulary import Vocabulary
from knowledge_sources.looks import Floats, beams_of
from knowledge_sources.part_view import PartView
from knowledge_sources.round_bodies import BodyLimits, clusters, round_body
from knowledge_sources.two_part_objects import TwoPartObjects, TwoPartObjectsParams

STEP = radians(1.0)
LASER = LaserSensor(mount=IDENTITY, max_range_m=8.0)
DESCRIPTION = RobotDescription(
    name="r", radius_m=0.2, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=1.0, lasers=(LASER,)
)
LIMITS = BodyLimits(radius_m=0.15)


def scan_of(pose: Pose, radius_m: float, handle_rad: float | None, rng: np.random.Generator) -> LaserScan:
    """Return a sweep of 181 beams over a post at the origin in a round room of 6 m; its handle is 0.2 m long and 0.06 m thick."""
    angles = pose.heading_rad - pi / 2 + STEP * np.arange(181)
    steps = np.arange(0.05, 5.0, 0.01)
    x = pose.x_m + steps * np.cos(angles)[:, None]
    y = pose.y_m + steps * np.sin(angles)[:, None]
    solid = np.hypot(x, y) <= radius_m
    solid |= np.hypot(x, y) >= 3.0
    if handle_rad is not None:
        along, across = x * cos(handle_rad) + y * sin(handle_rad), y * cos(handle_rad) - x * sin(handle_rad)
        solid |= (along >= 0.0) & (along <= radius_m + 0.2) & (np.abs(across) <= 0.03)
    ranges = steps[np.argmax(solid, axis=1)] + 0.01 * rng.standard_normal(len(angles))
    return LaserScan(angle_min_rad=-pi / 2, angle_step_rad=STEP, ranges_m=tuple(ranges.round(3).tolist()))


def facing(x: float, y: float) -> Pose:
    return Pose(x_m=x, y_m=y, heading_rad=atan2(-y, -x))


def seen_from(pose: Pose, radius_m: float, handle_rad: float | None, seed: int = 0) -> list[Floats]:
    scan = scan_of(pose, radius_m, handle_rad, np.random.default_rng(seed))
    return clusters(beams_of(scan, DESCRIPTION, pose), 0.3, 2.5)


@pytest.mark.parametrize("handle_rad", [None, pi, pi / 2, 0.0])
def test_the_body_is_found_with_its_handle_anywhere(handle_rad: float | None) -> None:
    pose = facing(-1.5, 0.3)
    found = [round_body(c, (pose.x_m, pose.y_m), LIMITS) for c in seen_from(pose, 0.15, handle_rad)]
    (body,) = [b for b in found if b is not None]
    assert hypot(body.x_m, body.y_m) < 0.04
    assert body.radius_m == pytest.approx(0.15, abs=0.03)


@pytest.mark.parametrize("radius_m", [0.05, 0.25, 0.5])
def test_bodies_of_another_size_are_none(radius_m: float) -> None:
    pose = facing(0.0, 1.4)
    found = seen_from(pose, radius_m, None)
    assert len(found) == 1
    assert round_body(found[0], (pose.x_m, pose.y_m), LIMITS) is None


def test_the_corner_of_a_crate_is_none() -> None:
    """Its sides leave it on either side, which no part does."""
    side = np.linspace(0.0, 0.4, 25)
    corner = np.concatenate([np.stack([1.0 + side[::-1], side[::-1]], axis=1), np.stack([1.0 + side, -side], axis=1)])
    assert round_body(corner, (0.0, 0.0), LIMITS) is None


def test_a_flat_front_is_no_body() -> None:
    line = np.stack([np.full(20, 1.0), np.linspace(-0.15, 0.15, 20)], axis=1)
    assert round_body(line, (0.0, 0.0), LIMITS) is None
    assert round_body(line[:4], (0.0, 0.0), LIMITS) is None  # too few


def test_where_a_part_was_looked_for() -> None:
    view, rng = PartView(), np.random.default_rng(1)
    assert (view.part_rad(), view.unseen_rad()) == (None, None)
    pose = facing(-1.5, 0.0)
    for _ in range(8):
        view.add(beams_of(scan_of(pose, 0.15, 0.0, rng), DESCRIPTION, pose), 0.0, 0.0, 0.15, 0.2, 2.5)
    assert view.part_rad() is None  # it is behind the body
    assert 18 <= view.absent.sum() <= 30
    unseen = view.unseen_rad()
    assert unseen == pytest.approx(0.0, abs=0.2)  # and that is where nobody has looked
    pose = facing(0.3, 1.5)
    for _ in range(8):
        view.add(beams_of(scan_of(pose, 0.15, 0.0, rng), DESCRIPTION, pose), 0.0, 0.0, 0.15, 0.2, 2.5)
    assert view.part_rad() == pytest.approx(0.0, abs=0.2)


def drive(handle_rad: float | None, theory: Theory) -> tuple[Board, list[tuple[str, str, str]]]:
    """Look from one side for three seconds, then from all round; return the board and the verdicts with the newest reason."""
    board = Board(Vocabulary())
    source = TwoPartObjects(TwoPartObjectsParams(theory=theory), name="mugs")
    access = Access(board, source.name, [LASER_SCAN, *source.reads], source.posts)
    told: list[tuple[str, str, str]] = []

    def tell(entry: Entry[Verdict]) -> None:
        reasons = board.history.revisions(entry.supports[0])[-1].endorsements
        if entry.event != "retracted":
            told.append((entry.value.outcome, ",".join(entry.value.lacking), reasons[-1].why))

    board.subscribe("ski/*/hypotheses/symbol/verdict/*", tell)
    board.post(ROBOT, DESCRIPTION, source="robot")
    rng = np.random.default_rng(2)
    for i in range(45):
        board.now_s = 0.2 * i
        angle = pi + max(0, i - 14) * 2 * pi / 30
        pose = facing(1.5 * cos(angle), 1.5 * sin(angle))
        board.post(ODOM_FROM_ROBOT, pose, source="odometry")
        source.activate(board.post(LASER_SCAN, scan_of(pose, 0.15, handle_rad, rng), source="robot"), access)
    return board, told


@pytest.mark.parametrize("theory", THEORIES)
def test_a_second_view_restores_the_mug(theory: Theory) -> None:
    board, told = drive(0.0, theory)
    assert told[0][:2] == ("unresolved", "part")
    assert "no part in the" in told[0][2]
    assert told[-1][:2] == ("confirmed", "")
    assert "its part sticks out" in told[-1][2]
    (mug,) = board.entries(TWO_PART_OBJECT)
    assert mug.value.part_bearing_rad == pytest.approx(0.0, abs=0.15)
    assert [(e.about, e.verdict) for e in mug.endorsements][:2] == [("body", "for"), ("part", "against")]
    (verdict,) = board.entries(VERDICT)
    assert (verdict.value.outcome, verdict.value.theory) == ("confirmed", theory)


@pytest.mark.parametrize("theory", THEORIES)
def test_seen_all_round_without_a_handle_it_is_no_mug(theory: Theory) -> None:
    board, told = drive(None, theory)
    assert told[-1][0] == "denied"
    assert "all round" in told[-1][2]
    assert board.entries(TWO_PART_OBJECT) == []
    assert board.entries(VERDICT) == []


def test_where_to_look_from_is_the_other_side() -> None:
    board = Board(Vocabulary())
    source = TwoPartObjects(TwoPartObjectsParams(), name="mugs")
    access = Access(board, source.name, [LASER_SCAN, *source.reads], source.posts)
    board.post(ROBOT, DESCRIPTION, source="robot")
    rng, pose = np.random.default_rng(3), facing(-1.5, 0.0)
    board.post(ODOM_FROM_ROBOT, pose, source="odometry")
    for _ in range(15):
        source.activate(board.post(LASER_SCAN, scan_of(pose, 0.15, 0.0, rng), source="robot"), access)
    look_from = board.entries(VERDICT)[0].value.look_from
    assert look_from is not None
    assert look_from.x_m > 1.0
    assert abs(look_from.y_m) < 0.4
    away = Pose(x_m=-1.5, y_m=0.0, heading_rad=pi)  # the other way: nothing is said of what is not looked at
    board.now_s = 1.0
    board.post(ODOM_FROM_ROBOT, away, source="odometry")
    before = board.entries(TWO_PART_OBJECT)[0].revision
    source.activate(board.post(LASER_SCAN, scan_of(away, 0.15, 0.0, rng), source="robot"), access)
    assert board.entries(TWO_PART_OBJECT)[0].revision == before
