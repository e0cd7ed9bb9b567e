"""Worlds in TOML: what they hold, and what each mistake says."""

from pathlib import Path

import numpy as np
import pytest
import shapely

from blackboard.errors import MissionError
from blackboard.messages.geometry import Pose
from sim.robot_file import load_robot
from sim.shipped import shipped_names
from sim.world_by_name import load_world
from sim.world_file import load_world_file

FLOOR = "[floor]\noutline = [[0, 0], [8, 0], [8, 5], [0, 5], [0, 0]]\n"


def write(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(text)
    return path


def refusal(tmp_path: Path, text: str) -> str:
    path = write(tmp_path, text)
    with pytest.raises(MissionError) as caught:
        load_world_file(path)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(str(path))
    return message.removeprefix(str(path))


def test_a_world_with_everything(tmp_path: Path) -> None:
    world = load_world_file(
        write(
            tmp_path,
            'title = "All"\n'
            + FLOOR
            + """
            [start]
            x_m = 1.0
            y_m = 4.0
            heading_deg = 90
            [[wall]]
            line = [[2, 0], [2, 3]]
            thickness_m = 0.1
            [[polygon]]
            outline = [[6, 0], [8, 0], [8, 1], [6, 0]]
            surface = "rough"
            [[box]]
            centre = [5, 4.5]
            size = [2, 1]
            [[circle]]
            centres = [[4, 2], [4.5, 2]]
            radius_m = 0.02
            [[person]]
            path = [[3, 1], [3, 4]]
            """,
        )
    )
    assert world.free.area == pytest.approx(40 - 0.3 - 1.0 - 2.0)
    assert world.open_floor().area == pytest.approx(world.free.area - 2 * np.pi * 0.02**2, abs=1e-4)
    start = world.start_pose(None, 0.3)
    assert (start.x_m, start.y_m, start.heading_rad) == pytest.approx((1.0, 4.0, np.pi / 2))
    segments = world.shapes.segments
    rough = segments.length_m[segments.rough]
    assert rough.tolist() == pytest.approx([5**0.5])  # the wedge's one free side
    assert len(world.people) == 1
    truth = world.truth()
    assert truth.solid.contains(shapely.Point(5, 4.5))
    assert truth.solid.contains(shapely.Point(-0.1, 2))
    assert truth.solid.contains(shapely.Point(4.5, 2))
    assert not truth.solid.intersects(shapely.Point(1, 1))
    assert truth.floor.area == pytest.approx(40)


def test_things_that_overlap_have_one_boundary(tmp_path: Path) -> None:
    world = load_world_file(
        write(
            tmp_path,
            FLOOR + "[[box]]\ncentre = [4, 2]\nsize = [2, 1]\n[[box]]\ncentre = [4.5, 2.5]\nsize = [1, 2]\n",
        )
    )
    assert world.shapes.segments.length_m.sum() == pytest.approx(26 + world.free.interiors[0].length)
    ring = shapely.union(shapely.box(3, 1.5, 5, 2.5), shapely.box(4, 1.5, 5, 3.5)).exterior
    assert world.free.interiors[0].length == pytest.approx(ring.length)


def test_edges_and_right_angled_corners_echo_and_blunt_ones_do_not(tmp_path: Path) -> None:
    blunt = (
        "[floor]\noutline = [[0, 0], [8, 0], [8, 5], [4, 6], [0, 5], [0, 0]]\n[[box]]\ncentre = [4, 2]\nsize = [2, 1]\n"
    )
    segments = load_world_file(write(tmp_path, blunt)).shapes.segments
    silent = ~segments.corner_echoes
    assert len(silent) == 9
    silent_corners = sorted(
        zip(segments.corner_x_m[silent].tolist(), segments.corner_y_m[silent].tolist(), strict=True)
    )
    assert silent_corners == [(4.0, 6.0)]


def test_shipped_worlds_hold_their_robots() -> None:
    assert shipped_names("worlds") == ["hall", "lab", "office", "trap", "warehouse", "workshop"]
    for name in shipped_names("worlds"):
        world = load_world(Path(name))
        assert world.people, name
        world.start_pose(None, 0.31)
    width, height = np.diff(np.array(load_world(Path("lab")).floor.bounds).reshape(2, 2), axis=0)[0]
    assert (width, height) == (8.0, 5.0)


def test_the_hall_is_wider_than_its_robots_sonars_reach() -> None:
    hall, reach_m = load_world(Path("hall")), load_robot(Path("k2a_near")).description().sonars[0].max_range_m
    assert reach_m == 5.0
    inside = hall.floor.buffer(-0.5).buffer(0.5)  # without the niches of doors
    assert (np.diff(np.array(inside.bounds).reshape(2, 2), axis=0)[0] >= (40.0, 15.0)).all()
    xs, ys = np.meshgrid(np.arange(0.5, 40.0), np.arange(0.5, 15.0))
    places = [(x, y) for x, y in zip(xs.ravel(), ys.ravel(), strict=True) if hall.free.contains(shapely.Point(x, y))]
    from_wall = [hall.floor.exterior.distance(shapely.Point(place)) for place in places]
    assert np.mean(np.array(from_wall) > reach_m) > 0.2  # a good part of it lies out of reach of any wall
    assert load_world(Path("office")).floor.bounds[2] == 30.0


def test_the_office_is_one_floor_and_the_trap_has_gaps_of_both_kinds() -> None:
    office = load_world(Path("office")).open_floor().buffer(-0.32)
    assert max(part.area for part in shapely.get_parts(office)) > 0.97 * office.area  # every room can be reached
    trap = load_world(Path("trap")).open_floor()
    assert not trap.buffer(-0.3).contains(shapely.Point(10.0, 3.45))
    assert trap.buffer(-0.3).contains(shapely.Point(10.0, 5.975))


def test_an_open_outline(tmp_path: Path) -> None:
    message = refusal(tmp_path, "[floor]\noutline = [[0, 0], [8, 0], [8, 5]]\n")
    assert message == (
        ":2: [floor]: outline is open: it starts at [0.0, 0.0] and ends at [8.0, 5.0]; repeat the first point at the end"
    )


def test_an_outline_that_crosses_itself(tmp_path: Path) -> None:
    message = refusal(tmp_path, FLOOR + "[[polygon]]\noutline = [[1, 1], [3, 3], [3, 1], [1, 3], [1, 1]]\n")
    assert message == ":4: [polygon]: outline crosses or touches itself at (2, 2); reorder its corners"


BAD = {
    "unknown top-level key": (FLOOR + "[[wal]]\nline = [[0, 0], [1, 1]]\n", "unknown key 'wal'; did you mean 'wall'?"),
    "unknown key": (FLOOR + "[[wall]]\nlin = [[0, 0], [1, 1]]\n", "unknown key 'lin'; did you mean 'line'?"),
    "no floor": ('title = "x"\n', "table [floor] with its outline is missing"),
    "floor no table": ("floor = 3\n", "write 'floor' as a table [floor]"),
    "wall no list": (FLOOR + "[wall]\nline = [[0, 0], [1, 1]]\n", "write each wall as [[wall]]"),
    "title no text": ("title = 3\n" + FLOOR, "title = 3 must be text"),
    "point no pair": (FLOOR + "[[wall]]\nline = [[0, 0], [1, 1, 1]]\n", "[1.0, 1.0, 1.0] must be a pair [x, y]"),
    "point far away": (FLOOR + "[[wall]]\nline = [[0, 0], [1, 2e7]]\n", "outside [-1000, 1000] m"),
    "point no number": (FLOOR + '[[wall]]\nline = [[0, 0], [1, "a"]]\n', "must be float"),
    "infinite": (FLOOR + "[[wall]]\nline = [[0, 0], [1, inf]]\n", "must be finite"),
    "one point": (FLOOR + "[[wall]]\nline = [[0, 0]]\n", "line has 1 points, it needs at least 2"),
    "no length": (FLOOR + "[[wall]]\nline = [[1, 1], [1, 1]]\n", "line has no length"),
    "thickness": (FLOOR + "[[wall]]\nline = [[0, 0], [1, 1]]\nthickness_m = 0\n", "thickness_m = 0.0 is outside"),
    "surface": (FLOOR + '[[wall]]\nline = [[0, 0], [1, 1]]\nsurface = "soft"\n', "must be one of 'smooth', 'rough'"),
    "two corners": (FLOOR + "[[polygon]]\noutline = [[1, 1], [2, 2], [1, 1]]\n", "has 2 corners, it needs at least 3"),
    "box size": (FLOOR + "[[box]]\ncentre = [1, 1]\nsize = [1, -1]\n", "must be two positive lengths"),
    "box centre": (FLOOR + "[[box]]\ncentre = [1]\nsize = [1, 1]\n", "centre: [1.0] must be a pair"),
    "radius": (FLOOR + "[[circle]]\ncentres = [[1, 1]]\nradius_m = -1\n", "radius_m = -1.0 is outside"),
    "all built over": (FLOOR + "[[box]]\ncentre = [4, 2.5]\nsize = [9, 9]\n", "no floor is free"),
    "start incomplete": (FLOOR + "[start]\nx_m = 1.0\n", "'y_m' is missing"),
    "person": (FLOOR + "[[person]]\npath = [[1, 1], [3, 1]]\nspeed_mps = -1\n", "speed_mps = -1.0 is outside"),
    "person through a wall": (
        FLOOR + "[[wall]]\nline = [[2, 0], [2, 3]]\n[[person]]\npath = [[1, 1], [3, 1]]\n",
        "path goes through a wall or a thing between [1.0, 1.0] and [3.0, 1.0]; move it",
    ),
    "no TOML": ("[floor\n", "not valid TOML"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_worlds(tmp_path: Path, name: str) -> None:
    text, says = BAD[name]
    assert says in refusal(tmp_path, text)


@pytest.mark.parametrize(
    ("x", "y", "says"),
    [
        (9.0, 2.0, "starts outside the floor"),
        (5.0, 2.0, "starts inside a wall or a thing"),
        (3.0, 2.0, "starts inside a wall or a thing"),
        (0.2, 2.0, "touches what is 0.200 m away"),
    ],
)
def test_a_robot_that_starts_where_it_cannot(tmp_path: Path, x: float, y: float, says: str) -> None:
    things = "[[box]]\ncentre = [5, 2]\nsize = [1, 1]\n[[circle]]\ncentres = [[3, 2]]\nradius_m = 0.3\n"
    world = load_world_file(write(tmp_path, FLOOR + things))
    with pytest.raises(MissionError, match=says) as caught:
        world.start_pose(Pose(x_m=x, y_m=y, heading_rad=0.0), 0.3)
    assert "for example to (" in str(caught.value)
    suggestion = str(caught.value).rsplit("(", 1)[1].strip(")").split(", ")
    world.start_pose(Pose(x_m=float(suggestion[0]), y_m=float(suggestion[1]), heading_rad=0.0), 0.3)


def test_a_robot_too_large_for_the_world(tmp_path: Path) -> None:
    world = load_world_file(write(tmp_path, FLOOR))
    with pytest.raises(MissionError, match="no place in this world is wide enough"):
        world.start_pose(None, 3.0)


def test_unknown_worlds_and_files(tmp_path: Path) -> None:
    with pytest.raises(
        MissionError, match=r"unknown world 'labb'; did you mean 'lab'\? \(shipped: hall, lab, office, trap"
    ):
        load_world(Path("labb"))
    with pytest.raises(MissionError, match="does not exist"):
        load_world(tmp_path / "none.toml")
    with pytest.raises(MissionError, match="is a folder"):
        load_world(tmp_path)
    (tmp_path / "w.txt").write_text("x")
    with pytest.raises(MissionError, match=r"neither a world \(\.toml\) nor a ROS map \(\.yaml\)"):
        load_world(tmp_path / "w.txt")
