from math import hypot, pi
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.docking import SIDES, STAND, Attempt, Docking, DockingParams, before_station, docking_response
from blackboard.errors import MissionError
from blackboard.kinds import BATTERY, BEHAVIOUR, DRIVE, MOTIVATION, RESPONSE, SWITCH
from blackboard.messages.geometry import Pose
from blackboard.messages.motion import BehaviourStatus, Motivation, Response, Switch
from blackboard.mission import load_mission
from blackboard.runner import Run, RunOptions

PARAMS = DockingParams()
STATION = (2.0, 0.0, 0.0)
phases = st.sampled_from(["line up", "turn", "approach", "wait", "charge", "give up"])


def at(x_m: float, y_m: float = 0.0, heading_rad: float = 0.0) -> Pose:
    return Pose(x_m=x_m, y_m=y_m, heading_rad=heading_rad)


def step(
    attempt: Attempt, pose: Pose, now_s: float = 0.0, charge: float | None = 0.5, touched: bool = False
) -> tuple[Attempt, Response | None]:
    return docking_response(attempt, pose, STATION, 0.3, charge, touched, now_s, PARAMS)


def test_where_it_is_as_seen_along_the_heading_of_the_station() -> None:
    assert before_station(at(1.0, 0.2, 0.1), STATION) == pytest.approx((1.0, 0.2, 0.1))
    assert before_station(at(0.0, 1.0, -pi / 2), (0.0, 0.0, -pi / 2)) == pytest.approx((1.0, 0.0, 0.0))
    assert before_station(at(0.3, 1.0, -pi / 2), (0.0, 0.0, -pi / 2)) == pytest.approx((1.0, 0.3, 0.0))


def test_it_lines_up_turns_and_goes_straight_and_slowly() -> None:
    """It lines up 0.5 m before the station from its rim: with its middle at 1.2."""
    attempt, response = step(Attempt(), at(1.2, 0.4, -pi / 2))
    assert attempt.phase == "line up"
    assert response == Response(forward=pytest.approx(0.4), left=pytest.approx(0.0, abs=1e-9))
    attempt, response = step(attempt, at(1.2, 0.02, -pi / 2))
    assert attempt.phase == "turn"
    assert response == Response(turn_radps=PARAMS.turn_radps)
    attempt, response = step(attempt, at(1.2, 0.02, -0.04))
    assert attempt.phase == "approach"
    assert response is not None
    assert hypot(response.forward, response.left) == pytest.approx(PARAMS.strength)
    assert response.left / response.forward == pytest.approx(0.04 - 0.02 / 0.4, abs=1e-3)


def test_where_it_goes_no_further_it_waits_and_then_tries_a_step_to_the_side() -> None:
    attempt = Attempt(phase="approach", nearest_m=0.15)
    attempt, response = step(attempt, at(1.56), 4.9)
    assert (attempt.phase, response != STAND) == ("approach", True)
    attempt, response = step(attempt, at(1.56), 5.0)
    assert (attempt.phase, response) == ("wait", STAND)
    attempt, _ = step(attempt, at(1.56), 29.9)
    assert attempt.phase == "wait"
    attempt, _ = step(attempt, at(1.56), 30.0)
    assert (attempt.phase, attempt.number) == ("line up", 1)
    _, response = step(attempt, at(1.2), 30.1)
    assert response is not None
    assert response.left > 0.0  # one step to the left
    assert step(attempt, at(1.2, PARAMS.side_m), 30.1)[0].phase == "approach"


def test_it_stops_where_the_bumper_touches_and_where_the_station_should_have_been() -> None:
    attempt = Attempt(phase="approach", nearest_m=0.30)
    assert step(attempt, at(1.5), touched=True)[0].phase == "wait"
    assert step(attempt, at(1.86))[0].phase == "wait"  # 0.16 m too far


@pytest.mark.parametrize("pose", [at(1.6, 0.13), at(1.6, -0.13), at(1.6, 0.0, 0.4)])
def test_misaligned_it_tries_again(pose: Pose) -> None:
    attempt, response = step(Attempt(phase="approach", nearest_m=0.30), pose)
    assert (attempt.phase, attempt.number, response) == ("line up", 1, STAND)


def test_it_stands_while_the_charge_rises_and_comes_back_when_it_is_lost() -> None:
    attempt = Attempt(phase="approach", nearest_m=0.30, charge=0.5)
    attempt, response = step(attempt, at(1.5), 3.0, 0.501)
    assert (attempt.phase, response) == ("charge", STAND)
    for now_s, charge in ((10.0, 0.6), (20.0, 0.7), (30.0, 0.699), (500.0, 1.0), (600.0, 1.0)):
        attempt, response = step(attempt, at(1.5), now_s, charge)
        assert (attempt.phase, response) == ("charge", STAND)
    attempt, _ = step(attempt, at(1.5), 700.0, 0.99)
    assert (attempt.phase, attempt.number) == ("line up", 0)


def test_a_full_battery_does_not_rise_and_a_falling_one_is_not_charged() -> None:
    waiting = Attempt(phase="wait", charge=1.0)
    assert step(waiting, at(1.56), 1.0, 1.0)[0].phase == "charge"
    assert step(Attempt(phase="approach", nearest_m=0.30, charge=1.0), at(1.5), 1.0, 1.0)[0].phase == "approach"
    assert step(Attempt(phase="wait", charge=0.5), at(1.56), 1.0, 0.49)[0].phase == "wait"
    assert step(waiting, at(1.56), 1.0, None)[0].phase == "wait"


def test_after_the_last_try_it_gives_up() -> None:
    docking = Docking(PARAMS, name="docking")
    docking.select(STATION)
    attempt = Attempt(phase="wait", number=len(SIDES) - 1)
    docking._attempt, _ = step(attempt, at(1.56), 30.0)
    assert (docking.progress().outcome, docking.progress().detail) == (
        "blocked",
        "nothing charges there; tried 5 times",
    )
    assert step(docking._attempt, at(1.56), 31.0)[1] is None


@given(phases, st.integers(0, 2), st.floats(0.0, 3.0), st.floats(-2.0, 2.0), st.floats(-3.0, 3.0))
def test_its_vector_is_short_and_mirrors(phase: str, number: int, x: float, y: float, heading: float) -> None:
    other = SIDES.index(-SIDES[number])
    one = step(Attempt(phase=phase, number=number, nearest_m=0.70), at(x, y, heading))  # type: ignore[arg-type]
    two = step(Attempt(phase=phase, number=other, nearest_m=0.70), at(x, -y, -heading))  # type: ignore[arg-type]
    assert one[0].phase == two[0].phase
    if one[1] is not None and two[1] is not None:
        assert hypot(one[1].forward, one[1].left) <= 0.6 + 1e-9
        assert abs(one[1].turn_radps) <= PARAMS.turn_radps
        assert two[1].forward == pytest.approx(one[1].forward)
        assert (two[1].left, two[1].turn_radps) == (pytest.approx(-one[1].left), pytest.approx(-one[1].turn_radps))


def test_wrong_parameters_are_refused() -> None:
    with pytest.raises(MissionError, match=r"docking takes \(x_m, y_m, heading_rad\), numbers; it was given 2"):
        Docking(PARAMS, name="docking").select((1.0, 2.0))
    with pytest.raises(MissionError, match="strength"):
        DockingParams(strength=1.0)


MISSION = """
[robot]
use = "sim.simulated:SimulatedRobot"
robot = "{robot}"
start_x_m = 4.6
start_y_m = 1.4
start_heading_deg = 0
start_charge_fraction = 0.5
[[knowledge_source]]
use = "knowledge_sources.odometry_pose:OdometryPose"
[[behaviour]]
use = "behaviours.avoid_obstacles:AvoidObstacles"
[[behaviour]]
use = "behaviours.docking:Docking"
inhibits = ["random_wander"]
{params}
[[behaviour]]
use = "behaviours.random_wander:RandomWander"
[coordinator]
use = "behaviours.arbitration_network:ArbitrationNetwork"
"""


def docked(folder: Path, robot: str, x_m: float, seed: int = 1, params: str = "", until_s: float = 150.0) -> Run:
    """Dock in the lab; the station is believed to be at `x_m`."""
    (folder / "m.toml").write_text(MISSION.format(robot=robot, params=params), encoding="utf-8")
    run = Run(load_mission(folder / "m.toml"), RunOptions(seed=seed, strict=True))
    motivation = Motivation(on=True, number=1, parameters=(x_m, 0.0, -pi / 2))
    run.board.post(MOTIVATION, motivation, id="docking", source="test")
    run.cycle()
    while run.board.now_s < until_s and status(run).outcome == "underway":
        run.cycle()
    return run


def status(run: Run) -> BehaviourStatus:
    entry = run.board.newest(BEHAVIOUR, "docking")
    assert entry is not None
    return entry.value


def charge(run: Run) -> float:
    entry = run.board.newest(BATTERY)
    assert entry is not None
    return entry.value.charge_fraction


@pytest.mark.parametrize(("robot", "seed"), [("k2a", 1), ("k2a", 2), ("pioneer", 1)])
def test_in_the_lab_it_docks_stays_and_charges_and_wanders_on_when_told(tmp_path: Path, robot: str, seed: int) -> None:
    run = docked(tmp_path, robot, 4.3, seed)
    board, before = run.board, run.robot.true_pose()
    assert (status(run).outcome, status(run).detail) == ("reached", "the battery charges")
    assert board.now_s < 60.0
    begun = charge(run)
    for _ in range(300):
        run.cycle()
    assert charge(run) > begun + 0.005
    assert run.robot.true_pose() == before
    assert run.robot.summary()["collisions"] == 0
    assert board.newest(RESPONSE, "random_wander") is None
    told = board.newest(SWITCH, "avoid_obstacles.docking")
    assert told is not None
    assert told.value == Switch(threshold=PARAMS.docking_threshold)
    board.post(MOTIVATION, Motivation(on=False, number=2), id="docking", source="test")
    for _ in range(100):
        run.cycle()
    assert board.newest(SWITCH, "avoid_obstacles.docking") is None
    assert run.robot.true_pose() != before
    assert run.robot.summary()["collisions"] == 0


def test_a_station_that_stands_a_little_beside_is_found(tmp_path: Path) -> None:
    run = docked(tmp_path, "k2a", 4.47)
    assert status(run).outcome == "reached"
    assert run.board.now_s > 30.0  # not at the first try
    assert run.robot.summary()["collisions"] == 0


def test_without_a_word_to_avoid_obstacles_it_does_not_get_there(tmp_path: Path) -> None:
    run = docked(tmp_path, "k2a", 4.3, params="lining_threshold = 0\ndocking_threshold = 0", until_s=60.0)
    assert status(run).outcome != "reached"


def test_on_the_last_piece_it_is_the_safety_layer_that_stops_the_robot(tmp_path: Path) -> None:
    slowed = []
    (tmp_path / "m.toml").write_text(MISSION.format(robot="k2a", params=""), encoding="utf-8")
    run = Run(load_mission(tmp_path / "m.toml"), RunOptions(seed=1, strict=True))
    run.board.subscribe(run.board.key(DRIVE), lambda entry: slowed.append(entry.value.limited_by))
    motivation = Motivation(on=True, number=1, parameters=(4.3, -0.1, -pi / 2))  # a little behind the wall
    run.board.post(MOTIVATION, motivation, id="docking", source="test")
    run.run(30.0)
    assert "clearance" in slowed
    assert run.robot.summary()["collisions"] == 0
