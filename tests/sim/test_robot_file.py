"""Robots in TOML: the shipped ones are as their sources say, and what each mistake says."""

from math import pi, radians
from pathlib import Path

import pytest

from blackboard.errors import MissionError
from blackboard.vocabulary import Vocabulary
from sim.robot_file import load_robot
from sim.shipped import shipped_names

BODY = """[body]
name = "mine"
radius_m = 0.2
max_speed_mps = 0.5
max_turn_degps = 90
max_acceleration_mps2 = 0.5
max_turn_acceleration_radps2 = 2.0
"""
SONAR = "[sonar]\ncone_deg = 12\nmax_range_m = 5\nbearings_deg = [0, 90]\n"


def write(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(text)
    return path


def test_the_k2a_is_the_thesis_robot() -> None:
    robot = load_robot(Path("k2a")).description()
    assert len(robot.sonars) == 12
    assert {s.cone_rad for s in robot.sonars} == {radians(12)}
    assert {s.max_range_m for s in robot.sonars} == {10.0}
    for i, sonar in enumerate(robot.sonars):
        turn = sonar.mount.heading_rad - robot.sonars[i - 1].mount.heading_rad
        assert turn % (2 * pi) == pytest.approx(radians(30))
        assert (sonar.mount.x_m**2 + sonar.mount.y_m**2) ** 0.5 == pytest.approx(robot.radius_m)
    assert robot.lasers == ()
    assert robot.bumper


def test_the_pioneer_has_a_ring_and_a_laser() -> None:
    model = load_robot(Path("pioneer"))
    robot = model.description()
    assert len(robot.sonars) == 16
    assert {s.cone_rad for s in robot.sonars} == {radians(25)}
    assert {s.max_range_m for s in robot.sonars} == {5.0}
    left, right = sorted(s.mount.y_m for s in robot.sonars), sorted(-s.mount.y_m for s in robot.sonars)
    assert left == pytest.approx(right)
    assert all((s.mount.x_m**2 + s.mount.y_m**2) ** 0.5 <= robot.radius_m for s in robot.sonars)
    (laser,) = model.lasers
    assert (laser.beams, laser.field_rad) == (181, pi)
    assert laser.step_rad == pytest.approx(radians(1))


def test_descriptions_are_fit_for_the_board() -> None:
    assert shipped_names("robots") == ["k2a", "k2a_camera", "k2a_near", "k2a_worn", "pioneer"]
    for name in shipped_names("robots"):
        assert Vocabulary() is not None
        assert load_robot(Path(name)).description().name == name


def test_a_robot_needs_no_sonar(tmp_path: Path) -> None:
    robot = load_robot(write(tmp_path, BODY + "[[laser]]\nbeams = 360\nfield_deg = 360\nmax_range_m = 4\n"))
    assert robot.sonar is None
    assert robot.lasers[0].step_rad == pytest.approx(radians(1))
    assert robot.body.max_turn_radps == pytest.approx(pi / 2)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "table [body] is missing"),
        (BODY + "[sonra]\n", ":8: [sonra]: unknown table 'sonra'; did you mean 'sonar'?"),
        (BODY + "[laser]\nbeams = 3\n", "write each laser as [[laser]]"),
        (BODY + SONAR + "con_deg = 3\n", ":12: [sonar]: unknown key 'con_deg'; did you mean 'cone_deg'?"),
        (BODY.replace("0.2", "-0.2"), ":3: [body]: radius_m = -0.2 is outside (0, 100]"),
        (BODY.replace('"mine"', "7"), "name = 7 must be str"),
        (BODY.replace("radius_m = 0.2\n", ""), "'radius_m' is missing"),
        (BODY + SONAR + "rate_hz = 100\n", "rate_hz = 100.0 is outside (0, 40]"),
        (BODY + SONAR + "missed_fraction = 2\n", "missed_fraction = 2.0 is outside [0, 1]"),
        (BODY + SONAR + "mounts = [[0, 0, 0]]\n", "'bearings_deg' or as 'mounts', one of the two"),
        (BODY + SONAR.replace("bearings_deg = [0, 90]", "mounts = [[0, 0]]"), "the form [x_m, y_m, heading_deg]"),
        (BODY + SONAR.replace("[0, 90]", "[]"), "one of the two"),
        (BODY + "[[laser]]\nbeams = 1\nfield_deg = 180\nmax_range_m = 4\n", "beams = 1 is outside [2, 8192]"),
        (BODY + "[odometry]\ndistance_scale = 9\n", "distance_scale = 9.0 is outside [0.5, 2]"),
        (BODY + "[battery]\nstanding_s = 0\n", "standing_s = 0.0 is outside (0, inf)"),
        (BODY + "battery = 3\n", "unknown key 'battery'"),
        ("odometry = 3\n" + BODY, "write 'odometry' as a table [odometry]"),
    ],
)
def test_bad_robots(tmp_path: Path, text: str, says: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(MissionError) as caught:
        load_robot(path)
    assert str(caught.value).startswith(str(path))
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_unknown_robot() -> None:
    with pytest.raises(
        MissionError,
        match=r"unknown robot 'pionier'; did you mean 'pioneer'\? \(shipped: k2a, k2a_camera, k2a_near, k2a_worn, pioneer",
    ):
        load_robot(Path("pionier"))
