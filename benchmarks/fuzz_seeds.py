"""Good inputs of every decoder, small ones, for fuzzers to begin with."""

import gzip
import io
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from PIL import Image
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from blackboard.checkpoint import Checkpointer
from blackboard.entry import Entry
from blackboard.journal import JournalWriter
from blackboard.kinds import ODOMETRY
from blackboard.link.clock import ClockAnswer
from blackboard.link.envelope import Envelope, KeeperBeat, LostQuestion, Origin, Snapshot, join_batch, join_snapshot
from blackboard.messages.geometry import Pose
from blackboard.messages.hosts import HostBeat
from blackboard.mission import find_mission, load_mission
from blackboard.processes.protocol import AgentReport, HostOrder, ManagerBeat, Order, ProcessReport
from blackboard.runner import Run, RunOptions
from rules.rule_files import shipped_rule_files
from sim.shipped import find_file

IDENTITY = "explore-1"


@cache
def journal() -> bytes:
    """Return the journal of a short run, the shortest line of each kind."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "board.jsonl"
        run = Run(load_mission(find_mission("explore-lab")), RunOptions(seed=1))
        with JournalWriter(path) as written:
            run.board.journal = written
            run.run(20.0)
        run.close()
        shortest: dict[str, bytes] = {}
        for line in path.read_bytes().splitlines():
            kind = "/".join(msgspec.json.decode(line)["key"].split("/")[2:5])
            if kind not in shortest or len(line) < len(shortest[kind]):
                shortest[kind] = line
        return b"\n".join(line for line in shortest.values() if len(line) < 3000) + b"\n"


def lines() -> list[bytes]:
    """Return entries as they travel."""
    return journal().splitlines()


def batch() -> bytes:
    """Return a batch of envelopes."""
    return join_batch(Envelope(Origin("robot", "b1", "signal", n), line) for n, line in enumerate(lines()[:6], 1))


def snapshot() -> bytes:
    """Return a snapshot of a board."""
    header = Snapshot(boot="k1", now_s=12.5, lanes={"robot": {"b1": {"signal": 6}}})
    return join_snapshot(header, [Envelope(Origin("robot", "b1", "signal", 1), lines()[0])])


def kept_journal() -> bytes:
    """Return lines of a keeper's journal."""
    return b"".join(line[:-1] + b',"origin":["robot","b1","signal",%d]}\n' % n for n, line in enumerate(lines()[:6], 1))


def beats() -> list[bytes]:
    """Return what keepers and hosts say all the time, and questions."""
    lanes = {"robot": {"b1": {"signal": 6, "knowledge": 2}}}
    beat = HostBeat(boot="b1", pid=7, machine="m", version="0.1", components=("grid",), lanes={"signal": 6})
    question = LostQuestion(host="robot", boot="b1", lane="signal", first=2, last=5)
    some: list[Any] = [KeeperBeat(boot="k1", lanes=lanes), beat, question, ClockAnswer(now_s=1.5, wall_s=1e9)]
    return [*map(msgspec.json.encode, some)]


def checkpoint() -> bytes:
    """Return a checkpoint file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.checkpoint"
        entry = Entry(
            key="ski/k2a/x",
            id=None,
            revision=1,
            event="posted",
            stamp_s=1.0,
            source="s",
            value=Pose(x_m=1.0, y_m=0.0, heading_rad=0.0),
        )
        state = {"grid": np.zeros(4), "entry": entry, "kind": ODOMETRY, "rng": np.random.default_rng(1)}
        Checkpointer(path, IDENTITY, boot="b1").write(3.0, {"a": state, "b": [1, 2.5, "x"], "c": lambda: 0})
        return path.read_bytes()


def orders() -> list[bytes]:
    """Return what a manager and its executors say to each other."""
    host = HostOrder(name="rules", robot="k2a", mission="explore-lab", settings=("eou_grid.cell_m=0.1",))
    report = ProcessReport(name="rules", state="running", machine="m", pid=9, cpu_s=1.5)
    some: list[Any] = [
        Order(manager="a1", hosts=(host,)),
        ManagerBeat(manager="a1", mission="explore-lab", robot="k2a", machine="m", pid=8),
        AgentReport(machine="m", boot="b1", pid=7, version="0.1", processes=(report,)),
    ]
    return [*map(msgspec.json.encode, some)]


def rule_texts() -> list[bytes]:
    """Return shipped rule files that make programs together, a text each."""
    texts = {name: path.read_bytes() for name, path in shipped_rule_files().items()}
    programs = (("arbitration", "explore"), ("arbitration", "control"), ("arbitration", "explore", "traps", "recovery"))
    return [b"\n".join(texts[name] for name in program) for program in programs]


def missions() -> list[bytes]:
    """Return some shipped mission files."""
    return [find_mission(name).read_bytes() for name in ("wander-lab", "explore-lab", "find-drums", "explore-lab-pair")]


def worlds() -> list[bytes]:
    """Return shipped worlds."""
    return [find_file(Path(name), "worlds").read_bytes() for name in ("lab", "office", "workshop")]


def robots() -> list[bytes]:
    """Return shipped robots."""
    return [find_file(Path(name), "robots").read_bytes() for name in ("k2a", "pioneer", "k2a_camera")]


def carmen() -> bytes:
    """Return a short CARMEN log."""
    text = ["# CARMEN Logfile", "PARAM robot_width 0.5 nohost 0"]
    for i in range(6):
        stamp = f"{1000 + 0.1 * i:.6f} host {1000 + 0.1 * i:.6f}"
        pose = f"{0.1 * i:.3f} 0.0 0.0"
        text.append(f"ODOM {pose} 1.0 0.0 0.0 {stamp}")
        text.append(f"FLASER 5 2.5 2.5 81.8 2.0 3.0 {pose} {pose} {stamp}")
        text.append(
            f"ROBOTLASER1 0 -1.57 3.14 0.785 8.0 0.01 0 5 1.0 2.0 3.0 2.0 1.0 0 {pose} {pose} 0 0 0 0 0 {stamp}"
        )
        text.append(f"SONAR 3 1.0 2.0 3.0 {stamp}")
    return "\n".join(text).encode()


def zipped(data: bytes) -> bytes:
    """Return data as gzip."""
    return gzip.compress(data, 1)


@cache
def bag(form: str) -> bytes:
    """Return a small ROS bag: ros1, mcap or sqlite3."""
    store: Any = get_typestore(Stores.ROS1_NOETIC if form == "ros1" else Stores.ROS2_HUMBLE)
    extra: dict[str, Any] = {"seq": 0} if form == "ros1" else {}
    plugin = StoragePlugin.SQLITE3 if form == "sqlite3" else StoragePlugin.MCAP

    def make(type_: str, **fields: Any) -> Any:
        return store.types[type_](**fields)

    def header(stamp: int, frame: str) -> Any:
        time = make("builtin_interfaces/msg/Time", sec=stamp, nanosec=0)
        return make("std_msgs/msg/Header", stamp=time, frame_id=frame, **extra)

    zero, turn = (
        make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0),
        make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0),
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / ("a.bag" if form == "ros1" else "a")
        writer: Any = Writer1(path) if form == "ros1" else Writer2(path, version=9, storage_plugin=plugin)
        with writer:
            kinds = {"/odom": "nav_msgs/msg/Odometry", "/scan": "sensor_msgs/msg/LaserScan"}
            ways = {topic: writer.add_connection(topic, type_, typestore=store) for topic, type_ in kinds.items()}
            for i in range(3):
                place = make("geometry_msgs/msg/Point", x=0.1 * i, y=0.0, z=0.0)
                pose = make("geometry_msgs/msg/Pose", position=place, orientation=turn)
                twist = make("geometry_msgs/msg/Twist", linear=zero, angular=zero)
                odometry = make(
                    kinds["/odom"],
                    header=header(i, "odom"),
                    child_frame_id="base_link",
                    pose=make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.zeros(36)),
                    twist=make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=np.zeros(36)),
                )
                scan = make(
                    kinds["/scan"],
                    header=header(i, "base_link"),
                    angle_min=-1.0,
                    angle_max=1.0,
                    angle_increment=0.5,
                    time_increment=0.0,
                    scan_time=0.1,
                    range_min=0.1,
                    range_max=8.0,
                    ranges=np.array([1.0, 2.0, 3.0, 2.0, 1.0], np.float32),
                    intensities=np.array([], np.float32),
                )
                for topic, message in (("/odom", odometry), ("/scan", scan)):
                    type_ = kinds[topic]
                    raw = (
                        store.serialize_ros1(message, type_) if form == "ros1" else store.serialize_cdr(message, type_)
                    )
                    writer.write(ways[topic], i * 10**9, raw)
        if form == "ros1":
            return path.read_bytes()
        return next(file for file in path.iterdir() if file.suffix in (".mcap", ".db3")).read_bytes()


def map_yaml() -> bytes:
    """Return the yaml of a ROS map whose image is `map.png`."""
    return b"image: map.png\nresolution: 0.05\norigin: [-1.0, -2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"


def map_image(form: str = "PNG") -> bytes:
    """Return the image of a ROS map: a room."""
    cells = np.zeros((20, 30), np.uint8)
    cells[2:-2, 2:-2] = 254
    buffer = io.BytesIO()
    Image.fromarray(cells).save(buffer, form)
    return buffer.getvalue()


def points() -> list[bytes]:
    """Return maps of points: ARIA's form, and columns."""
    head = b"2D-Map\nMinPos: 0 0\nMaxPos: 1000 1000\nNumPoints: 3\nPointsAreSorted: true\nResolution: 20\nDATA\n"
    aria = head + b"0 0\n100 0\n200 100\n"
    return [aria, b"x,y\n0.0,1.0\n0.5,1.0\n1.0,1.5\n", b"0.0 1.0\n0.5 1.0\n1.0 1.5\n"]
