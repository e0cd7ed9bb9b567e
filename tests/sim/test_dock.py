from math import cos, pi, sin
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import MissionError
from blackboard.kinds import BATTERY
from blackboard.messages.geometry import Pose
from blackboard.messages.motion import Drive
from sim.dock import Charge, Dock
from sim.simulated import SimulatedRobot
from sim.simulated_params import SimulatedRobotParams
from sim.world_file import load_world_file

DOCK = Dock(x_m=2.0, y_m=0.0, heading_rad=0.0)


def at(x_m: float, y_m: float = 0.0, heading_rad: float = 0.0) -> Pose:
    return Pose(x_m=x_m, y_m=y_m, heading_rad=heading_rad)


@pytest.mark.parametrize(
    ("pose", "charges"),
    [
        (at(1.5), True),  # a rim of radius 0.3 is 0.2 m away
        (at(1.49), False),
        (at(1.7), True),  # touches
        (at(1.9), True),  # stands over a pad on the floor
        (at(2.2), False),
        (at(1.6, 0.09), True),
        (at(1.6, -0.11), False),
        (at(1.6, 0.0, pi / 10), True),
        (at(1.6, 0.0, -pi / 8), False),
        (at(1.6, 0.0, pi), False),
    ],
)
def test_a_robot_is_charged_that_stands_straight_before_the_pad(pose: Pose, charges: bool) -> None:
    assert DOCK.charges(pose, 0.3) == charges


@given(st.floats(1.0, 3.0), st.floats(-0.5, 0.5), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_turning_the_whole_world_changes_nothing(x: float, y: float, heading: float, turn: float) -> None:
    turned = Dock(x_m=2.0 * cos(turn), y_m=2.0 * sin(turn), heading_rad=turn, reach_m=0.2 + 1e-9, aside_m=0.1 + 1e-9)
    pose = at(0.0, 0.0, turn) @ at(x, y, heading)
    if DOCK.charges(at(x, y, heading), 0.3):
        assert turned.charges(pose, 0.3)


def test_the_battery_is_never_more_than_full_nor_owes_anything() -> None:
    charge = Charge(given=0.5)
    assert charge.left(0.2) == 1.0
    assert charge.left(0.3) == pytest.approx(0.9)
    assert charge.left(1.5) == 0.0
    charge.stand(360.0, at(1.6), 0.3, [DOCK])
    assert charge.left(1.5) == pytest.approx(0.1)
    charge.stand(360.0, at(1.0), 0.3, [DOCK])
    assert charge.left(1.5) == pytest.approx(0.1)


def test_an_empty_robot_at_a_dock_is_charged_and_drives_again(tmp_path: Path) -> None:
    shipped = Path(__file__).resolve().parents[2] / "sim/robots/k2a.toml"
    tired = shipped.read_text(encoding="utf-8").replace("standing_s = 28800.0", "standing_s = 10.0")
    (tmp_path / "tired.toml").write_text(tired.replace("[battery]", "[battery]\nrate_hz = 1"), encoding="utf-8")
    (tmp_path / "world.toml").write_text(
        "[floor]\noutline = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]\n"
        "[start]\nx_m = 3.55\ny_m = 2.0\n[[dock]]\nx_m = 4.0\ny_m = 2.0\nheading_deg = 0\ncharging_s = 5\n",
        encoding="utf-8",
    )
    params = SimulatedRobotParams(robot=tmp_path / "tired.toml", world=tmp_path / "world.toml")
    robot = SimulatedRobot(params, name="robot")
    charges = [r.value.charge_fraction for r in robot.advance(8.0) if r.kind is BATTERY]
    assert charges == [1.0] * 9  # what it uses it gets
    robot.drive(Drive(forward_mps=-0.3, turn_radps=0.0, limited_by="nothing"))
    away = [r.value.charge_fraction for r in robot.advance(30.0) if r.kind is BATTERY]
    assert away[-1] == 0.0
    assert away == sorted(away, reverse=True)


def test_it_may_start_with_less_than_full() -> None:
    robot = SimulatedRobot(SimulatedRobotParams(start_charge_fraction=0.25), name="robot")
    charges = [r.value.charge_fraction for r in robot.advance(10.0) if r.kind is BATTERY]
    assert charges == [0.25, pytest.approx(0.25 - 10.0 / 28800.0, abs=1e-5)]
    with pytest.raises(MissionError, match="start_charge_fraction"):
        SimulatedRobotParams(start_charge_fraction=1.5)


def test_shipped_docks_have_room_for_the_robots() -> None:
    for name in ("lab", "office"):
        params = SimulatedRobotParams(world=Path(name))
        world = load_world_file(Path(__file__).resolve().parents[2] / f"sim/worlds/{name}.toml")
        (dock,) = world.docks
        away_m = 0.4
        x, y = dock.x_m - away_m * cos(dock.heading_rad), dock.y_m - away_m * sin(dock.heading_rad)
        place = SimulatedRobotParams(world=params.world, start_x_m=x, start_y_m=y, start_heading_rad=dock.heading_rad)
        assert dock.charges(SimulatedRobot(place, name="robot").true_pose(), 0.3)


@pytest.mark.parametrize(
    ("dock", "says"),
    [
        ("x_m = 5\ny_m = 2\nheading_deg = 0", ":3: [dock]: (5, 2) is outside the floor; move the dock"),
        ("x_m = 4\ny_m = 2", "'heading_rad' is missing"),
        ("x_m = 4\ny_m = 2\nheading_deg = 0\ncharging_s = 0", "charging_s = 0.0 is outside [1, 1e6]"),
    ],
)
def test_bad_docks(tmp_path: Path, dock: str, says: str) -> None:
    path = tmp_path / "world.toml"
    path.write_text(
        f"floor = {{outline = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]}}\n[[dock]]\n{dock}\n", encoding="utf-8"
    )
    with pytest.raises(MissionError) as caught:
        load_world_file(path)
    assert says in str(caught.value)
