"""Finds out what a recording is by looking into it; its name tells nothing."""

import gzip
import zlib
from pathlib import Path

from blackboard.errors import RecordingError, did_you_mean
from sim.recordings.bag_files import ZIP_MAGIC, bag_suffix
from sim.recordings.bags import Bag
from sim.recordings.carmen import CarmenLog
from sim.recordings.recording import Recording

HEAD_BYTES = 4096
EXPECTED = "a CARMEN log (plain or gzipped), a ROS 1 bag, or a ROS 2 bag (a folder, MCAP or sqlite3 file)"


def open_recording(path: Path, odometry_topic: str = "") -> Recording:
    """Return the recording in a file or folder. Raises RecordingError where there is none that can be read."""
    if path.is_dir():
        if not (path / "metadata.yaml").is_file():
            raise RecordingError(f"{path}: the folder is no ROS 2 bag (no metadata.yaml); name the recording inside it")
        return Bag(path, odometry_topic)
    try:
        with path.open("rb") as file:
            head = file.read(HEAD_BYTES)
    except FileNotFoundError:
        neighbours = [p.name for p in path.parent.iterdir()] if path.parent.is_dir() else []
        raise RecordingError(f"{path}: there is no such recording{did_you_mean(path.name, neighbours)}") from None
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror})") from None
    if not head:
        raise RecordingError(f"{path}: the file is empty; expected {EXPECTED}")
    if bag_suffix(head) is not None or head.startswith(ZIP_MAGIC):
        return Bag(path, odometry_topic)
    if head.startswith(b"\x1f\x8b"):
        head = _inside(path)
        if bag_suffix(head) is not None:
            raise RecordingError(
                f"{path}: a gzipped bag cannot be read as it is; unpack it with 'gunzip -k {path.name}'"
            )
    if b"\x00" in head:
        raise RecordingError(f"{path}: not a recording that can be read; expected {EXPECTED}")
    return CarmenLog(path)


def _inside(path: Path) -> bytes:
    try:
        with gzip.open(path) as file:
            return file.read(HEAD_BYTES)
    except (OSError, EOFError, zlib.error):
        return b""  # reading it whole will say where it breaks off
