from math import cos, pi, sin

import pytest

from behaviours.near_echoes import Near, NearEchoes, NearEchoesParams, around, around_now, no_echoes, pose_at, refresh
from blackboard.access import Access
from blackboard.errors import MissionError
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import LaserScan, Odometry

EAST = Pose(x_m=0.0, y_m=0.0, heading_rad=0.0)
PARAMS = NearEchoesParams()


def sensed(memory: NearEchoes, board: Access) -> tuple[NearEchoes, list[Near]]:
    memory = refresh(memory, board, PARAMS)
    return memory, around_now(memory, board, PARAMS.reach_m)


def test_odometry_is_carried_along_its_arc() -> None:
    odometry = Odometry(pose=EAST, forward_mps=0.5, turn_radps=1.0)
    pose = pose_at(odometry, 10.0, 10.2)
    assert pose.heading_rad == pytest.approx(0.2)
    assert pose.x_m == pytest.approx(0.1, abs=1e-3)
    assert pose.y_m == pytest.approx(0.01, abs=1e-3)
    assert pose_at(odometry, 10.0, 10.0) == EAST


def test_odometry_is_not_carried_for_ever() -> None:
    assert pose_at(Odometry(pose=EAST, forward_mps=0.5), 0.0, 100.0).x_m == pytest.approx(0.5)


def test_an_echo_moves_as_the_robot_does(bench) -> None:
    bench.at(1.0).hear({0: 0.7})
    memory, nears = sensed(no_echoes(), bench.access)
    assert [(n[0], n[1]) for n in nears] == [(pytest.approx(1.0), pytest.approx(0.0))]
    bench.at(2.0, Pose(x_m=1.0, y_m=-0.5, heading_rad=pi / 2))
    _, nears = sensed(memory, bench.access)
    assert [(n[0], n[1]) for n in nears] == [(pytest.approx(0.5), pytest.approx(0.0, abs=1e-9))]


def test_a_reading_counts_from_where_the_robot_was_when_it_was_taken(bench) -> None:
    bench.at(1.0, Pose(x_m=0.5, y_m=0.0, heading_rad=0.0), forward_mps=0.5).hear({0: 0.7}, stamp_s=0.8)
    _, nears = sensed(no_echoes(), bench.access)
    assert nears[0][0] == pytest.approx(0.9)  # heard at x = 0.4


def test_an_echo_settles_when_it_stays(bench) -> None:
    memory = no_echoes()
    settled = []
    for i in range(4):
        bench.at(0.2 * i).hear({0: 0.7 + 0.01 * i})
        memory, nears = sensed(memory, bench.access)
        settled.append(any(n[4] for n in nears))
    assert settled == [False, False, True, True]


def test_what_comes_on_at_walking_speed_never_settles(bench) -> None:
    memory = no_echoes()
    for i in range(8):
        bench.at(0.2 * i).hear({0: 1.6 - 0.2 * i})
        memory, nears = sensed(memory, bench.access)
        assert not any(n[4] for n in nears)


def test_silence_does_not_clear_an_echo_but_readings_through_it_do(bench) -> None:
    bench.at(0.0).hear({0: 0.7})
    memory, _ = sensed(no_echoes(), bench.access)
    left = []
    for i, range_m in enumerate((None, None, None, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0), 1):
        bench.at(0.2 * i).hear({0: range_m})
        memory, nears = sensed(memory, bench.access)
        left.append(len(nears))
    assert left[:6] == [1] * 6  # every third look is taken into account
    assert left[8] == 0


def test_what_is_close_to_a_sensor_is_not_doubted(bench) -> None:
    bench.at(0.0).hear({0: 0.15})
    memory, _ = sensed(no_echoes(), bench.access)
    for i in range(1, 6):
        bench.at(0.2 * i).hear({0: 3.0})
        memory, nears = sensed(memory, bench.access)
        assert len(nears) == 1


def test_echoes_are_forgotten_with_time_and_distance(bench) -> None:
    bench.at(0.0).hear({0: 0.7})
    once, _ = sensed(no_echoes(), bench.access)
    bench.at(PARAMS.keep_new_s + 0.1).hear({6: None})
    assert sensed(once, bench.access)[1] == []
    bench.at(5.0).hear({0: 0.7})
    again, _ = sensed(no_echoes(), bench.access)
    bench.at(5.1, Pose(x_m=-2.0, y_m=0.0, heading_rad=0.0)).hear({6: None})
    assert sensed(again, bench.access)[1] == []


def test_every_scan_counts_when_several_came_since(bench) -> None:
    bench.at(0.0).hear({0: 0.7})
    memory, _ = sensed(no_echoes(), bench.access)
    bench.at(0.1).hear({3: 0.5}).hear({9: 0.6})
    memory, nears = sensed(memory, bench.access)
    assert len(nears) == 3
    assert sorted(memory.sonars_s) == [0, 3, 9]


def test_without_news_the_memory_stays_the_same_object(bench) -> None:
    bench.at(0.0).hear({0: 0.7})
    memory = refresh(no_echoes(), bench.access, PARAMS)
    bench.at(0.1)
    assert refresh(memory, bench.access, PARAMS) is memory


def test_the_memory_passed_in_is_left_as_it_was(bench) -> None:
    bench.at(0.0).hear({0: 0.7})
    before, _ = sensed(no_echoes(), bench.access)
    held = dict(before.echoes)
    bench.at(0.2).hear({0: 3.0, 5: 0.4})
    sensed(before, bench.access)
    assert before.echoes == held


def test_contacts_and_laser_echoes_are_remembered_too(make_bench) -> None:
    bench = make_bench(laser=True)
    scan = LaserScan(angle_min_rad=-pi / 2, angle_step_rad=pi / 2, ranges_m=(None, 0.4, None))
    bench.at(0.0).touch(pi / 2).sweep(scan)
    _, nears = sensed(no_echoes(), bench.access)
    found = sorted((n[1], n[0]) for n in nears)
    assert found == [(pytest.approx(0.0), pytest.approx(0.5)), (pytest.approx(pi / 2), pytest.approx(0.3))]


def test_a_board_without_readings_gives_nothing(bench) -> None:
    assert sensed(no_echoes(), bench.access)[1] == []
    assert around(no_echoes(), EAST, 2.0) == []


def test_a_memory_too_short_to_be_of_use_is_refused() -> None:
    with pytest.raises(MissionError, match=r"keep_s = 0\.5"):
        NearEchoesParams(keep_s=0.5)


def test_what_was_heard_before_a_gap_is_not_believed_any_more(bench) -> None:
    """A behaviour that rested does not know what has gone meanwhile; one that never asked for long does not either."""
    memory = no_echoes()
    for i in range(5):
        bench.at(0.2 * i).hear({0: 0.7, 3: 0.5})
        memory, nears = sensed(memory, bench.access)
    assert len(nears) == 2
    for i in range(5, 18):
        bench.at(0.2 * i).hear({6: 0.8})
    after, nears = sensed(memory, bench.access)
    assert [n[1] for n in nears] == [pytest.approx(-pi)]
    kept = refresh(memory, bench.access, NearEchoesParams(gap_s=60.0))
    assert len(kept.echoes) == 3
    assert after.read_s == kept.read_s == pytest.approx(3.4)


def test_readings_from_before_the_newest_second_are_left_out_of_a_memory_that_wakes(bench) -> None:
    bench.at(0.0).hear({0: 0.7})
    memory, _ = sensed(no_echoes(), bench.access)
    for i in range(1, 9):  # it drives on at 0.5 m/s, nobody asks, and the wall abeam ends
        x_m = 0.1 * i
        bench.at(0.2 * i, Pose(x_m=x_m, y_m=0.0, heading_rad=0.0), forward_mps=0.5).hear(
            {3: 0.5} if i < 3 else {9: 0.6}
        )
    _, nears = sensed(memory, bench.access)
    places = sorted((round(0.8 + n[0] * cos(n[1]), 2), round(n[0] * sin(n[1]), 2)) for n in nears)
    assert places == [(0.3, -0.9), (0.4, -0.9), (0.5, -0.9), (0.6, -0.9), (0.7, -0.9), (0.8, -0.9), (1.0, 0.0)]
