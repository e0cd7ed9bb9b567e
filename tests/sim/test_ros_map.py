"""Worlds from ROS maps: thresholds, negate, origin, image forms; and what each mistake says."""

from math import pi
from pathlib import Path

import numpy as np
import pytest
import shapely
from PIL import Image

from blackboard.errors import MissionError
from sim.ros_map import load_ros_map
from sim.simulated import SimulatedRobot
from sim.simulated_params import SimulatedRobotParams
from sim.world_by_name import load_world

MAPS = Path(__file__).resolve().parents[2] / "../shared/data/maps"
needs_maps = pytest.mark.skipif(not MAPS.is_dir(), reason=f"no maps in {MAPS}")

YAML = """image: {image}
resolution: 0.05   # metres
origin: {origin}
negate: {negate}
occupied_thresh: 0.65
free_thresh: 0.196
"""


def room(free: int = 254, occupied: int = 0, unknown: int = 205) -> np.ndarray:
    """A room of 4 by 2 m, its lower left corner 1 m right of and 0.5 m above the image's."""
    cells = np.full((60, 120), unknown, dtype=np.uint8)
    cells[8:52, 18:102] = occupied
    cells[10:50, 20:100] = free
    return cells


def write(
    folder: Path, cells: np.ndarray, image: str = "room.pgm", origin: str = "[-1.0, -0.5, 0.0]", negate: int = 0
) -> Path:
    Image.fromarray(cells).save(folder / image)
    path = folder / "room.yaml"
    path.write_text(YAML.format(image=image, origin=origin, negate=negate))
    return path


@pytest.mark.parametrize("image", ["room.pgm", "room.png"])
def test_a_room_lies_where_origin_and_resolution_say(tmp_path: Path, image: str) -> None:
    world = load_ros_map(write(tmp_path, room(), image))
    assert world.free.bounds == pytest.approx((0.0, 0.0, 4.0, 2.0))
    assert world.floor.bounds == pytest.approx((-1.0, -0.5, 5.0, 2.5))
    assert world.truth().solid.contains(shapely.Point(4.5, 1.0))
    start = world.start_pose(None, 0.3)
    assert world.free.contains(shapely.Point(start.x_m, start.y_m).buffer(0.9))


def test_up_is_up(tmp_path: Path) -> None:
    cells = room()
    cells[12:16, 22:26] = 0  # near the upper left corner of the image
    world = load_ros_map(write(tmp_path, cells))
    assert not world.free.contains(shapely.Point(0.2, 1.8))
    assert world.free.contains(shapely.Point(0.2, 0.2))


def test_a_turned_origin_turns_the_world_about_it(tmp_path: Path) -> None:
    world = load_ros_map(write(tmp_path, room(), origin=f"[1.0, 2.0, {pi / 2}]"))
    assert world.free.bounds == pytest.approx((1.0 - 2.5, 2.0 + 1.0, 1.0 - 0.5, 2.0 + 5.0))


def test_negate_and_thresholds(tmp_path: Path) -> None:
    negative = load_ros_map(write(tmp_path, room(free=0, occupied=254, unknown=100), negate=1))
    assert negative.free.bounds == pytest.approx((0.0, 0.0, 4.0, 2.0))
    at_threshold = load_ros_map(write(tmp_path, room(free=206)))  # 1 - 206/255 = 0.192, just free
    assert at_threshold.free.area == pytest.approx(8.0, abs=0.01)
    with pytest.raises(MissionError, match="no free cell"):
        load_ros_map(write(tmp_path, room(free=204)))


def test_other_pixel_forms(tmp_path: Path) -> None:
    area = load_ros_map(write(tmp_path, room())).free.area
    colour = np.dstack([room()] * 3)
    assert load_ros_map(write(tmp_path, colour, "room.png")).free.area == pytest.approx(area)
    deep = room().astype(np.uint16) * 257
    assert load_ros_map(write(tmp_path, deep, "room.png")).free.area == pytest.approx(area)
    bits = Image.fromarray(room() > 220)
    bits.save(tmp_path / "room.png")
    assert load_ros_map(tmp_path / "room.yaml").free.area == pytest.approx(area)


def test_lists_with_dashes_quotes_and_comments(tmp_path: Path) -> None:
    path = write(tmp_path, room())
    text = path.read_text().replace("room.pgm", "'room.pgm'")
    path.write_text("# a map\n" + text.replace("[-1.0, -0.5, 0.0]", "\n  - -1.0\n  - -0.5\n  - 0"))
    assert load_ros_map(path).free.bounds == pytest.approx((0.0, 0.0, 4.0, 2.0))


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("resolution: 0.05", "", "'resolution' is missing; a ROS map needs image, resolution"),
        ("origin", "orgin", "'origin' is missing"),
        ("0.05 ", "five ", "line 2: resolution = 'five' must be a number"),
        ("0.05 ", "-1 ", "line 2: resolution = -1 is outside [0.001, 10] m"),
        ("0.05 ", "nan ", "line 2: resolution = 'nan' must be a number"),
        ("-0.5, 0.0]", "-0.5]", "must be [x, y, heading]"),
        ("-0.5, 0.0]", "9e9, 0.0]", "the map reaches beyond 1000 m"),
        ("negate: 0", "negate: maybe", "line 4: negate = 'maybe' must be 0 or 1"),
        ("0.65", "0.1", "the first must lie below the second"),
        ("negate: 0", "negate: 0\nmode: raw", "line 5: mode = 'raw' must be trinary or scale"),
        ("negate: 0", "<html>", "line 4: '<html>' is not of the form 'key: value'"),
        ("room.pgm", "other.pgm", "image 'other.pgm' does not exist"),
    ],
)
def test_bad_yaml(tmp_path: Path, old: str, new: str, says: str) -> None:
    path = write(tmp_path, room())
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(MissionError) as caught:
        load_ros_map(path)
    assert str(caught.value).startswith(str(path))
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("image", ["room.pgm", "room.png"])
def test_a_truncated_or_foreign_image(tmp_path: Path, image: str) -> None:
    path = write(tmp_path, room(), image)
    whole = (tmp_path / image).read_bytes()
    (tmp_path / image).write_bytes(whole[: len(whole) // 2])
    with pytest.raises(MissionError, match="is truncated or damaged"):
        load_ros_map(path)
    for data in (b"", b"no image at all", whole[:3]):
        (tmp_path / image).write_bytes(data)
        with pytest.raises(MissionError, match=r"is no image that can be read|is truncated or damaged"):
            load_ros_map(path)


def test_a_binary_yaml_and_a_huge_image(tmp_path: Path) -> None:
    path = write(tmp_path, room())
    (tmp_path / "room.pgm").write_bytes(b"P5\n100000 100000\n255\n")
    with pytest.raises(MissionError, match="over"):
        load_ros_map(path)
    path.write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(MissionError, match="not a text file in UTF-8"):
        load_ros_map(path)


@needs_maps
@pytest.mark.parametrize(
    "name", ["nav2-tb3_sandbox.pgm", "stage-autolab.png", "stage-cave.png", "stage-simple_rooms.png"]
)
def test_others_maps_hold_a_robot_that_hears_its_walls(tmp_path: Path, name: str) -> None:
    path = tmp_path / "map.yaml"
    path.write_text(
        YAML.format(image=(MAPS / name).resolve(), origin="[-3, -2, 0.1]", negate=0).replace("0.05", "0.04")
    )
    world = load_world(path)
    robot = SimulatedRobot(SimulatedRobotParams(world=path, robot=Path("pioneer")), name="robot", seed=1)
    readings = list(robot.advance(0.0))
    laser = next(r.value for r in readings if r.kind.name == "laser_scan")
    assert any(r is not None for r in laser.ranges_m)
    pose = robot.true_pose()
    here = shapely.Point(pose.x_m, pose.y_m)
    nearest = min(r for r in laser.ranges_m if r is not None)
    assert nearest >= world.free.boundary.distance(here) - 0.1
