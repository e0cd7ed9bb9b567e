from math import cos, hypot, pi, sin
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.target_nav import Approach, TargetNav, TargetNavParams, approached, target_nav_response
from blackboard.access import Access
from blackboard.errors import MissionError
from blackboard.kinds import BEHAVIOUR, DRIVE, MAP_FROM_ODOM, MOTIVATION, ODOM_FROM_ROBOT, RESPONSE
from blackboard.messages.geometry import Pose
from blackboard.messages.motion import BehaviourStatus, Motivation, Response
from blackboard.mission import load_mission
from blackboard.runner import Run, RunOptions

PARAMS = TargetNavParams()
ORIGIN = Pose(x_m=0.0, y_m=0.0, heading_rad=0.0)
places = st.floats(-20.0, 20.0)
headings = st.floats(-3.1, 3.1)


def test_the_vector_is_that_from_robot_to_target() -> None:
    """V = (xt - xr) i + (yt - yr) j: (4 - 1, 6 - 2) = (3, 4), normalised (0.6, 0.8)."""
    response = target_nav_response(Pose(x_m=1.0, y_m=2.0, heading_rad=0.0), 4.0, 6.0, PARAMS)
    assert response.forward == pytest.approx(PARAMS.amplitude * 0.6)
    assert response.left == pytest.approx(PARAMS.amplitude * 0.8)
    turned = target_nav_response(Pose(x_m=1.0, y_m=2.0, heading_rad=pi / 2), 4.0, 6.0, PARAMS)
    assert (turned.forward, turned.left) == (pytest.approx(response.left), pytest.approx(-response.forward))


def test_it_gets_shorter_near_the_target() -> None:
    half = target_nav_response(ORIGIN, 0.5 * PARAMS.slow_m, 0.0, PARAMS)
    assert half == Response(forward=pytest.approx(0.5 * PARAMS.amplitude))
    assert target_nav_response(ORIGIN, 1e-3, 0.0, PARAMS).forward == pytest.approx(0.3 * PARAMS.amplitude)


@given(places, places, headings, places, places)
def test_it_never_exceeds_its_amplitude_and_mirrors(x: float, y: float, heading: float, tx: float, ty: float) -> None:
    response = target_nav_response(Pose(x_m=x, y_m=y, heading_rad=heading), tx, ty, PARAMS)
    assert hypot(response.forward, response.left) <= PARAMS.amplitude + 1e-9
    mirrored = target_nav_response(Pose(x_m=x, y_m=-y, heading_rad=-heading), tx, -ty, PARAMS)
    if (tx, ty) != (x, y):
        assert (mirrored.forward, mirrored.left) == (pytest.approx(response.forward), pytest.approx(-response.left))


@given(places, places, headings, headings)
def test_turning_the_whole_map_changes_nothing(x: float, y: float, heading: float, turn: float) -> None:
    c, s = cos(turn), sin(turn)
    one = target_nav_response(Pose(x_m=x, y_m=y, heading_rad=heading), 1.0, 2.0, PARAMS)
    moved = Pose(x_m=0.0, y_m=0.0, heading_rad=turn) @ Pose(x_m=x, y_m=y, heading_rad=heading)
    other = target_nav_response(moved, c * 1.0 - s * 2.0, s * 1.0 + c * 2.0, PARAMS)
    assert (other.forward, other.left) == (pytest.approx(one.forward, abs=1e-6), pytest.approx(one.left, abs=1e-6))


def test_it_is_blocked_after_long_without_progress_and_underway_again_with_it() -> None:
    approach = Approach()
    for tenth in range(301):
        approach = approached(approach, 3.0, 0.1 * tenth, 0.2, 0.25)
        assert approach.progress(30.0).outcome == ("underway" if tenth < 300 else "blocked"), tenth
    approach = approached(approach, 2.8, 31.0, 0.2, 0.25)
    assert approach.progress(30.0).outcome == "blocked"
    approach = approached(approach, 2.75, 31.1, 0.2, 0.25)
    assert (approach.progress(30.0).outcome, approach.progress(30.0).remaining_m) == ("underway", 2.75)
    approach = approached(approach, 0.2, 31.2, 0.2, 0.25)
    assert approach.progress(30.0).outcome == "reached"
    assert approached(approach, 5.0, 31.3, 0.2, 0.25).reached


def test_time_in_which_it_was_silenced_does_not_count() -> None:
    approach = approached(approached(Approach(), 3.0, 0.0, 0.2, 0.25), 3.0, 1000.0, 0.2, 0.25)
    assert approach.waited_s == 0.5


def test_through_the_board_the_map_may_move(bench) -> None:
    target_nav = TargetNav(PARAMS, name="target_nav")
    access = Access(bench.board, "target_nav", TargetNav.reads, ())
    assert target_nav.respond(access) is None
    assert target_nav.progress().outcome == "none"
    target_nav.select((2.0, 0.0))
    assert target_nav.respond(access) is None
    bench.board.post(ODOM_FROM_ROBOT, ORIGIN, source="pose")
    assert target_nav.respond(access) == Response(forward=PARAMS.amplitude)
    bench.board.post(MAP_FROM_ODOM, Pose(x_m=2.0, y_m=-1.0, heading_rad=0.0), source="pose")
    response = target_nav.respond(access)
    assert response is not None
    assert (response.forward, response.left) == (pytest.approx(0.0, abs=1e-9), pytest.approx(PARAMS.amplitude))
    assert not target_nav.done()
    bench.board.post(MAP_FROM_ODOM, Pose(x_m=1.9, y_m=0.0, heading_rad=0.0), source="pose")
    assert target_nav.respond(access) is None
    assert target_nav.done()
    target_nav.select((0.0, 0.0))
    assert target_nav.respond(access) is not None


def test_wrong_parameters_are_refused() -> None:
    target_nav = TargetNav(PARAMS, name="target_nav")
    with pytest.raises(MissionError, match=r"target_nav takes \(x_m, y_m\), numbers; it was given 1"):
        target_nav.select((1.0,))
    with pytest.raises(MissionError, match="y_m = 'door' is no number"):
        target_nav.select((1.0, "door"))
    with pytest.raises(MissionError, match="amplitude"):
        TargetNavParams(amplitude=1.0)


MISSION = """
[robot]
use = "sim.simulated:SimulatedRobot"
world = "world.toml"
start_x_m = 1.0
start_y_m = 2.0
odometry_errors = false

[[knowledge_source]]
use = "knowledge_sources.odometry_pose:OdometryPose"

[[behaviour]]
use = "behaviours.avoid_obstacles:AvoidObstacles"

[[behaviour]]
use = "behaviours.target_nav:TargetNav"
inhibits = ["random_wander"]

[[behaviour]]
use = "behaviours.random_wander:RandomWander"
selected = false

[coordinator]
use = "behaviours.superposition:Superposition"
"""
WORLD = """
[floor]
outline = [[0, 0], [7, 0], [7, 4], [0, 4], [0, 0]]
"""
CHAIR = """
[[circle]]
centres = [[3.5, {y}]]
radius_m = 0.24
surface = "rough"
"""


def run_to(folder: Path, things: str, parameters: tuple[float | str, ...], seed: int, duration_s: float) -> Run:
    """Drive to a place until the behaviour has reached it or the time is up."""
    (folder / "world.toml").write_text(WORLD + things, encoding="utf-8")
    path = folder / "go.toml"
    path.write_text(MISSION, encoding="utf-8")
    run = Run(load_mission(path), RunOptions(seed=seed, strict=True))
    run.cycle()
    motivation = Motivation(on=True, number=1, parameters=parameters)
    run.board.post(MOTIVATION, motivation, id="target_nav", source="test")
    while run.board.now_s < duration_s and status(run).outcome != "reached":
        run.cycle()
    return run


def status(run: Run) -> BehaviourStatus:
    entry = run.board.newest(BEHAVIOUR, "target_nav")
    assert entry is not None
    return entry.value


def test_it_drives_to_its_target_and_stops_there(tmp_path: Path) -> None:
    run = run_to(tmp_path, "", (5.8, 1.2), 1, 40.0)
    pose = run.robot.true_pose()
    assert pose is not None
    assert (status(run).outcome, status(run).acknowledged, status(run).state) == ("reached", 1, "done")
    assert hypot(pose.x_m - 5.8, pose.y_m - 1.2) <= 0.25
    assert run.board.now_s < 20.0
    for _ in range(20):
        run.cycle()
    drive = run.board.newest(DRIVE)
    assert drive is not None
    assert drive.value.forward_mps == 0.0
    assert run.board.newest(RESPONSE, "target_nav") is None


@pytest.mark.parametrize("y", [1.6, 1.85, 2.0, 2.15, 2.4])
def test_it_goes_around_a_chair(tmp_path: Path, y: float) -> None:
    run = run_to(tmp_path, CHAIR.format(y=y), (5.8, 2.0), 3, 60.0)
    assert status(run).outcome == "reached"
    assert run.robot.summary()["collisions"] == 0


def test_an_answer_stands_on_its_motivation(tmp_path: Path) -> None:
    run = run_to(tmp_path, "", (5.8, 2.0), 1, 1.0)
    response = run.board.newest(RESPONSE, "target_nav")
    assert response is not None
    assert run.board.key(MOTIVATION, "target_nav") in [support.key for support in response.supports]


def test_a_motivation_that_makes_no_sense_is_refused_and_said(tmp_path: Path) -> None:
    run = run_to(tmp_path, "", ("door", 2.0), 1, 1.0)
    assert (status(run).outcome, status(run).selected, status(run).acknowledged) == ("blocked", False, 1)
    assert "x_m = 'door' is no number" in status(run).detail
