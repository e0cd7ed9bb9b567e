"""A recording as a robot: clock, latencies, cones, body, figures."""

from collections.abc import Callable
from itertools import pairwise
from math import inf, nan, pi, radians
from pathlib import Path
from typing import Any

import pytest

from blackboard.board import Board
from blackboard.component import Reading
from blackboard.errors import MissionError, RecordingError
from blackboard.kinds import LASER_SCAN, ODOMETRY, ROBOT, SONAR_SCAN
from blackboard.messages.sensing import LaserScan, SonarScan
from blackboard.vocabulary import Vocabulary
from sim.recordings.recorded import RecordedRobot, RecordedRobotParams

Write = Callable[..., Path]


def robot(path: Path, **params: Any) -> RecordedRobot:
    return RecordedRobot(RecordedRobotParams(path=path, **params), name="robot")


@pytest.fixture
def log(tmp_path: Path, small_log: list[str]) -> Path:
    path = tmp_path / "small.log"
    path.write_text("\n".join(small_log))
    return path


def test_readings_come_when_their_time_has_come(log: Path) -> None:
    recorded = robot(log)
    assert (recorded.start_s, recorded.end_s, recorded.moves) == (1000.0, 1001.0, False)
    assert list(recorded.advance(999.9)) == []
    assert [r.stamp_s for r in recorded.advance(1000.25)] == [1000.0, 1000.1, 1000.2]
    later = list(recorded.advance(1000.5))
    assert [r.kind for r in later] == [ODOMETRY, ODOMETRY, ODOMETRY, ODOMETRY, LASER_SCAN]
    assert len(list(recorded.advance(1e9))) == 7
    assert list(recorded.advance(2e9)) == []


def test_pieces_add_up_to_the_whole(log: Path) -> None:
    whole = list(robot(log).advance(inf))
    for step_s in (0.03, 0.1, 0.25):
        pieces: list[Reading[Any]] = []
        recorded = robot(log)
        for i in range(60):
            pieces += recorded.advance(1000.0 + i * step_s)
        assert pieces == whole


def test_the_beginning_can_be_left_out(log: Path) -> None:
    whole, late = list(robot(log).advance(inf)), robot(log, skip_s=0.45)
    assert (late.start_s, late.end_s) == (1000.45, 1001.0)
    assert list(late.advance(1000.45)) == []
    assert list(late.advance(inf)) == [r for r in whole if r.stamp_s >= 1000.45]
    shifted = robot(log, skip_s=0.55, laser_latency_s=0.2)  # from 1000.35 on; the scan heard at 1000.5 was taken before
    assert LASER_SCAN not in [r.kind for r in shifted.advance(1000.55)]
    with pytest.raises(RecordingError, match=r"small.log: skip_s = 2 leaves nothing of 1\.0 s; skip less"):
        robot(log, skip_s=2.0)
    with pytest.raises(MissionError, match=r"skip_s = -1"):
        RecordedRobotParams(path=log, skip_s=-1.0)


def test_a_kind_of_sensor_can_be_left_out(log: Path) -> None:
    whole, blind = robot(log), robot(log, leave_out="laser")
    assert tuple(blind.provides) == (ODOMETRY,)
    assert blind.description.lasers == ()
    odometry = [r for r in whole.advance(inf) if r.kind is ODOMETRY]
    assert [r.value for r in blind.advance(inf)] == [r.value for r in odometry]
    with pytest.raises(MissionError, match=r"leave_out = 'lasers' is outside 'laser', 'sonar' or nothing"):
        RecordedRobotParams(path=log, leave_out="lasers")
    with pytest.raises(MissionError, match=r"leave_out = 'sonar' is outside nothing: cones are made of the laser"):
        RecordedRobotParams(path=log, leave_out="sonar", cones=4)


def test_poses_of_one_stamp_are_told_apart_in_the_files_order(tmp_path: Path, small_log: list[str]) -> None:
    lines = [line.replace("1000.400000", "1000.500000").replace("1000.600000", "1000.500000") for line in small_log]
    path = tmp_path / "ties.log"
    path.write_text("\n".join(lines))
    heard = list(robot(path).advance(1000.55))
    poses = [(r.stamp_s, r.value.pose.x_m) for r in heard if r.kind is ODOMETRY]
    assert all(b[0] - a[0] > 0.5e-6 for a, b in pairwise(poses))
    tied = [r for r in heard if r.stamp_s > 1000.45]
    assert [r.stamp_s for r in tied] == pytest.approx([1000.5] * len(tied), abs=1e-5)
    scan = next(i for i, r in enumerate(tied) if r.kind is LASER_SCAN)
    assert tied[scan].stamp_s == tied[scan - 1].stamp_s
    assert tied[scan + 1].stamp_s > tied[scan].stamp_s


def test_scan_and_description_of_a_log(log: Path) -> None:
    recorded = robot(log)
    assert tuple(recorded.provides) == (ODOMETRY, LASER_SCAN)
    assert recorded.description.name == "small"
    assert recorded.description.radius_m == 0.25
    scan = next(r.value for r in recorded.advance(inf) if r.kind is LASER_SCAN)
    assert isinstance(scan, LaserScan)
    assert scan.angle_min_rad == pytest.approx(-pi / 2)
    assert (scan.ranges_m[0], scan.ranges_m[1], scan.ranges_m[179]) == (None, 2.5, None)


def test_latency_is_taken_off_the_stamp_but_not_off_the_arrival(log: Path) -> None:
    recorded = robot(log, laser_latency_s=0.2)
    assert recorded.start_s == pytest.approx(999.8)
    early = list(recorded.advance(1000.45))
    assert all(r.kind is ODOMETRY for r in early)
    scan = next(r for r in recorded.advance(1000.55) if r.kind is LASER_SCAN)
    assert scan.stamp_s == pytest.approx(1000.3)


def test_cones_turn_the_laser_into_sonars(log: Path) -> None:
    recorded = robot(log, cones=12, max_range_m=10.0)
    assert tuple(recorded.provides) == (ODOMETRY, SONAR_SCAN)
    assert recorded.description.lasers == ()
    assert [s.cone_rad for s in recorded.description.sonars] == pytest.approx([radians(15)] * 12)
    assert {s.max_range_m for s in recorded.description.sonars} == {10.0}
    scans = [r.value for r in recorded.advance(inf) if r.kind is SONAR_SCAN]
    assert scans == [SonarScan(sensors=tuple(range(12)), ranges_m=(2.5,) * 12)] * 2


def test_nothing_comes_back_from_beyond_the_reach(log: Path) -> None:
    recorded = robot(log, max_range_m=2.0)
    assert recorded.description.lasers[0].max_range_m == 2.0
    scan = next(r.value for r in recorded.advance(inf) if r.kind is LASER_SCAN)
    assert set(scan.ranges_m) == {None}


def test_robot_file_gives_body_and_reach(log: Path) -> None:
    recorded = robot(log, robot=Path("k2a"), cones=6)
    assert recorded.description.radius_m == 0.3
    assert {s.max_range_m for s in recorded.description.sonars} == {10.0}
    assert robot(log, robot=Path("k2a"), radius_m=0.2).description.radius_m == 0.2


def test_robot_file_gives_latencies(log: Path, tmp_path: Path) -> None:
    toml = tmp_path / "slow.toml"
    toml.write_text(
        "[body]\nname = 'slow'\nradius_m = 0.2\nmax_speed_mps = 1\nmax_turn_radps = 1\nmax_acceleration_mps2 = 1\n"
        "max_turn_acceleration_radps2 = 1\n[[laser]]\nbeams = 180\nfield_deg = 180\nmax_range_m = 8\nlatency_s = 0.1\n"
    )
    stamps = [r.stamp_s for r in robot(log, robot=toml).advance(inf) if r.kind is LASER_SCAN]
    assert stamps == pytest.approx([1000.4, 1000.9])
    stamps = [r.stamp_s for r in robot(log, robot=toml, laser_latency_s=0.0).advance(inf) if r.kind is LASER_SCAN]
    assert stamps == pytest.approx([1000.5, 1001.0])


def test_more_cones_than_beams(log: Path) -> None:
    with pytest.raises(RecordingError, match="cones = 181 is more than 180"):
        robot(log, cones=181)


def test_cones_without_a_laser_and_beside_sonars(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    sonar = ("/sonar", 1.0, ros2.range(1.0, "base_link", 2.0))
    scan = ("/scan", 1.1, ros2.scan(1.1, "base_link", [1.0, 2.0, 3.0, 4.0]))
    with pytest.raises(RecordingError, match="no laser to thin"):
        robot(write_bag(tmp_path / "sonar", [sonar]), cones=2)
    recorded = robot(write_bag(tmp_path / "both", [sonar, scan]), cones=2)
    assert [r.value for r in recorded.advance(inf) if r.kind is SONAR_SCAN] == [
        SonarScan(sensors=(0, 1), ranges_m=(1.0, 3.0))
    ]
    assert "left out" in str(recorded.summary()["notes"])


def test_cones_of_two_lasers_are_numbered_through(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    messages = [
        ("/front", 1.0, ros2.scan(1.0, "base_link", [1.0, 2.0])),
        ("/rear", 1.1, ros2.scan(1.1, "base_link", [3.0, nan])),
    ]
    scans = [
        r.value for r in robot(write_bag(tmp_path / "two", messages), cones=2).advance(inf) if r.kind is SONAR_SCAN
    ]
    assert scans == [SonarScan(sensors=(0, 1), ranges_m=(1.0, 2.0)), SonarScan(sensors=(2,), ranges_m=(3.0,))]


def test_without_odometry_it_stands_still_and_says_so(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    recorded = robot(write_bag(tmp_path / "still", [("/scan", 5.0, ros2.scan(5.0, "base_link", [1.0, 2.0]))]))
    assert [r.kind for r in recorded.advance(inf)] == [ODOMETRY, LASER_SCAN]
    assert "stand still" in str(recorded.summary()["notes"])


def test_stamps_of_a_kind_never_run_back(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    messages = [
        ("/a", 1.00, ros2.scan(1.00, "base_link", [1.0, 2.0])),
        ("/b", 1.01, ros2.scan(0.95, "base_link", [1.0, 2.0])),
        ("/a", 1.10, ros2.scan(1.10, "base_link", [1.0, 2.0])),
    ]
    recorded = robot(write_bag(tmp_path / "delayed", messages))
    stamps = [r.stamp_s for r in recorded.advance(inf) if r.kind is LASER_SCAN]
    assert stamps == [1.0, 1.0, 1.1]
    assert recorded.summary()["stamps_repaired"] == 1


def test_every_reading_can_stand_on_the_board(log: Path) -> None:
    for params in ({}, {"cones": 12, "laser_latency_s": 0.05}):
        recorded = robot(log, **params)
        board = Board(Vocabulary(), robot=recorded.description.name)
        board.post(ROBOT, recorded.description, source="robot")
        for cycle in range(12):
            now_s = recorded.start_s + 0.1 * cycle
            for reading in recorded.advance(now_s):
                board.now_s = max(board.now_s, reading.stamp_s)
                board.post(reading.kind, reading.value, source="robot", stamp_s=reading.stamp_s)
        newest = board.newest(ODOMETRY)
        assert newest is not None
        assert newest.value.pose.x_m == 1.0
        assert board.newest(recorded.provides[1]) is not None


@pytest.mark.parametrize(
    ("key", "value"),
    [("cones", -1), ("cones", 257), ("sonar_latency_s", -0.1), ("radius_m", 0.0), ("max_range_m", nan)],
)
def test_parameters_out_of_their_limits(key: str, value: float) -> None:
    with pytest.raises(MissionError, match=key):
        RecordedRobotParams(**{"path": Path("x"), key: value})
