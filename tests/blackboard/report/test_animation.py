import numpy as np
import pytest
from PIL import Image

from blackboard.messages.geometry import Pose
from blackboard.report import palette
from blackboard.report.animation import FOOT_PX, WIDTH_PX, Frame, write_animation


@pytest.fixture
def frames(result) -> list[Frame]:
    """The run of `result` in six moments; the grid is known up to where the robot is."""
    taken = []
    for count in (1, 13, 25, 37, 49, 61):
        path = result.trajectory[:count]
        cells = result.grid.cells.copy()
        cells[:, int((path[-1, 1] + 0.5) / 0.05) :] = 128
        taken.append(
            Frame(
                stamp_s=float(path[-1, 0]),
                pose=Pose(x_m=path[-1, 1], y_m=path[-1, 2], heading_rad=path[-1, 3]),
                trajectory=path,
                grid=type(result.grid)(cells, result.grid.x_min_m, result.grid.y_min_m, result.grid.cell_m),
                lines=[e.value for e in result.lines] if count > 30 else [],
            )
        )
    return taken


def test_every_frame_is_there_and_it_repeats(frames, tmp_path):
    write_animation(frames, 0.2, tmp_path / "map.gif")
    with Image.open(tmp_path / "map.gif") as image:
        assert image.n_frames == 6
        assert image.width == WIDTH_PX
        assert image.info["loop"] == 0


def test_the_same_frames_give_the_same_bytes(frames, tmp_path):
    for name in ("one.gif", "two.gif"):
        write_animation(frames, 0.2, tmp_path / name)
    assert (tmp_path / "one.gif").read_bytes() == (tmp_path / "two.gif").read_bytes()


def test_unknown_becomes_empty_where_the_robot_has_been(frames, tmp_path):
    write_animation(frames, 0.2, tmp_path / "map.gif")
    with Image.open(tmp_path / "map.gif") as image:
        place = (WIDTH_PX // 2, (image.height - FOOT_PX) * 3 // 4)
        seen = []
        for number in range(image.n_frames):
            image.seek(number)
            seen.append(image.convert("RGB").getpixel(place))
    assert seen[0] == palette.UNKNOWN_COLOUR
    assert seen[-1] == palette.EMPTY_COLOUR


def test_sixty_frames_stay_below_a_megabyte(frames, tmp_path):
    rng = np.random.default_rng(1)
    many = []
    for number in range(60):
        frame = frames[number // 10]
        cells = frame.grid.cells.copy()
        noisy = rng.random(cells.shape) < 0.05  # far more than a grid changes between two moments
        cells[noisy] = rng.integers(0, 256, int(noisy.sum()))
        grid = type(frame.grid)(cells, frame.grid.x_min_m, frame.grid.y_min_m, frame.grid.cell_m)
        many.append(
            Frame(stamp_s=frame.stamp_s + number / 100, pose=frame.pose, trajectory=frame.trajectory, grid=grid)
        )
    write_animation(many, 0.2, tmp_path / "map.gif")
    assert (tmp_path / "map.gif").stat().st_size < 1_000_000


@pytest.mark.parametrize("count", [1, 2])
def test_a_run_without_grid_and_with_one_pose_can_move(frames, tmp_path, count):
    bare = [Frame(stamp_s=1.0, pose=frames[0].pose, trajectory=frames[0].trajectory)] * count
    write_animation(bare, 0.2, tmp_path / "map.gif")
    assert (tmp_path / "map.gif").exists()


def test_no_frames_make_no_file(tmp_path):
    write_animation([], 0.2, tmp_path / "map.gif")
    assert not (tmp_path / "map.gif").exists()
