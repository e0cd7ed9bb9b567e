"""ROS 1 and ROS 2 bags: Range, LaserScan, Odometry, and the transforms that tell where the sensors sit.

The bag is read twice: once for its sensors and the stamps in the messages' headers, which are repaired sensor by sensor, and
once while it is replayed, in the order in which the messages were received.
"""

from array import array
from collections.abc import Generator, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection

from blackboard.errors import RecordingError
from blackboard.messages.sensing import LaserSensor, Odometry, SonarSensor
from sim.recordings.bag_files import messages_of, open_bag
from sim.recordings.bag_messages import (
    Together,
    fan_of,
    nearest_of,
    odometry_of,
    planar_pose,
    reach_of,
    sonar_of,
    stamp_and_frame,
)
from sim.recordings.cones import Fan
from sim.recordings.frames import Frames, Transform, in_plane, plain_name, transform_of
from sim.recordings.ranges import Ranges, sort_out, sort_out_one, unfit
from sim.recordings.recording import Echoes, Heard, Recording, Sweep
from sim.recordings.stamps import repair

RANGE, SCAN, ODOMETRY, TRANSFORMS = (
    "sensor_msgs/msg/Range",
    "sensor_msgs/msg/LaserScan",
    "nav_msgs/msg/Odometry",
    "tf2_msgs/msg/TFMessage",
)
TRANSFORM_TYPES = (TRANSFORMS, "tf/msg/tfMessage")
TYPES: dict[str, type[Odometry | Sweep | Echoes]] = {RANGE: Echoes, SCAN: Sweep, ODOMETRY: Odometry}
BASES = ("base_link", "base_footprint", "base")
WHEELS = "odom"  # the frame of the odometry, by the convention of REP-105
WORLDS = (WHEELS, "map", "world")
TF_ODOMETRY = ("/tf", "")  # the sensor that odometry from transforms counts as

Key = tuple[str, str]  # topic and frame: one sensor


@dataclass(slots=True)
class Stream:
    """One sensor of a bag, or its odometry: its stamps, and its first message, which describes it."""

    type: str
    first: Any = None
    stamps: "array[float]" = field(default_factory=lambda: array("d"))
    received: "array[float]" = field(default_factory=lambda: array("d"))
    number: int = -1
    flipped: bool = False


class Bag(Recording):
    """A ROS bag. Raises RecordingError where it is damaged or holds no ranges; `odometry_topic` chooses among several."""

    def __init__(self, path: Path, odometry_topic: str = "") -> None:
        super().__init__()
        self._path = path
        self._streams: dict[Key, Stream] = {}
        self._frames = Frames()
        self._worlds = list(WORLDS)
        self._wheels_to = ""  # the body's frame, where odometry stands in /tf only
        with open_bag(path) as bag:
            self._used = self._choose(bag.connections, odometry_topic)
            self._survey(bag)
        self._describe()
        self._repair()

    def _choose(self, connections: list[Connection], odometry_topic: str) -> list[tuple[str, str]]:
        """Return the types and topics to read: all ranges and transforms, and one odometry."""
        counts: dict[str, dict[str, int]] = {}
        for c in connections:
            counts.setdefault(c.msgtype, {}).setdefault(c.topic, 0)
            counts[c.msgtype][c.topic] += c.msgcount
        if not counts.get(RANGE) and not counts.get(SCAN):
            topics = ", ".join(sorted({f"{c.topic} ({c.msgtype})" for c in connections})) or "none"
            raise RecordingError(f"{self._path}: no sensor_msgs Range or LaserScan in the bag; its topics: {topics}")
        odometry = counts.get(ODOMETRY, {})
        if odometry_topic and odometry_topic not in odometry:
            raise RecordingError(
                f"{self._path}: no odometry on '{odometry_topic}'; there is: {', '.join(sorted(odometry)) or 'none'}"
            )
        chosen = odometry_topic or min(odometry, key=lambda t: (t != "/odom", -odometry[t], t), default="")
        if len(odometry) > 1 and not odometry_topic:
            self.notes.append(f"odometry is that of {chosen}, of {', '.join(sorted(odometry))}")
        self._odometry_in_tf = not chosen
        types = (RANGE, SCAN, *TRANSFORM_TYPES)
        return [(type_, topic) for type_ in types for topic in counts.get(type_, {})] + (
            [(ODOMETRY, chosen)] if chosen else []
        )

    def _survey(self, bag: AnyReader) -> None:
        connections = [c for c in bag.connections if (c.msgtype, c.topic) in self._used]
        for connection, received_ns, raw in messages_of(self._path, bag, connections):
            self.counts["messages_read"] += 1
            if connection.msgtype in TRANSFORM_TYPES:
                self._take_transforms(_decoded(bag, raw, connection.msgtype), received_ns)
                continue
            try:
                stamp_s, frame = stamp_and_frame(raw, ros2=bag.is2)
            except (ValueError, IndexError):
                continue  # replay counts it
            key = (connection.topic, frame if connection.msgtype != ODOMETRY else "")
            stream = self._streams.setdefault(key, Stream(connection.msgtype))
            if stream.first is None:
                stream.first = _decoded(bag, raw, connection.msgtype)
            stream.stamps.append(stamp_s)
            stream.received.append(received_ns * 1e-9)
        wheels = self._streams.get(TF_ODOMETRY)
        if wheels is not None and len(wheels.stamps) < 2:  # nailed down: no odometry
            del self._streams[TF_ODOMETRY]
            self._wheels_to = ""
        self._streams = {key: stream for key, stream in self._streams.items() if stream.first is not None}

    def _take_transforms(self, message: Any, received_ns: int) -> None:
        for transform in message.transforms if message is not None else ():
            if self._odometry_in_tf and self._turns_wheels(transform):
                stream = self._streams.setdefault(TF_ODOMETRY, Stream(ODOMETRY, transform))
                stream.stamps.append(transform.header.stamp.sec + transform.header.stamp.nanosec * 1e-9)
                stream.received.append(received_ns * 1e-9)
                self._wheels_to = transform.child_frame_id
            with suppress(ValueError):
                self._frames.add(
                    plain_name(transform.header.frame_id),
                    plain_name(transform.child_frame_id),
                    transform_of(transform.transform.translation, transform.transform.rotation),
                )

    def _turns_wheels(self, transform: Any) -> bool:
        """Say whether a transform is odometry: that of the first body told in the frame `odom`."""
        return plain_name(transform.header.frame_id) == WHEELS and self._wheels_to in ("", transform.child_frame_id)

    def _describe(self) -> None:
        if self._wheels_to:
            self.notes.append(f"odometry is taken from /tf ({WHEELS} to {plain_name(self._wheels_to)})")
        bases = list(BASES)
        for stream in self._streams.values():
            if stream.type == ODOMETRY:
                bases.insert(0, plain_name(stream.first.child_frame_id))
                self._worlds.append(plain_name(stream.first.header.frame_id))
        lasers: list[LaserSensor] = []
        fans: list[Fan] = []
        sonars: list[SonarSensor] = []
        lost: list[str] = []
        for (topic, frame), stream in sorted(self._streams.items(), key=lambda item: item[0]):
            if stream.type == ODOMETRY:
                continue
            base_from_sensor = self._find(bases, plain_name(frame))
            if base_from_sensor is None:
                lost.append(f"{topic} ({frame})" if frame else topic)
                base_from_sensor = np.eye(4)
            mount, level, flipped = in_plane(base_from_sensor)
            if not level:
                self.notes.append(f"{topic} ({frame}) looks up or down: left out")
                continue
            if stream.type == SCAN:
                fan = fan_of(stream.first, flipped)
                if fan is None:
                    self.notes.append(f"{topic} ({frame}): its first scan makes no sense: left out")
                    continue
                stream.number, stream.flipped = len(lasers), flipped
                lasers.append(LaserSensor(mount=mount, max_range_m=reach_of(stream.first.range_max)))
                fans.append(fan)
            else:
                stream.number = len(sonars)
                sonars.append(sonar_of(stream.first, mount))
        if lost:
            self.notes.append(f"no transform tells where {', '.join(lost)} sits: taken to be the robot's centre, ahead")
        self.lasers, self.fans, self.sonars = tuple(lasers), tuple(fans), tuple(sonars)
        if not lasers and not sonars:
            raise RecordingError(
                f"{self._path}: no range that can be used; {'; '.join(self.notes) or 'all are damaged'}"
            )

    def _find(self, bases: list[str], frame: str) -> Transform | None:
        for base in bases:
            found = self._frames.chain(base, frame, avoid=[w for w in self._worlds if w != frame])
            if found is not None:
                return found
        return None

    def _repair(self) -> None:
        used = {key: stream for key, stream in self._streams.items() if stream.number >= 0 or stream.type == ODOMETRY}
        unstamped = [key[0] for key, stream in used.items() if not any(stream.stamps)]
        if unstamped:
            self.notes.append(f"{unstamped[0]} bears no stamps: the times of receipt are used throughout")
        for stream in used.values():
            stamps, repaired = repair(np.array(stream.received if unstamped else stream.stamps))
            stream.stamps = array("d", stamps.tobytes())
            self.counts["stamps_repaired"] += repaired
            self.saw(TYPES[stream.type], stream.stamps[0], stream.stamps[-1])
        self._streams = used

    def replay(self) -> Generator[Heard, None, None]:
        """Yield odometry, sweeps and echoes as they were received; ranges heard together come as one."""
        self.counts["messages_skipped"] = self.counts["ranges_invalid"] = 0
        cursors = {key: iter(stream.stamps) for key, stream in self._streams.items()}
        together = Together()
        with open_bag(self._path) as bag:
            types = (*TYPES, *(TRANSFORM_TYPES if self._wheels_to else ()))
            connections = [c for c in bag.connections if (c.msgtype, c.topic) in self._used and c.msgtype in types]
            for connection, _, raw in messages_of(self._path, bag, connections):
                if connection.msgtype in TRANSFORM_TYPES:
                    for odometry in self._from_transforms(_decoded(bag, raw, connection.msgtype), cursors[TF_ODOMETRY]):
                        yield from together.until(odometry.stamp_s, ranged=False)
                        yield odometry
                    continue
                try:
                    _, frame = stamp_and_frame(raw, ros2=bag.is2)
                except (ValueError, IndexError):
                    self.counts["messages_skipped"] += 1
                    continue
                key = (connection.topic, frame if connection.msgtype != ODOMETRY else "")
                stream = self._streams.get(key)
                if stream is None:
                    continue
                stamp_s = next(cursors[key])
                yield from together.until(stamp_s, ranged=stream.type == RANGE)
                value = self._value(stream, _decoded(bag, raw, connection.msgtype))
                if value is None:
                    self.counts["messages_skipped"] += 1
                elif isinstance(value, float):
                    self.counts["ranges_invalid"] += value != value
                    yield from together.add(stamp_s, stream.number, value)
                else:
                    yield Heard(stamp_s, value)
        yield from together.flush()

    def _from_transforms(self, message: Any, stamps: Iterator[float]) -> Iterator[Heard]:
        for transform in message.transforms if message is not None else ():
            if self._turns_wheels(transform):
                stamp_s = next(stamps)
                pose = planar_pose(transform.transform.translation, transform.transform.rotation)
                if pose is None:
                    self.counts["messages_skipped"] += 1
                else:
                    yield Heard(stamp_s, Odometry(pose=pose))

    def _value(self, stream: Stream, message: Any) -> Odometry | Sweep | float | None:
        if message is None:
            return None
        if stream.type == ODOMETRY:
            return odometry_of(message)
        if stream.type == RANGE:
            limit_m = self.sonars[stream.number].max_range_m
            return sort_out_one(message.range, nearest_of(message.min_range), min(limit_m, reach_of(message.max_range)))
        fan = fan_of(message, stream.flipped)
        if fan is None:
            return None
        limit_m = min(self.lasers[stream.number].max_range_m, reach_of(message.range_max))
        ranges: Ranges = sort_out(message.ranges, nearest_of(message.range_min), limit_m)
        self.counts["ranges_invalid"] += unfit(ranges)
        return Sweep(stream.number, fan, ranges)


def _decoded(bag: AnyReader, raw: bytes, type_: str) -> Any:
    """Return the message, or None where its bytes are not one."""
    try:
        return bag.deserialize(raw, type_)
    except Exception:  # the generated decoders raise whatever they stumble over
        return None
