"""A camera that tells colours: how wide and where a drum looks, what hides it, what it misses and makes up."""

from math import asin, atan2, hypot, radians
from pathlib import Path

import numpy as np
import pytest

from blackboard.errors import MissionError
from blackboard.kinds import BLOBS
from blackboard.messages.sensing import Blob, BlobScan
from sim.camera import camera_fan, look
from sim.robot_file import load_robot
from sim.sensor_models import CameraModel
from sim.simulated import SimulatedRobot
from sim.simulated_params import SimulatedRobotParams
from sim.world import World
from sim.world_file import load_world_file

FLOOR = "[floor]\noutline = [[0, 0], [10, 0], [10, 6], [0, 6], [0, 0]]\n[start]\nx_m = 1.0\ny_m = 3.0\n"
DRUM = '[[circle]]\ncentres = [[4.0, 3.0]]\nradius_m = 0.3\ncolour = "green"\n'
MODEL = CameraModel(
    field_rad=radians(60), max_range_m=6.0, rays=2 * 241 - 1, noise_rad=0.0, missed_fraction=0.0, false_fraction=0.0
)
STEP_RAD = MODEL.field_rad / (MODEL.rays - 1)


def world_of(tmp_path: Path, text: str) -> World:
    path = tmp_path / "world.toml"
    path.write_text(FLOOR + text)
    return load_world_file(path)


def seen(
    world: World, x: float, y: float, heading: float, model: CameraModel = MODEL, seed: int = 0
) -> tuple[Blob, ...]:
    fan = camera_fan(model).moved(x, y, heading)
    return look(fan, world.shapes, world.coloured, model, np.random.default_rng(seed))


@pytest.mark.parametrize(("x", "y", "heading"), [(1.0, 3.0, 0.0), (2.0, 2.0, 0.5), (4.0, 0.5, 1.4), (6.5, 4.0, -2.9)])
def test_a_drum_is_as_wide_as_geometry_says(tmp_path: Path, x: float, y: float, heading: float) -> None:
    (blob,) = seen(world_of(tmp_path, DRUM), x, y, heading)
    assert blob.colour == "green"
    assert blob.bearing_rad == pytest.approx(
        (atan2(3.0 - y, 4.0 - x) - heading + np.pi) % (2 * np.pi) - np.pi, abs=STEP_RAD
    )
    assert blob.width_rad == pytest.approx(2 * asin(0.3 / hypot(4.0 - x, 3.0 - y)), abs=1.01 * STEP_RAD)


def test_what_is_too_far_or_beside_the_field_or_without_a_colour_is_not_seen(tmp_path: Path) -> None:
    world = world_of(tmp_path, DRUM)
    assert seen(world, 1.0, 3.0, 0.7) == ()
    assert seen(world, 1.0, 3.0, 0.0, CameraModel(field_rad=1.0, max_range_m=2.6)) == ()
    assert seen(world_of(tmp_path, DRUM.replace('colour = "green"', "")), 1.0, 3.0, 0.0) == ()


def test_a_wall_hides_half_of_it_and_a_larger_one_all(tmp_path: Path) -> None:
    whole = seen(world_of(tmp_path, DRUM), 1.0, 3.0, 0.0)[0]
    (half,) = seen(world_of(tmp_path, DRUM + "[[wall]]\nline = [[3.0, 3.0], [3.0, 5.0]]\n"), 1.0, 3.0, 0.0)
    assert half.width_rad == pytest.approx(whole.width_rad / 2, abs=2 * STEP_RAD)
    assert half.bearing_rad == pytest.approx(-whole.width_rad / 4, abs=2 * STEP_RAD)
    assert seen(world_of(tmp_path, DRUM + "[[wall]]\nline = [[3.0, 1.0], [3.0, 5.0]]\n"), 1.0, 3.0, 0.0) == ()


def test_two_of_a_colour_that_overlap_look_like_one_and_of_two_colours_like_two(tmp_path: Path) -> None:
    other = DRUM.replace("4.0, 3.0", "5.0, 3.3")
    (one,) = seen(world_of(tmp_path, DRUM + other), 1.0, 3.0, 0.0)
    assert one.width_rad > 2 * asin(0.1)
    two = seen(world_of(tmp_path, DRUM + other.replace("green", "red")), 1.0, 3.0, 0.0)
    assert [blob.colour for blob in two] == ["green", "red"]


def test_a_crate_shows_its_faces(tmp_path: Path) -> None:
    crate = '[[box]]\ncentre = [4.0, 3.0]\nsize = [0.6, 0.6]\ncolour = "red"\n'
    (blob,) = seen(world_of(tmp_path, crate), 1.0, 3.0, 0.0)
    assert blob.width_rad == pytest.approx(2 * atan2(0.3, 2.7), abs=1.01 * STEP_RAD)


def test_some_are_missed_and_some_are_made_up(tmp_path: Path) -> None:
    world = world_of(tmp_path, DRUM)
    missing = CameraModel(field_rad=1.0, max_range_m=6.0, missed_fraction=0.3, false_fraction=0.0)
    counts = [len(seen(world, 1.0, 3.0, 0.0, missing, seed)) for seed in range(400)]
    assert np.mean(counts) == pytest.approx(0.7, abs=0.07)
    inventing = CameraModel(field_rad=1.0, max_range_m=6.0, missed_fraction=0.0, false_fraction=0.2)
    counts = [len(seen(world, 1.0, 3.0, 2.0, inventing, seed)) for seed in range(400)]
    assert np.mean(counts) == pytest.approx(0.2, abs=0.06)


def test_a_robot_with_a_camera_says_what_it_sees_and_one_without_does_not() -> None:
    def blobs(robot: str, seed: int) -> list[BlobScan]:
        params = SimulatedRobotParams(world=Path("warehouse"), robot=Path(robot), start_heading_rad=-2.5)
        simulated = SimulatedRobot(params, name="robot", seed=seed)
        assert (BLOBS in simulated.provides) == (robot == "k2a_camera")
        return [reading.value for reading in simulated.advance(5.0) if reading.kind is BLOBS]

    scans = blobs("k2a_camera", 1)
    assert len(scans) == 21  # 4 a second
    assert {blob.colour for scan in scans for blob in scan.blobs} >= {"blue"}
    assert scans == blobs("k2a_camera", 1) != blobs("k2a_camera", 2)
    assert blobs("k2a", 1) == []
    (camera,) = load_robot(Path("k2a_camera")).description().cameras
    assert (camera.mount.x_m, camera.max_range_m) == (0.2, 4.0)


def test_a_colour_is_a_word(tmp_path: Path) -> None:
    with pytest.raises(MissionError, match=r"world.toml:\d+: .*colour = 'dark green'.* words of letters"):
        world_of(tmp_path, DRUM.replace('"green"', '"dark green"'))
