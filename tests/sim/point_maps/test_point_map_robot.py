"""A map of points as a robot."""

from pathlib import Path

import numpy as np
import pytest

from blackboard.errors import MissionError
from blackboard.kinds import SUPPORTED_POINTS
from sim.point_maps.robot import PointMap, PointMapParams, one_a_cell


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "two rooms.txt"
    path.write_text("0 0\n0.001 0.001\n1 0\n1 2\n")
    return path


def test_points_come_once_one_a_cell(path: Path) -> None:
    robot = PointMap(PointMapParams(path=path), name="robot")
    (reading,) = robot.advance(0.0)
    assert reading.kind is SUPPORTED_POINTS
    assert reading.value.points.unpack().tolist() == [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0]]
    assert reading.value.sensed_from == reading.value.points
    assert list(robot.advance(1.0)) == []
    assert robot.drawn_lines() is None
    assert robot.summary() == {"points_read": 4, "points": 3}
    assert (robot.start_s, robot.end_s, robot.moves) == (0.0, 0.0, False)


def test_whose_robot_drives_there(path: Path) -> None:
    def radius_m(**params: object) -> float:
        return PointMap(PointMapParams(path=path, **params), name="robot").description.radius_m  # type: ignore[arg-type]

    assert radius_m() == 0.25
    assert radius_m(robot=Path("pioneer")) == 0.26
    assert radius_m(robot=Path("pioneer"), radius_m=0.4) == 0.4
    assert PointMap(PointMapParams(path=path), name="robot").description.name == "two_rooms"
    with pytest.raises(MissionError, match="radius_m"):
        radius_m(radius_m=0.0)
    with pytest.raises(MissionError, match="cell_m"):
        radius_m(cell_m=0.0)


def test_points_on_a_grid_of_the_cells_size_all_stay() -> None:
    on_grid = np.stack(np.meshgrid(np.arange(-100, 100), np.arange(50)), axis=-1).reshape(-1, 2) * 0.02
    assert len(one_a_cell(on_grid, 0.02)) == len(on_grid)
