"""Opens ROS bags by what they are, not by what they are called, and turns every fault of a file into one line."""

import zipfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory

from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection
from rosbags.typesys import Stores, get_typestore

from blackboard.errors import RecordingError

MAGIC = {b"#ROSBAG V2.0": ".bag", b"\x89MCAP0\r\n": ".mcap", b"SQLite format 3\x00": ".db3"}
ZIP_MAGIC = b"PK\x03\x04"
HEAD_BYTES = 64
REPAIRS = {".bag": "rosbag reindex", ".mcap": "mcap recover", ".db3": "ros2 bag reindex"}


def bag_suffix(head: bytes) -> str | None:
    """Return what a file that begins so would be called (.bag, .mcap, .db3); None for what is no bag."""
    return next((suffix for magic, suffix in MAGIC.items() if head.startswith(magic)), None)


@contextmanager
def open_bag(path: Path) -> Iterator[AnyReader]:
    """Open a bag file, a folder of ROS 2, or a zip that holds one bag. Raises RecordingError where it is damaged."""
    with TemporaryDirectory(prefix="ski-") as scratch:
        try:
            bag = AnyReader([_readable(path, Path(scratch))], default_typestore=get_typestore(Stores.ROS2_HUMBLE))
            bag.open()
        except RecordingError:
            raise
        except Exception as error:  # rosbags raises whatever it stumbles over in a damaged file
            raise _damaged(path, error) from error
        with closing(bag):
            yield bag


def messages_of(path: Path, bag: AnyReader, connections: list[Connection]) -> Iterator[tuple[Connection, int, bytes]]:
    """Yield connection, time of receipt (ns) and bytes of each message. Raises RecordingError where the bag is damaged."""
    try:
        yield from bag.messages(connections)
    except Exception as error:  # likewise
        raise _damaged(path, error) from error


def _damaged(path: Path, error: Exception) -> RecordingError:
    said = " ".join(str(error).split()) or type(error).__name__
    repair = REPAIRS.get(path.suffix, "the tools of ROS")
    return RecordingError(
        f"{path}: the bag is damaged or breaks off ({said}); copy it again, or repair it with {repair}"
    )


def _readable(path: Path, scratch: Path) -> Path:
    """Return a path under which rosbags knows the bag for what it is."""
    if path.is_dir():
        return _linked(path, scratch / "recording") if path.suffix == ".bag" else path
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES)
    if head.startswith(ZIP_MAGIC):
        path = _unzipped(path, scratch)
        with path.open("rb") as file:
            head = file.read(HEAD_BYTES)
    suffix = bag_suffix(head)
    if suffix is None or path.suffix == suffix:
        return path
    return _linked(path, scratch / f"recording{suffix}")


def _linked(path: Path, link: Path) -> Path:
    link.symlink_to(path.resolve())
    return link


def _unzipped(path: Path, scratch: Path) -> Path:
    with zipfile.ZipFile(path) as archive:
        bags = []
        for member in archive.infolist():
            with archive.open(member) as file:
                suffix = bag_suffix(file.read(HEAD_BYTES))
            if suffix is not None:
                bags.append((member, suffix))
        if len(bags) != 1:
            raise RecordingError(f"{path}: the zip holds {len(bags)} bags, not one; unzip it and name the bag inside")
        member, suffix = bags[0]
        bag = scratch / f"unzipped{suffix}"
        with archive.open(member) as source, bag.open("wb") as target:
            copyfileobj(source, target)
    return bag
