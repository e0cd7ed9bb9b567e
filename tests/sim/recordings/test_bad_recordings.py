"""Files that cannot be read: each gives one line that says what is wrong and what to do."""

import gzip
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from blackboard.errors import RecordingError
from sim.recordings.recorded import RecordedRobot, RecordedRobotParams

Write = Callable[..., Path]


def complaint(path: Path) -> str:
    with pytest.raises(RecordingError) as caught:
        RecordedRobot(RecordedRobotParams(path=path), name="robot")
    text = str(caught.value)
    assert "\n" not in text
    assert str(path) in text
    return text


def test_missing_file(tmp_path: Path) -> None:
    (tmp_path / "intel.log.gz").touch()
    assert "did you mean 'intel.log.gz'?" in complaint(tmp_path / "intl.log.gz")
    assert "no such recording" in complaint(tmp_path / "nowhere" / "intel.log")


def test_empty_file(tmp_path: Path) -> None:
    (tmp_path / "empty.log").touch()
    assert "empty" in complaint(tmp_path / "empty.log")
    (tmp_path / "empty.log.gz").write_bytes(gzip.compress(b""))
    assert "not a recording" in complaint(tmp_path / "empty.log.gz")


def test_text_that_is_no_log(tmp_path: Path) -> None:
    path = tmp_path / "poem.log"
    path.write_text("It was the best of times,\nit was the worst of times.\n")
    assert "not a recording: none of its 2 lines" in complaint(path)


def test_other_binary(tmp_path: Path) -> None:
    path = tmp_path / "picture.bag"
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(100))
    assert "expected a CARMEN log" in complaint(path)


def test_log_without_ranges(tmp_path: Path) -> None:
    path = tmp_path / "odometry.log"
    path.write_text("ODOM 0 0 0 0 0 0 1.0 h 1.0\n" * 3)
    assert "lines by tag: ODOM 3" in complaint(path)


def test_log_without_a_single_time(tmp_path: Path) -> None:
    path = tmp_path / "timeless.log"
    path.write_text(f"FLASER 180 {'1 ' * 180} 0 0 0 0 0 0 nan h nan\n")
    assert "finite time" in complaint(path)


@pytest.mark.parametrize("cut", [30, 200])
def test_gzip_that_breaks_off(tmp_path: Path, small_log: list[str], cut: int) -> None:
    data = gzip.compress("\n".join(small_log).encode())
    path = tmp_path / "cut.log.gz"
    path.write_bytes(data[: min(cut, len(data) - 9)])
    assert "zcat cut.log.gz" in complaint(path)


def test_folder_that_is_no_bag(tmp_path: Path) -> None:
    assert "no metadata.yaml" in complaint(tmp_path)
    (tmp_path / "metadata.yaml").write_text("rosbag2_bagfile_information: 3")
    assert "damaged" in complaint(tmp_path)


def test_bag_without_ranges(tmp_path: Path, write_bag: Write, ros1: Any, ros2: Any) -> None:
    for form, ros in (("ros1", ros1), ("mcap", ros2), ("sqlite3", ros2)):
        path = write_bag(tmp_path / f"{form}.bag", [("/chat", 1.0, ros.string("hello"))], form)
        assert "/chat (std_msgs/msg/String)" in complaint(path)


def test_empty_bag(tmp_path: Path, write_bag: Write) -> None:
    assert "topics: none" in complaint(write_bag(tmp_path / "empty", []))


@pytest.mark.parametrize("form", ["ros1", "mcap", "sqlite3"])
@pytest.mark.parametrize("left", [0.1, 0.5, 0.9])
def test_bag_that_breaks_off(tmp_path: Path, write_bag: Write, ros1: Any, ros2: Any, form: str, left: float) -> None:
    ros = ros1 if form == "ros1" else ros2
    messages = [("/scan", 1.0 + i, ros.scan(1.0 + i, "base_link", [1.0] * 300)) for i in range(50)]
    bag = write_bag(tmp_path / "whole.bag", messages, form)
    file = bag if bag.is_file() else next(p for p in bag.iterdir() if p.suffix != ".yaml")
    file.write_bytes(file.read_bytes()[: int(left * file.stat().st_size)])
    assert "damaged or breaks off" in complaint(file)
    assert "damaged or breaks off" in complaint(bag)


def test_gzipped_bag(tmp_path: Path, write_bag: Write, ros1: Any) -> None:
    bag = write_bag(tmp_path / "a.bag", [("/scan", 1.0, ros1.scan(1.0, "base_link", [1.0, 2.0]))], "ros1")
    path = tmp_path / "a.bag.gz"
    path.write_bytes(gzip.compress(bag.read_bytes()))
    assert "gunzip -k a.bag.gz" in complaint(path)


def test_zip_that_breaks_off(tmp_path: Path) -> None:
    path = tmp_path / "a.zip"
    path.write_bytes(b"PK\x03\x04" + bytes(50))
    assert "damaged" in complaint(path)


def test_file_that_may_not_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "secret.log"
    path.write_text("ODOM")

    def refuse(*_: Any, **__: Any) -> Any:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    assert "Permission denied" in complaint(path)
