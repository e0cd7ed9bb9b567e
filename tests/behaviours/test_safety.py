from math import isfinite, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.near_echoes import Near
from behaviours.safety import (
    ReflexSafety,
    ReflexSafetyParams,
    leads_away,
    limit_by_clearance,
    reflex_limit,
    stopping_speed_mps,
    watched,
)
from blackboard.errors import MissionError
from blackboard.messages.geometry import Pose
from blackboard.messages.motion import Drive, Velocity
from blackboard.messages.sensing import LaserScan, RobotDescription

PARAMS = ReflexSafetyParams()
ROBOT = RobotDescription(
    name="r", radius_m=0.3, max_speed_mps=1.0, max_turn_radps=2.0, max_acceleration_mps2=0.5, bumper=True
)
HALF_WIDTH_M = ROBOT.radius_m + PARAMS.margin_m
echoes = st.lists(
    st.tuples(st.floats(0.0, 1.6), st.floats(-3.14, 3.14), st.booleans(), st.floats(0.0, 5.0)), max_size=12
)
clear = dict.fromkeys(range(12))


def near(
    range_m: float, bearing_rad: float, *, settled: bool = True, age_s: float = 0.0, half_cone_rad: float = 0.0
) -> Near:
    return (range_m + ROBOT.radius_m, bearing_rad, half_cone_rad, -age_s, settled)


def go(forward_mps: float, turn_radps: float = 0.0, valid_until_s: float = 0.5) -> Velocity:
    return Velocity(forward_mps=forward_mps, turn_radps=turn_radps, valid_until_s=valid_until_s)


def limited(
    nears: list[Near], forward_mps: float = 0.4, turn_radps: float = 0.0, touched: tuple[float, ...] = ()
) -> Drive:
    return reflex_limit(go(forward_mps, turn_radps), nears, touched, True, ROBOT, 0.0, PARAMS)


def stopping_m(speed_mps: float) -> float:
    braking_mps2 = PARAMS.braking_fraction * ROBOT.max_acceleration_mps2
    return speed_mps * PARAMS.reaction_s + speed_mps**2 / (2 * braking_mps2)


def test_a_clear_way_lets_everything_through() -> None:
    assert limited([], 0.4, 0.7) == Drive(forward_mps=0.4, turn_radps=0.7, limited_by="nothing")


def test_stopping_distance_worked_by_hand() -> None:
    # 0.5 m/s, 0.2 s to react, 0.5 m/s^2: 0.1 + 0.25 = 0.35 m; with 1 m/s closing in, another 1.0 * (0.2 + 1.0) = 1.2 m
    assert stopping_speed_mps(0.35, 0.0, 0.0, 0.5, 0.2) == pytest.approx(0.5)
    assert stopping_speed_mps(1.55, 1.0, 0.0, 0.5, 0.2) == pytest.approx(0.5)
    assert stopping_speed_mps(1.65, 1.0, 0.1, 0.5, 0.2) == pytest.approx(0.5)
    assert stopping_speed_mps(0.0, 0.0, 0.0, 0.5, 0.2) == 0.0
    assert stopping_speed_mps(0.2, 1.0, 0.0, 0.5, 0.2) == 0.0


@given(st.floats(0.0, 1.6))
def test_it_always_stops_short_of_what_stands_ahead(range_m: float) -> None:
    drive = limited([near(range_m, 0.0)])
    assert stopping_m(drive.forward_mps) <= max(0.0, range_m - PARAMS.margin_m) + 1e-9
    if drive.forward_mps < 0.4:
        assert drive.limited_by == "clearance"
        assert drive.clearance_m == pytest.approx(max(0.0, range_m - PARAMS.margin_m))


def test_the_width_of_the_robot_counts_not_just_the_ray_ahead() -> None:
    grazing = (0.5, 0.6, 0.0, 0.0, True)  # 0.28 m to the side, 0.41 m ahead
    drive = limited([grazing])
    assert drive.clearance_m == pytest.approx(
        0.4127 - 0.2234, abs=1e-3
    )  # the shoulder is 0.22 m ahead of the centre there
    assert stopping_m(drive.forward_mps) == pytest.approx(drive.clearance_m)
    passing = (0.5, 0.85, 0.0, 0.0, True)  # 0.376 m to the side
    assert limited([passing]).forward_mps == 0.4


def test_a_turn_sweeps_more_than_the_way_ahead() -> None:
    aside = (0.5, 0.85, 0.0, 0.0, True)
    assert limited([aside], turn_radps=0.8).forward_mps < 0.4
    assert limited([aside], turn_radps=-0.8).forward_mps == 0.4


def test_a_fresh_echo_may_lie_anywhere_in_its_cone() -> None:
    assert limited([near(0.2, 0.85, half_cone_rad=0.2)]).forward_mps < 0.4
    assert limited([near(0.2, 0.85, half_cone_rad=0.2, age_s=1.0)]).forward_mps == 0.4


def test_what_was_heard_just_now_may_walk_into_the_way() -> None:
    assert limited([near(0.8, 0.0)]).forward_mps == 0.4
    assert limited([near(0.8, 0.0, settled=False)]).forward_mps < 0.25
    assert limited([near(0.3, 1.5)]).forward_mps == 0.4
    assert limited([near(0.3, 1.5, settled=False)]).forward_mps < 0.05
    assert limited([near(0.3, 1.5, settled=False, age_s=1.0)]).forward_mps == 0.4
    assert limited([near(0.3, 2.5, settled=False)]).forward_mps == 0.4


def test_backwards_what_lies_behind_counts() -> None:
    assert limited([near(0.1, 0.0)], -0.2).forward_mps == -0.2
    assert stopping_m(-limited([near(0.1, pi)], -0.2).forward_mps) == pytest.approx(0.1 - PARAMS.margin_m)


def test_turning_on_the_spot_is_always_let_through() -> None:
    drive = limited([near(0.0, i * 0.3) for i in range(20)], 0.4, 0.7)
    assert (drive.forward_mps, drive.turn_radps, drive.limited_by) == (0.0, 0.7, "clearance")


def test_without_a_command_it_stands() -> None:
    stop = Drive(forward_mps=0.0, turn_radps=0.0, limited_by="no command")
    assert reflex_limit(None, [], (), True, ROBOT, 0.0, PARAMS) == stop
    assert reflex_limit(go(0.4, valid_until_s=0.99), [], (), True, ROBOT, 1.0, PARAMS) == stop


def test_from_a_contact_it_may_only_move_away_and_slowly() -> None:
    ahead = limited([], 0.4, 0.5, touched=(0.1,))
    assert (ahead.forward_mps, ahead.turn_radps, ahead.limited_by) == (0.0, 0.5, "bumper")
    away = limited([], -0.4, touched=(0.1,))
    assert (away.forward_mps, away.limited_by) == (-PARAMS.creep_mps, "bumper")
    assert limited([], 0.4, touched=(pi / 2,)).forward_mps == 0.0
    assert limited([], -0.4, touched=(0.1, pi)).forward_mps == 0.0
    assert not leads_away(0.0, (pi, 0.5))


def test_a_way_that_no_fresh_sensor_watches_is_not_taken() -> None:
    drive = reflex_limit(go(0.4, 0.5), [], (), False, ROBOT, 0.0, PARAMS)
    assert (drive.forward_mps, drive.turn_radps, drive.limited_by) == (0.0, 0.5, "stale readings")


def test_which_directions_are_watched(make_bench) -> None:
    robot = make_bench(laser=True).robot
    assert watched(0.0, {0: 5.0}, None, robot, 4.5)
    assert not watched(0.0, {0: 4.4}, None, robot, 4.5)
    assert not watched(pi, {0: 5.0}, None, robot, 4.5)
    assert watched(pi, {6: 5.0}, None, robot, 4.5)
    scan = LaserScan(angle_min_rad=-pi / 2, angle_step_rad=pi / 180, ranges_m=(1.0,) * 181)
    assert watched(0.0, {}, scan, robot, 4.5)
    assert not watched(pi, {}, scan, robot, 4.5)
    assert not watched(0.0, {77: 5.0}, None, robot, 4.5)


@given(echoes, st.floats(-2.0, 2.0), st.floats(-3.0, 3.0), st.lists(st.floats(-3.0, 3.0), max_size=2))
def test_it_never_asks_for_more_than_was_wanted(
    points: list[tuple[float, float, bool, float]], forward: float, turn: float, touched: list[float]
) -> None:
    nears = [near(r, b, settled=s, age_s=a) for r, b, s, a in points]
    drive = limited(nears, forward, turn, tuple(touched))
    assert isfinite(drive.forward_mps)
    assert abs(drive.forward_mps) <= min(abs(forward), PARAMS.fastest_mps, ROBOT.max_speed_mps)
    assert drive.forward_mps * forward >= 0.0
    assert abs(drive.turn_radps) <= min(abs(turn), ROBOT.max_turn_radps)


@given(echoes, st.floats(0.05, 1.0), st.floats(-2.0, 2.0))
def test_a_mirrored_world_has_the_same_limit(
    points: list[tuple[float, float, bool, float]], forward: float, turn: float
) -> None:
    nears = [near(r, b, settled=s, age_s=a) for r, b, s, a in points]
    mirrored = [near(r, -b, settled=s, age_s=a) for r, b, s, a in points]
    one = limit_by_clearance(nears, forward, turn, 0.0, ROBOT, PARAMS)
    other = limit_by_clearance(mirrored, forward, -turn, 0.0, ROBOT, PARAMS)
    assert other == pytest.approx(one)


@given(echoes, st.floats(0.0, 1.6), st.floats(-3.14, 3.14))
def test_one_more_echo_never_makes_it_faster(
    points: list[tuple[float, float, bool, float]], range_m: float, bearing: float
) -> None:
    nears = [near(r, b, settled=s, age_s=a) for r, b, s, a in points]
    assert limited([*nears, near(range_m, bearing)]).forward_mps <= limited(nears).forward_mps


def test_through_the_board_it_drives_slows_and_stops(bench) -> None:
    safety = ReflexSafety(PARAMS, name="safety")
    assert safety.limit(go(0.4), bench.access).limited_by == "stale readings"
    for i in range(4):
        bench.at(0.2 * i).hear({**clear, 0: 0.3})
        drive = safety.limit(go(0.4, valid_until_s=9.0), bench.access)
    assert drive.limited_by == "clearance"
    assert stopping_m(drive.forward_mps) <= 0.24
    bench.at(0.8).hear(clear)  # the echo is lost, not forgotten
    assert safety.limit(go(0.4, valid_until_s=9.0), bench.access).limited_by == "clearance"
    bench.at(1.0, Pose(x_m=0.0, y_m=0.0, heading_rad=pi)).hear(clear)
    assert safety.limit(go(0.4, valid_until_s=9.0), bench.access).limited_by == "nothing"


def test_through_the_board_old_readings_stop_it(bench) -> None:
    safety = ReflexSafety(PARAMS, name="safety")
    bench.at(0.0).hear(clear)
    assert safety.limit(go(0.4), bench.access).limited_by == "nothing"
    late = PARAMS.stale_after_s + 0.1
    bench.at(late)  # odometry is fresh, the scan is old
    assert safety.limit(go(0.4, 0.5, late), bench.access) == Drive(
        forward_mps=0.0, turn_radps=0.0, limited_by="stale readings"
    )
    bench.hear(clear)
    assert safety.limit(go(0.4, 0.0, late), bench.access).limited_by == "nothing"
    bench.board.now_s = 2 * late
    bench.hear(clear)  # the scan is fresh, odometry is old
    assert safety.limit(go(0.4, 0.0, 9.0), bench.access).limited_by == "stale readings"


def test_through_the_board_sonars_that_fell_silent_close_their_direction(bench) -> None:
    safety = ReflexSafety(PARAMS, name="safety")
    for i in range(5):
        ahead_too = dict.fromkeys(range(12)) if i == 0 else dict.fromkeys(range(3, 10))
        bench.at(0.2 * i).hear(ahead_too)
        drive = safety.limit(go(0.4, 0.3, 9.0), bench.access)
        assert drive.turn_radps == 0.3
    assert (drive.forward_mps, drive.limited_by) == (0.0, "stale readings")
    assert safety.limit(go(-0.2, 0.0, 9.0), bench.access).forward_mps == -0.2


def test_through_the_board_a_contact_is_kept_in_mind(bench) -> None:
    safety = ReflexSafety(PARAMS, name="safety")
    bench.at(0.0).hear(clear).touch(0.0)
    assert safety.limit(go(0.4), bench.access).limited_by == "bumper"
    bench.at(0.2).hear(clear).touch()
    drive = safety.limit(go(0.4), bench.access)
    assert (drive.forward_mps, drive.limited_by) == (0.0, "clearance")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("margin_m", 0.0),
        ("reaction_s", 0.0),
        ("braking_fraction", 5.0),
        ("walking_mps", 0.0),
        ("fastest_mps", 100.0),
        ("creep_mps", 1.0),
        ("stale_after_s", 1e9),
    ],
)
def test_no_mission_can_switch_it_off(name: str, value: float) -> None:
    with pytest.raises(MissionError, match=name):
        ReflexSafetyParams(**{name: value})
