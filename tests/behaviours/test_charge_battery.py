from math import hypot, pi
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.charge_battery import (
    ChargeBattery,
    ChargeBatteryParams,
    approach_response,
    facing_response,
    place_before,
    raised_threshold,
)
from blackboard.access import Access
from blackboard.errors import MissionError
from blackboard.kinds import BEHAVIOUR, MOTIVATION, ODOM_FROM_ROBOT, SWITCH
from blackboard.messages.geometry import Pose
from blackboard.messages.motion import Motivation, Switch
from blackboard.mission import load_mission
from blackboard.runner import Run, RunOptions

PARAMS = ChargeBatteryParams()
ORIGIN = Pose(x_m=0.0, y_m=0.0, heading_rad=0.0)


def test_the_place_lies_before_the_station() -> None:
    """Rim 0.5 m from the pad, radius 0.3: 0.8 m before it, against the heading."""
    place = place_before(ORIGIN, (4.0, 1.0, pi / 2), 0.3, 0.5)
    assert (place.x_m, place.y_m, place.heading_rad) == (pytest.approx(4.0), pytest.approx(0.2), pi / 2)
    straight = place_before(ORIGIN, (3.0, 4.0), 0.3, 0.5)
    assert (straight.x_m, straight.y_m) == (pytest.approx(3.0 - 0.8 * 0.6), pytest.approx(4.0 - 0.8 * 0.8))


@pytest.mark.parametrize(("distance", "threshold"), [(3.0, 0.0), (2.0, 0.0), (1.0, 0.5), (0.37, 0.8), (0.0, 1.0)])
def test_the_threshold_rises_on_the_way(distance: float, threshold: float) -> None:
    assert raised_threshold(distance, PARAMS) == pytest.approx(threshold)


@given(st.floats(0.0, 10.0), st.floats(0.0, 10.0))
def test_nearer_is_never_a_lower_threshold(near: float, more: float) -> None:
    assert 0.0 <= raised_threshold(near + more, PARAMS) <= raised_threshold(near, PARAMS) <= PARAMS.threshold


@given(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0), st.floats(-3.0, 3.0))
def test_the_vector_stays_below_its_amplitude_and_mirrors(x: float, y: float, heading: float) -> None:
    place = Pose(x_m=1.0, y_m=2.0, heading_rad=0.0)
    mirrored = Pose(x_m=1.0, y_m=-2.0, heading_rad=0.0)
    one = approach_response(Pose(x_m=x, y_m=y, heading_rad=heading), place, PARAMS)
    other = approach_response(Pose(x_m=x, y_m=-y, heading_rad=-heading), mirrored, PARAMS)
    assert hypot(one.forward, one.left) <= PARAMS.amplitude + 1e-9
    if (x, y) != (1.0, 2.0):
        assert (other.forward, other.left) == (pytest.approx(one.forward), pytest.approx(-one.left))
    assert facing_response(heading, 0.6).turn_radps == -facing_response(-heading, 0.6).turn_radps
    assert abs(facing_response(heading, 0.6).turn_radps) <= 0.6


def test_through_the_board_it_goes_turns_and_is_done(bench) -> None:
    behaviour = ChargeBattery(PARAMS, name="charge_battery")
    access = Access(bench.board, "charge_battery", ChargeBattery.reads, ())
    behaviour.select((4.0, 0.0, pi / 2))
    assert behaviour.respond(access) is None
    bench.board.post(ODOM_FROM_ROBOT, Pose(x_m=0.0, y_m=-0.8, heading_rad=0.0), source="pose")
    response = behaviour.respond(access)
    assert response is not None
    assert (response.forward, response.left) == (pytest.approx(PARAMS.amplitude), pytest.approx(0.0))
    assert behaviour.adjusts() == {}
    bench.board.post(ODOM_FROM_ROBOT, Pose(x_m=3.0, y_m=-0.8, heading_rad=0.0), source="pose")
    behaviour.respond(access)
    assert behaviour.adjusts() == {"avoid_obstacles": Switch(threshold=0.5)}
    bench.board.post(ODOM_FROM_ROBOT, Pose(x_m=3.9, y_m=-0.8, heading_rad=0.0), source="pose")
    response = behaviour.respond(access)
    assert response is not None
    assert (response.forward, response.turn_radps) == (0.0, PARAMS.turn_radps)
    assert (behaviour.progress().outcome, behaviour.done()) == ("underway", False)
    bench.board.post(ODOM_FROM_ROBOT, Pose(x_m=3.9, y_m=-0.8, heading_rad=1.5), source="pose")
    assert behaviour.respond(access) is None
    assert (behaviour.progress().outcome, behaviour.done()) == ("reached", True)


def test_wrong_parameters_are_refused() -> None:
    behaviour = ChargeBattery(PARAMS, name="charge_battery")
    with pytest.raises(MissionError, match=r"\(x_m, y_m, heading_rad\), numbers, the last 1 optional; it was given 1"):
        behaviour.select((1.0,))
    with pytest.raises(MissionError, match="near_m"):
        ChargeBatteryParams(near_m=0.0)


MISSION = """
[robot]
use = "sim.simulated:SimulatedRobot"
robot = "{robot}"
[[knowledge_source]]
use = "knowledge_sources.odometry_pose:OdometryPose"
[[behaviour]]
use = "behaviours.avoid_obstacles:AvoidObstacles"
[[behaviour]]
use = "behaviours.charge_battery:ChargeBattery"
[coordinator]
use = "behaviours.arbitration_network:ArbitrationNetwork"
"""


@pytest.mark.parametrize("robot", ["k2a", "pioneer"])
def test_in_the_lab_avoiding_is_tuned_down_on_the_way_and_comes_back(tmp_path: Path, robot: str) -> None:
    (tmp_path / "m.toml").write_text(MISSION.format(robot=robot), encoding="utf-8")
    run = Run(load_mission(tmp_path / "m.toml"), RunOptions(seed=1, strict=True))
    board, told, thresholds = run.board, "avoid_obstacles.charge_battery", []
    board.subscribe(f"{board.key(SWITCH, told)}", lambda entry: thresholds.append((entry.event, entry.value.threshold)))
    run.cycle()
    board.post(
        MOTIVATION, Motivation(on=True, number=1, parameters=(4.3, 0.0, -pi / 2)), id="charge_battery", source="t"
    )
    status = board.newest(BEHAVIOUR, "charge_battery")
    while board.now_s < 20.0 and (status is None or status.value.state != "done"):
        run.cycle()
        status = board.newest(BEHAVIOUR, "charge_battery")
    assert status is not None
    assert (status.value.outcome, status.value.state) == ("reached", "done")
    avoid = board.newest(SWITCH, "avoid_obstacles")
    assert avoid is not None
    raised = [threshold for event, threshold in thresholds if event != "retracted"]
    assert len(raised) >= 8
    assert raised[0] <= 0.2
    assert max(raised) >= 0.9
    assert thresholds[-1][0] == "retracted"
    assert board.newest(SWITCH, told) is None
    assert avoid.value == Switch()
    pose = run.robot.true_pose()
    assert pose is not None
    assert hypot(pose.x_m - 4.3, pose.y_m - 0.8) < 0.3
    assert run.robot.summary()["collisions"] == 0
