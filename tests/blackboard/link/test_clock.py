import pytest

from blackboard.errors import LinkError
from blackboard.link.clock import ClockAnswer, MissionClock


def test_the_answer_is_taken_for_the_middle_of_the_way():
    clock = MissionClock()
    clock.measured(100.0, 100.2, 1000.2, ClockAnswer(now_s=5.0, wall_s=1000.0))
    assert clock.at(100.1) == pytest.approx(5.0)
    assert clock.best.round_trip_s == pytest.approx(0.2)
    assert clock.best.wall_offset_s == pytest.approx(0.1)


def test_the_shortest_way_counts():
    clock = MissionClock()
    clock.measured(100.0, 100.5, 0.0, ClockAnswer(now_s=5.0, wall_s=0.0))
    clock.measured(101.0, 101.002, 0.0, ClockAnswer(now_s=6.0, wall_s=0.0))
    assert clock.at(102.001) == pytest.approx(7.0)


def test_the_clock_never_runs_back():
    clock = MissionClock()
    clock.measured(100.0, 100.2, 0.0, ClockAnswer(now_s=5.0, wall_s=0.0))
    before = clock.at(101.0)
    clock.measured(101.0, 101.1, 0.0, ClockAnswer(now_s=5.0, wall_s=0.0))
    assert clock.at(101.0) >= before


def test_a_mission_may_run_faster_than_the_clock_on_the_wall():
    clock = MissionClock()
    clock.measured(100.0, 100.0, 0.0, ClockAnswer(now_s=5.0, wall_s=0.0, pace=4.0))
    assert clock.at(101.0) == pytest.approx(9.0)


def test_before_the_robot_has_begun_there_is_no_time():
    clock = MissionClock()
    clock.measured(100.0, 100.0, 0.0, ClockAnswer(now_s=None, wall_s=0.0))
    assert not clock.running
    with pytest.raises(LinkError, match="has not begun"):
        clock.at(100.0)
