"""CARMEN logs, line by line and whole."""

import gzip
from math import pi, radians
from pathlib import Path

import numpy as np
import pytest

from blackboard.messages.sensing import Odometry
from sim.recordings.carmen import CarmenLog
from sim.recordings.carmen_lines import parse_line
from sim.recordings.recording import Echoes, Sweep

TAIL = "10.5 host 0.5"


def test_odometry_line() -> None:
    line = parse_line(f"ODOM 1.0 -2.0 7.0 0.3 -0.1 0.0 {TAIL}".split())
    assert line is not None
    assert line.odometry is not None
    assert line.stamp_s == 10.5
    assert (line.odometry.pose.x_m, line.odometry.pose.y_m) == (1.0, -2.0)
    assert line.odometry.pose.heading_rad == pytest.approx(7.0 - 2 * pi)
    assert (line.odometry.forward_mps, line.odometry.turn_radps) == (0.3, -0.1)


@pytest.mark.parametrize(
    ("beams", "start_deg", "step_deg"),
    [(180, -90, 1), (181, -90, 1), (361, -90, 0.5), (360, -90, 0.5), (401, -50, 0.25), (91, -90, 2)],
)
def test_beams_of_old_laser_lines(beams: int, start_deg: float, step_deg: float) -> None:
    line = parse_line(f"FLASER {beams} {' '.join(['1.5'] * beams)} 1 2 0.1 1 2 0.1 {TAIL}".split())
    assert line is not None
    assert line.fan is not None
    assert line.fan.angle_min_rad == pytest.approx(radians(start_deg))
    assert line.fan.angle_step_rad == pytest.approx(radians(step_deg))
    assert line.ranges == [1.5] * beams


def test_new_laser_lines_tell_their_own_geometry() -> None:
    geometry = "0 -2.0944 4.18879 0.0174533 30.0 0.01 0"
    ranges, remissions = " ".join(["3.25"] * 241), "2 0.1 0.2"
    line = parse_line(
        f"ROBOTLASER1 {geometry} 241 {ranges} {remissions} 1.1 2 0.5 1 2 0.5 0.4 0.05 0.3 0.3 1e6 {TAIL}".split()
    )
    raw = parse_line(f"RAWLASER2 {geometry} 241 {ranges} {remissions} {TAIL}".split())
    assert line is not None
    assert raw is not None
    assert line.fan == raw.fan
    assert line.fan is not None
    assert (line.fan.angle_min_rad, line.fan.angle_step_rad) == (-2.0944, 0.0174533)
    assert line.max_range_m == raw.max_range_m == 30.0
    assert line.stamp_s == raw.stamp_s == 10.5
    assert line.odometry is not None
    assert (line.odometry.pose.x_m, line.odometry.forward_mps, line.odometry.turn_radps) == (1.0, 0.4, 0.05)
    assert raw.odometry is None


def test_sonar_line() -> None:
    line = parse_line(f"SONAR 0.26 2 1.5 2.5 0.1 0.2 0.5 0.1 -0.2 -0.5 {TAIL}".split())
    assert line is not None
    assert line.ranges == [1.5, 2.5]
    assert line.cone_rad == 0.26
    assert [m.heading_rad for m in line.mounts] == [0.5, -0.5]


def test_other_tags_are_none() -> None:
    assert parse_line(["SYNC", "logger", "1", "host", "2"]) is None


@pytest.mark.parametrize(
    "text",
    [
        "ODOM 1.0 2.0 0.1 0 0 0 97605",
        "ODOM 1.0 two 0.1 0 0 0 10.5 host 0.5",
        "ODOM nan 2.0 0.1 0 0 0 10.5 host 0.5",
        "ODOM 1.0 2.0 0.1 1e9 0 0 10.5 host 0.5",
        "FLASER 180 1.0 2.0 10.5 host 0.5",
        "FLASER -3 1 2 0.1 1 2 0.1 10.5 host 0.5",
        "ROBOTLASER1 0 -1.57 3.14",
        "SONAR 0 1 1.5 0 0 0 10.5 host 0.5",
    ],
)
def test_damaged_lines(text: str) -> None:
    with pytest.raises((ValueError, IndexError)):
        parse_line(text.split())


@pytest.mark.parametrize("zipped", [False, True])
def test_odometry_comes_before_the_scan_of_its_line(tmp_path: Path, small_log: list[str], zipped: bool) -> None:
    path = tmp_path / "misnamed.bag"
    data = ("\n".join(small_log) + "\n").encode()
    path.write_bytes(gzip.compress(data) if zipped else data)
    log = CarmenLog(path)
    heard = list(log.replay())
    assert [type(h.value) for h in heard[4:8]] == [Odometry, Odometry, Odometry, Sweep]
    assert [h.stamp_s for h in heard[5:8]] == [1000.5] * 3
    sweep = heard[7].value
    assert isinstance(sweep, Sweep)
    assert np.isinf(sweep.ranges[[0, 179]]).all()
    assert (sweep.ranges[1:179] == 2.5).all()
    assert log.counts == {"lines_read": 14, "lines_skipped": 0, "stamps_repaired": 0, "ranges_invalid": 0}
    assert log.lasers[0].mount.x_m == 0.0


def test_file_order_stays_and_stamps_are_repaired(tmp_path: Path, small_log: list[str]) -> None:
    back = [line.replace("1000.300000", "976.300000") for line in small_log]
    path = tmp_path / "back.log"
    path.write_text("\n".join(back))
    log = CarmenLog(path)
    xs = [(h.stamp_s, h.value.pose.x_m) for h in log.replay() if isinstance(h.value, Odometry)]
    assert [x for _, x in xs] == sorted(x for _, x in xs)
    assert xs[3] == (pytest.approx(1000.3), 0.3)
    assert log.counts["stamps_repaired"] == 1


def test_cut_lines_are_skipped_and_counted(tmp_path: Path, small_log: list[str]) -> None:
    cut = [*small_log[:7], small_log[7][:30], "%%", *small_log[8:-1], small_log[-1][:200]]
    path = tmp_path / "cut.log"
    path.write_text("\n".join(cut))
    log = CarmenLog(path)
    assert log.counts["lines_skipped"] == 3
    assert sum(isinstance(h.value, Sweep) for h in log.replay()) == 1


def test_ranges_that_are_no_ranges(tmp_path: Path) -> None:
    ranges = "-1 nan inf 0 2 " + " ".join(["1"] * 175)
    path = tmp_path / "odd.log"
    path.write_text(f"FLASER 180 {ranges} 0 0 0 0 0 0 {TAIL}\n")
    log = CarmenLog(path)
    sweep = list(log.replay())[1].value
    assert isinstance(sweep, Sweep)
    assert np.isnan(sweep.ranges[[0, 1, 3]]).all()
    assert sweep.ranges[[2, 4]].tolist() == [np.inf, 2.0]
    assert log.counts["ranges_invalid"] == 3


def test_mount_is_what_the_lines_agree_on(tmp_path: Path) -> None:
    ranges = " ".join(["1"] * 180)
    lines = [f"FLASER 180 {ranges} {0.1 * i} 0.2 1.57079633 {0.1 * i} 0 1.57079633 {i} h 0" for i in range(5)]
    path = tmp_path / "mount.log"
    path.write_text("\n".join(lines))
    mount = CarmenLog(path).lasers[0].mount
    assert (mount.x_m, mount.y_m, mount.heading_rad) == pytest.approx((0.2, 0.0, 0.0), abs=1e-6)


def test_corrected_poses_are_no_mount(tmp_path: Path) -> None:
    ranges = " ".join(["1"] * 180)
    lines = [f"FLASER 180 {ranges} {0.1 * i} {0.05 * i} 0 {0.1 * i} 0 0 {i} h 0" for i in range(9)]
    path = tmp_path / "corrected.log"
    path.write_text("\n".join(lines))
    log = CarmenLog(path)
    assert log.lasers[0].mount.y_m == 0.0
    assert "corrected" in log.notes[0]


def test_rear_laser_looks_back(tmp_path: Path, small_log: list[str]) -> None:
    rear = [line.replace("FLASER", "RLASER") for line in small_log if line.startswith("FLASER")]
    path = tmp_path / "two.log"
    path.write_text("\n".join(small_log + rear))
    log = CarmenLog(path)
    assert [laser.mount.heading_rad for laser in log.lasers] == [0.0, pytest.approx(pi)]
    assert {h.value.laser for h in log.replay() if isinstance(h.value, Sweep)} == {0, 1}


def test_raw_scans_are_left_where_the_same_scans_have_poses(tmp_path: Path, small_log: list[str]) -> None:
    raw = f"RAWLASER1 0 -1.57 3.14 0.0174 81.9 0.01 0 3 1 2 3 0 {TAIL}"
    path = tmp_path / "both.log"
    path.write_text("\n".join([raw, *small_log, raw]))
    assert sum(isinstance(h.value, Sweep) for h in CarmenLog(path).replay()) == 2
    path.write_text(raw)
    log = CarmenLog(path)
    assert [type(h.value) for h in log.replay()] == [Sweep]
    assert Odometry not in log.first_s


def test_sonars_of_a_log(tmp_path: Path) -> None:
    path = tmp_path / "sonar.log"
    sonar = f"SONAR 0.26 2 1.5 4.0 0.1 0.2 0.5 0.1 -0.2 -0.5 {TAIL}"
    path.write_text(f"PARAM robot_max_sonar 4.0 h 0\n{sonar}\n")
    log = CarmenLog(path)
    assert [s.max_range_m for s in log.sonars] == [4.0, 4.0]
    (heard,) = log.replay()
    assert isinstance(heard.value, Echoes)
    assert heard.value.ranges.tolist() == [1.5, np.inf]
    path.write_text(sonar)
    assert "5 m assumed" in CarmenLog(path).notes[0]
