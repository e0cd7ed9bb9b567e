"""ROS bags: sensors, their places, and what their messages say."""

from collections.abc import Callable
from math import inf, nan, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from blackboard.errors import RecordingError
from blackboard.messages.sensing import Odometry
from sim.recordings.bag_messages import stamp_and_frame
from sim.recordings.bags import Bag
from sim.recordings.recording import Echoes, Sweep

Write = Callable[..., Path]
FORMS = ["ros1", "mcap", "sqlite3"]


@pytest.fixture(params=FORMS)
def drive(request: pytest.FixtureRequest, tmp_path: Path, write_bag: Write, ros1: Any, ros2: Any) -> Path:
    """Two sonars at 5 Hz, a laser and odometry at 10 Hz."""
    ros = ros1 if request.param == "ros1" else ros2
    messages: list[tuple[str, float, Any]] = [
        (
            "/tf_static",
            0.0,
            ros.transforms(("base_link", "left", 0.1, 0.2, pi / 2), ("base_link", "mast", 0.3, 0.0, pi)),
        ),
        ("/tf_static", 0.0, ros.transforms(("mast", "laser", 0.1, 0.0, 0.0), ("base_link", "right", 0.1, -0.2, -1.5))),
    ]
    for i in range(6):
        stamp_s = 100.0 + 0.1 * i
        messages.append(("/odom", stamp_s + 0.02, ros.odometry(stamp_s, 0.05 * i)))
        if i % 2 == 0:
            messages.append(("/sonar", stamp_s + 0.03, ros.range(stamp_s + 0.01, "right", 2.0)))
            messages.append(("/sonar", stamp_s + 0.031, ros.range(stamp_s + 0.012, "left", inf)))
        else:
            messages.append(("/scan", stamp_s + 0.04, ros.scan(stamp_s + 0.005, "/laser", [1.0, 2.0, inf, nan, 9.0])))
    suffix = ".bag" if request.param == "ros1" else ""
    return write_bag(tmp_path / f"drive{suffix}", messages, request.param)


def test_sensors_and_their_places(drive: Path) -> None:
    bag = Bag(drive)
    left, right = bag.sonars
    assert (left.mount.x_m, left.mount.y_m, left.mount.heading_rad) == pytest.approx((0.1, 0.2, pi / 2))
    assert right.mount.heading_rad == pytest.approx(-1.5)
    assert left.cone_rad == 0.25
    assert left.max_range_m == 5.0
    (laser,) = bag.lasers
    assert (laser.mount.x_m, laser.mount.y_m) == pytest.approx((0.2, 0.0))
    assert abs(laser.mount.heading_rad) == pytest.approx(pi)
    assert bag.notes == []


def test_readings_in_the_order_of_receipt(drive: Path) -> None:
    heard = list(Bag(drive).replay())
    assert [type(h.value) for h in heard] == [Odometry, Echoes, Odometry, Sweep] * 3
    echoes = heard[1].value
    assert isinstance(echoes, Echoes)
    assert echoes.sensors == (0, 1)
    assert echoes.ranges.tolist() == [inf, 2.0]
    assert heard[1].stamp_s == pytest.approx(100.01)
    sweep = heard[3].value
    assert isinstance(sweep, Sweep)
    assert sweep.ranges[:3].tolist() == [1.0, 2.0, inf]
    assert np.isnan(sweep.ranges[3])
    assert sweep.ranges[4] == inf
    assert (sweep.fan.angle_min_rad, sweep.fan.angle_step_rad) == (-1.5, 0.5)
    odometry = heard[2].value
    assert isinstance(odometry, Odometry)
    assert (odometry.pose.x_m, odometry.forward_mps) == (0.05, 0.5)


def test_figures(drive: Path) -> None:
    bag = Bag(drive)
    list(bag.replay())
    assert dict(bag.counts) == {
        "messages_read": 17,
        "messages_skipped": 0,
        "ranges_invalid": 3,
        "stamps_repaired": 0,
    }
    assert bag.first_s[Odometry] == 100.0
    assert bag.last_s[Sweep] == pytest.approx(100.505)


@pytest.mark.parametrize("form", ["ros1", "mcap"])
def test_what_a_bag_is_called_tells_nothing(tmp_path: Path, write_bag: Write, ros1: Any, ros2: Any, form: str) -> None:
    ros = ros1 if form == "ros1" else ros2
    written = write_bag(tmp_path / "a.bag", [("/scan", 1.0, ros.scan(1.0, "laser", [1.0, 2.0]))], form)
    file = written if written.is_file() else next(written.glob("*.mcap"))
    misnamed = file.rename(tmp_path / "recording.log")
    assert len(list(Bag(misnamed).replay())) == 1


def test_zipped_bag(tmp_path: Path, write_bag: Write, ros1: Any) -> None:
    import zipfile

    bag = write_bag(tmp_path / "a.bag", [("/scan", 1.0, ros1.scan(1.0, "laser", [1.0, 2.0]))], "ros1")
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.write(bag, "folder/a.bag")
        archive.writestr("readme.txt", "no bag")
    assert len(list(Bag(tmp_path / "a.zip").replay())) == 1
    with zipfile.ZipFile(tmp_path / "b.zip", "w") as archive:
        archive.writestr("readme.txt", "no bag")
    with pytest.raises(RecordingError, match="0 bags"):
        Bag(tmp_path / "b.zip")


def test_a_laser_upside_down_is_mirrored(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    bag = Bag(
        write_bag(
            tmp_path / "flipped",
            [
                ("/tf_static", 0.0, ros2.transforms(("base_link", "laser", 0.1, 0.0, 0.0), roll_rad=pi)),
                ("/scan", 1.0, ros2.scan(1.0, "laser", [1.0, 2.0, 3.0], start_rad=-1.5)),
            ],
        )
    )
    (heard,) = bag.replay()
    assert isinstance(heard.value, Sweep)
    assert (heard.value.fan.angle_min_rad, heard.value.fan.angle_step_rad) == (1.5, -0.5)
    assert bag.lasers[0].mount.heading_rad == pytest.approx(0.0, abs=1e-9)


def test_a_sensor_that_looks_down_is_left_out(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    tf = ros2.transforms(("base_link", "cliff", 0.1, 0.0, 0.0), ("base_link", "front", 0.1, 0.0, 0.0))
    tf.transforms[0].transform.rotation = ros2.quaternion(0.0, 0.0, pi / 2)
    messages = [
        ("/tf_static", 0.0, tf),
        ("/range", 1.0, ros2.range(1.0, "cliff", 0.3)),
        ("/range", 1.001, ros2.range(1.001, "front", 1.0)),
    ]
    bag = Bag(write_bag(tmp_path / "cliff", messages))
    assert len(bag.sonars) == 1
    assert "up or down" in bag.notes[0]
    (heard,) = bag.replay()
    assert isinstance(heard.value, Echoes)
    assert heard.value.ranges.tolist() == [1.0]


def test_missing_transform_is_noted(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    bag = Bag(write_bag(tmp_path / "lost", [("/scan", 1.0, ros2.scan(1.0, "laser", [1.0, 2.0]))]))
    assert bag.lasers[0].mount.x_m == 0.0
    assert "/scan (laser)" in bag.notes[0]


def test_sonars_that_speak_apart_come_apart(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    messages = [
        ("/sonar", 1.0, ros2.range(1.0, "a", 1.0)),
        ("/sonar", 1.02, ros2.range(1.02, "b", 2.0)),
        ("/sonar", 1.021, ros2.range(1.021, "a", 3.0)),
        ("/sonar", 1.022, ros2.range(1.022, "a", 4.0)),
    ]
    heard = list(Bag(write_bag(tmp_path / "apart", messages)).replay())
    assert [h.value.sensors for h in heard if isinstance(h.value, Echoes)] == [(0,), (0, 1), (0,)]


def test_stamps_are_repaired_sensor_by_sensor(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    messages: list[tuple[str, float, Any]] = []
    for i in range(10):
        messages.append(("/odom", 50.0 + i, ros2.odometry(50.0 + i if i != 4 else 3.0, 0.1 * i)))
        messages.append(("/scan", 50.1 + i, ros2.scan(49.9 + i, "base_link", [1.0, 2.0])))  # always taken before
    bag = Bag(write_bag(tmp_path / "back", messages))
    heard = list(bag.replay())
    assert bag.counts["stamps_repaired"] == 1
    assert [h.stamp_s for h in heard if isinstance(h.value, Odometry)] == [50.0 + i for i in range(10)]
    assert heard[1].stamp_s == pytest.approx(49.9)


def test_without_stamps_the_times_of_receipt_count(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    messages = [("/scan", 7.0 + i, ros2.scan(0.0, "base_link", [1.0, 2.0])) for i in range(3)]
    bag = Bag(write_bag(tmp_path / "unstamped", messages))
    assert [h.stamp_s for h in bag.replay()] == [7.0, 8.0, 9.0]
    assert "receipt" in bag.notes[0]


def test_which_odometry(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    messages = [
        ("/scan", 1.0, ros2.scan(1.0, "base_link", [1.0, 2.0])),
        ("/truth", 1.0, ros2.odometry(1.0, 5.0)),
        ("/truth", 2.0, ros2.odometry(2.0, 6.0)),
        ("/odom", 2.0, ros2.odometry(2.0, 7.0)),
    ]
    path = write_bag(tmp_path / "two", messages)
    assert [h.value.pose.x_m for h in Bag(path).replay() if isinstance(h.value, Odometry)] == [7.0]
    assert [h.value.pose.x_m for h in Bag(path, "/truth").replay() if isinstance(h.value, Odometry)] == [5.0, 6.0]
    assert "/odom" in Bag(path).notes[0]
    with pytest.raises(RecordingError, match=r"'/odo'.*/odom, /truth"):
        Bag(path, "/odo")


def test_messages_that_make_no_sense_are_skipped(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    messages = [
        ("/scan", 1.0, ros2.scan(1.0, "base_link", [1.0, 2.0])),
        ("/scan", 2.0, ros2.scan(2.0, "base_link", [1.0, 2.0], start_rad=nan)),
        ("/odom", 3.0, ros2.odometry(3.0, nan)),
        ("/sonar", 4.0, ros2.range(4.0, "base_link", -2.0)),
        ("/sonar", 5.0, ros2.range(5.0, "base_link", 0.05)),
    ]
    bag = Bag(write_bag(tmp_path / "odd", messages))
    heard = list(bag.replay())
    assert bag.counts["messages_skipped"] == 2
    assert bag.counts["ranges_invalid"] == 2
    assert [type(h.value) for h in heard] == [Sweep, Echoes, Echoes]


def test_header_without_decoding(ros1: Any, ros2: Any) -> None:
    message = ros2.range(1234.5, "sonar_3", 1.0)
    little = bytes(ros2.store.serialize_cdr(message, message.__msgtype__))
    big = bytes(ros2.store.serialize_cdr(message, message.__msgtype__, little_endian=False))
    old = ros1.range(1234.5, "sonar_3", 1.0)
    assert stamp_and_frame(little, ros2=True) == (1234.5, "sonar_3")
    assert stamp_and_frame(big, ros2=True) == (1234.5, "sonar_3")
    assert stamp_and_frame(bytes(ros1.store.serialize_ros1(old, old.__msgtype__)), ros2=False) == (1234.5, "sonar_3")
    for short in (b"", little[:10], little[:18]):
        with pytest.raises(ValueError, match="breaks off"):
            stamp_and_frame(short, ros2=True)


def test_odometry_that_stands_in_transforms_only(tmp_path: Path, write_bag: Write, ros2: Any) -> None:
    def moved(stamp_s: float, x_m: float) -> tuple[str, float, Any]:
        message = ros2.transforms(("map", "odom", 9.0, 9.0, 0.0), ("odom", "base_link", x_m, 0.5, 0.1))
        for transform in message.transforms:
            transform.header = ros2.header(stamp_s, transform.header.frame_id)
        return "/tf", stamp_s, message

    messages = [
        ("/tf_static", 0.5, ros2.transforms(("base_link", "laser", 0.2, 0.0, 0.0))),
        moved(1.0, 0.0),
        ("/scan", 1.05, ros2.scan(1.05, "laser", [1.0, 2.0])),
        moved(1.1, 0.3),
    ]
    bag = Bag(write_bag(tmp_path / "tf", messages))
    heard = list(bag.replay())
    assert [type(h.value) for h in heard] == [Odometry, Sweep, Odometry]
    last = heard[2].value
    assert isinstance(last, Odometry)
    assert (last.pose.x_m, last.pose.y_m, last.pose.heading_rad) == pytest.approx((0.3, 0.5, 0.1))
    assert heard[2].stamp_s == pytest.approx(1.1)
    assert bag.lasers[0].mount.x_m == 0.2
    assert "/tf (odom to base_link)" in bag.notes[0]


def test_a_message_that_does_not_decode_is_counted(tmp_path: Path, ros2: Any) -> None:
    from rosbags.rosbag2 import StoragePlugin, Writer

    whole = bytes(ros2.store.serialize_cdr(ros2.scan(1.0, "base_link", [1.0, 2.0]), "sensor_msgs/msg/LaserScan"))
    with Writer(tmp_path / "cut", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/scan", "sensor_msgs/msg/LaserScan", typestore=ros2.store)
        for received_ns, raw in enumerate([whole[:40], whole, whole[:10], whole[:-3]]):
            writer.write(connection, received_ns, raw)
    bag = Bag(tmp_path / "cut")
    assert sum(isinstance(h.value, Sweep) for h in bag.replay()) == 1
    assert bag.counts["messages_skipped"] == 3
