from dataclasses import replace
from math import atan2, hypot, pi
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from behaviours.near_echoes import Near
from behaviours.wall_following import Lap, WallFollowing, WallFollowingParams, came_round, wall_following_response
from behaviours.ways_along import mirrored
from blackboard.errors import MissionError
from blackboard.kinds import BEHAVIOUR, MOTIVATION
from blackboard.messages.geometry import Pose
from blackboard.messages.motion import BehaviourStatus, Motivation, Response
from blackboard.mission import load_mission
from blackboard.runner import Run, RunOptions

PARAMS = WallFollowingParams()
RADIUS_M = 0.3
ORIGIN = Pose(x_m=0.0, y_m=0.0, heading_rad=0.0)
WALL = [
    (hypot(x / 10, 0.9), atan2(0.9, x / 10), 0.1, 0.0, True) for x in range(-12, 13)
]  # at its distance, to the left
echoes = st.lists(st.tuples(st.floats(0.35, 1.9), st.floats(-3.1, 3.1)), max_size=12)


def answer(
    nears: list[Near], lap: Lap | None = None, pose: Pose = ORIGIN, now_s: float = 0.0
) -> tuple[Lap, Response | None]:
    return wall_following_response(lap or Lap(), nears, pose, RADIUS_M, now_s, PARAMS)


def test_it_goes_straight_on_to_find_a_wall_and_then_along_it() -> None:
    lap, response = answer([])
    assert response == Response(forward=PARAMS.strength)
    assert not lap.follows
    lap, response = answer(WALL, lap)
    assert (lap.side, lap.follows) == (1, True)
    assert response is not None
    assert response.left == pytest.approx(0.0, abs=0.03)


def test_the_side_asked_for_is_kept() -> None:
    lap, response = answer(WALL, Lap(side=-1))
    assert not lap.follows
    assert response == Response(forward=PARAMS.strength)


def test_where_the_wall_ends_unseen_it_curves_and_then_has_lost_it() -> None:
    following = WallFollowing(PARAMS, name="wall_following")
    following._lap = answer(WALL)[0]
    assert following.progress().outcome == "underway"
    for tenth in range(1, 200):
        pose = Pose(x_m=0.04 * tenth, y_m=0.0, heading_rad=0.0)
        following._lap, response = answer([], following._lap, pose, 0.1 * tenth)
        assert response is not None
        assert (response.left > 0.0) == (tenth < 100), tenth  # 10 s
    assert (following.progress().outcome, following.progress().detail) == ("blocked", "has lost the wall")
    following._lap, _ = answer(WALL, following._lap, Pose(x_m=8.0, y_m=0.0, heading_rad=0.0), 20.0)
    assert following.progress().outcome == "underway"


def test_it_says_when_it_finds_none_or_cannot_go_on() -> None:
    following = WallFollowing(PARAMS, name="wall_following")
    for second in range(130):
        pose = Pose(x_m=0.2 * second, y_m=0.0, heading_rad=0.0)
        following._lap, _ = answer([], following._lap, pose, 0.5 * second)
        found = following.progress()
        assert found.outcome == ("blocked" if second >= 120 else "underway"), second
        assert found.detail == ("finds no wall" if second >= 120 else "looks for a wall")
    following.select(())
    for second in range(50):
        following._lap, _ = answer(WALL, following._lap, ORIGIN, 0.5 * second)
    assert (following.progress().outcome, following.progress().detail) == ("blocked", "has stood for 20 s")


def test_it_has_come_round_when_it_is_back_the_same_way_after_a_whole_turn() -> None:
    lap = Lap(pose=Pose(x_m=0.3, y_m=0.3, heading_rad=0.5), gone_m=12.0, turned_rad=-2 * pi)
    assert came_round(lap, ORIGIN, PARAMS)
    assert not came_round(replace(lap, turned_rad=-0.5), ORIGIN, PARAMS)
    assert not came_round(replace(lap, gone_m=2.0), ORIGIN, PARAMS)
    assert not came_round(replace(lap, pose=Pose(x_m=0.3, y_m=0.3, heading_rad=pi)), ORIGIN, PARAMS)
    assert not came_round(replace(lap, pose=Pose(x_m=1.3, y_m=0.3, heading_rad=0.5)), ORIGIN, PARAMS)


@given(echoes, st.sampled_from([-1, 1]))
def test_a_mirrored_world_and_side_mirror_the_answer(points: list[tuple[float, float]], side: int) -> None:
    nears = [(r, b, 0.1, 0.0, True) for r, b in points]
    lap, response = answer(nears, Lap(side=side))
    other, reverse = answer(mirrored(nears), Lap(side=-side))
    assert (lap.follows, response is None) == (other.follows, reverse is None)
    if response is not None and reverse is not None:
        assert hypot(response.forward, response.left) == pytest.approx(PARAMS.strength)
        assert (reverse.forward, reverse.left) == (pytest.approx(response.forward), pytest.approx(-response.left))


def test_wrong_parameters_are_refused() -> None:
    following = WallFollowing(PARAMS, name="wall_following")
    with pytest.raises(MissionError, match="wall_following takes 'left', 'right' or nothing"):
        following.select(("up",))
    with pytest.raises(MissionError, match="find_m"):
        WallFollowingParams(keep_m=1.0, find_m=0.7)


MISSION = """
[robot]
use = "sim.simulated:SimulatedRobot"
world = "{world}"
robot = "{robot}"
{start}
[[behaviour]]
use = "behaviours.avoid_obstacles:AvoidObstacles"
[[behaviour]]
use = "behaviours.wall_following:WallFollowing"
[coordinator]
use = "behaviours.superposition:Superposition"
"""
ISLAND = """
[floor]
outline = [[0, 0], [7, 0], [7, 6], [0, 6], [0, 0]]
[[box]]
centre = [3.5, 3.0]
size = [1.5, 0.8]
"""


def followed(folder: Path, world: str, robot: str, side: str, seed: int, start: str = "") -> tuple[Run, list[float]]:
    """Follow once around; return the run and the distances from rim to wall, every half second."""
    (folder / "m.toml").write_text(MISSION.format(world=world, robot=robot, start=start), encoding="utf-8")
    run = Run(load_mission(folder / "m.toml"), RunOptions(seed=seed, strict=True))
    run.cycle()
    motivation = Motivation(on=True, number=1, parameters=(side,) if side else ())
    run.board.post(MOTIVATION, motivation, id="wall_following", source="test")
    away_m = []
    truth, radius_m = run.robot.truth(), run.robot.description.radius_m
    assert truth is not None
    while run.board.now_s < 150.0 and status(run).outcome != "reached":
        for _ in range(5):
            run.cycle()
        pose = run.robot.true_pose()
        assert pose is not None
        if status(run).detail != "looks for a wall":
            away_m.append(truth.solid.distance(shapely.Point(pose.x_m, pose.y_m)) - radius_m)
    return run, away_m


def status(run: Run) -> BehaviourStatus:
    entry = run.board.newest(BEHAVIOUR, "wall_following")
    assert entry is not None
    return entry.value


@pytest.mark.parametrize(("robot", "side"), [("k2a", "left"), ("k2a", "right"), ("pioneer", "")])
def test_it_goes_once_around_the_lab(tmp_path: Path, robot: str, side: str) -> None:
    run, away_m = followed(tmp_path, "lab", robot, side, 2)
    assert status(run).outcome == "reached"
    assert run.robot.summary()["collisions"] == 0
    assert float(np.median(away_m)) == pytest.approx(PARAMS.keep_m, abs=0.2)
    track = run.true_trajectory()
    assert track is not None
    assert np.ptp(track[:, 1]) > 4.0
    assert np.ptp(track[:, 2]) > 1.5


def test_it_goes_round_outer_corners(tmp_path: Path) -> None:
    (tmp_path / "island.toml").write_text(ISLAND, encoding="utf-8")
    start = "start_x_m = 2.6\nstart_y_m = 1.7\nstart_heading_deg = 0"
    run, away_m = followed(tmp_path, "island.toml", "pioneer", "left", 1, start)
    assert status(run).outcome == "reached"
    assert run.robot.summary()["collisions"] == 0
    assert max(away_m) < PARAMS.keep_m + PARAMS.find_m
    track = run.true_trajectory()
    assert track is not None
    ring = shapely.LinearRing(track[::10, 1:3])
    assert shapely.Polygon(ring).buffer(0).contains(shapely.Point(3.5, 3.0))
