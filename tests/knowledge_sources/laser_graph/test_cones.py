"""Cones by hand and on drives round a room whose shape is known: arcs, carving, contradictions, odometry, windows, the whole."""

from math import pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import LaserScan, LaserSensor, RobotDescription, SonarScan, SonarSensor
from knowledge_sources.laser_graph.bend import dead_reckon
from knowledge_sources.laser_graph.carving import carve, contradicted_fraction, unbroken_fraction
from knowledge_sources.laser_graph.cone_solve import solve_cones
from knowledge_sources.laser_graph.cone_windows import match_windows
from knowledge_sources.laser_graph.cones import Cones, cones_of_lasers, cones_of_sonars, depth
from knowledge_sources.laser_graph.field import Window
from knowledge_sources.laser_graph.odometry_model import OdometryModel
from knowledge_sources.laser_graph.odometry_search import starting_models
from knowledge_sources.laser_graph.poses import Floats, between, compose, wrap

RING = 12
LAP = 32  # keyframes
# an L-shaped hall, 9 m by 6 m, with a pillar: no two places of it look alike
WALLS = np.array(
    [
        [0, 0, 9, 0],
        [9, 0, 9, 6],
        [9, 6, 5, 6],
        [5, 6, 5, 4.5],
        [5, 4.5, 0, 4.5],
        [0, 4.5, 0, 0],
        [4, 2, 4.6, 2],
        [4.6, 2, 4.6, 2.4],
        [4.6, 2.4, 4, 2.4],
        [4, 2.4, 4, 2],
    ],
    dtype=float,
)


def robot(sonars: int = RING, cone_deg: float = 30.0) -> RobotDescription:
    mounts = [Pose(x_m=0.0, y_m=0.0, heading_rad=float(wrap(np.array(2 * pi * k / sonars)))) for k in range(sonars)]
    return RobotDescription(
        name="ring",
        radius_m=0.2,
        max_speed_mps=1.0,
        max_turn_radps=2.0,
        max_acceleration_mps2=1.0,
        sonars=tuple(SonarSensor(mount=m, cone_rad=radians(cone_deg), max_range_m=8.0) for m in mounts),
        lasers=(LaserSensor(mount=IDENTITY, max_range_m=8.0),),
    )


def rays(pose: Floats, bearings: Floats, walls: Floats) -> Floats:
    """Return how far it is to the nearest wall from a pose along bearings, robot frame."""
    d = np.stack([np.cos(bearings + pose[2]), np.sin(bearings + pose[2])], axis=1)
    a, e = walls[:, :2] - pose[:2], walls[:, 2:] - walls[:, :2]
    cross = d[:, None, 0] * e[:, 1] - d[:, None, 1] * e[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        far = (a[:, 0] * e[:, 1] - a[:, 1] * e[:, 0]) / cross
        along = (a[:, 0] * d[:, None, 1] - a[:, 1] * d[:, None, 0]) / cross
    hit = (far > 0) & (along >= 0) & (along <= 1)
    return np.where(hit, far, np.inf).min(axis=1)


def heard(poses: Floats, walls: Floats = WALLS, farthest_m: float = 8.0) -> Cones:
    """Return what a ring hears along poses: the nearest of fifteen rays in each cone."""
    bearings = (2 * pi * np.arange(RING)[:, None] / RING + radians(28.0) * np.linspace(-0.5, 0.5, 15)).ravel()
    scans = []
    for pose in poses:
        ranges = rays(pose, bearings, walls).reshape(RING, 15).min(axis=1)
        scans.append(
            SonarScan(sensors=tuple(range(RING)), ranges_m=tuple(float(r) if r < farthest_m else None for r in ranges))
        )
    return cones_of_sonars(scans, robot())


def laps(count: int = 2) -> Floats:
    """Return poses every 0.4 m or so round the pillar."""
    t = np.linspace(0, 2 * pi * count, LAP * count)
    x, y = 4.3 + 2.9 * np.cos(t) + 0.1 * np.sin(3 * t), 2.2 + 1.4 * np.sin(t)
    return np.column_stack([x, y, wrap(np.arctan2(np.gradient(y), np.gradient(x)))])


def drifting(poses: Floats, drift_rad_per_m: float, scale: float = 1.0) -> Floats:
    """Return the odometry of a drive whose heading drifts and whose wheels are not of the size they were taken for."""
    pieces = between(poses[:-1], poses[1:])
    pieces[:, 2] -= drift_rad_per_m * np.hypot(pieces[:, 0], pieces[:, 1])
    pieces[:, :2] /= scale
    odometry = [poses[0]]
    for piece in pieces:
        odometry.append(compose(odometry[-1], piece))
    return np.array(odometry)


def test_depth_by_hand() -> None:
    # One echo at 2 m straight ahead in a cone of 30 degrees: a margin is 0.12 m and 2 % of 2 m.
    scan = SonarScan(sensors=(0,), ranges_m=(2.0,))
    cones = cones_of_sonars([scan], robot(sonars=1))
    points = np.array([[[1.0, 0.0], [2.0, 0.0], [2.32, 0.0], [-1.0, 0.0], [1.0, 0.3], [1.0, 0.25]]])
    found = depth(cones, np.array([0]), points)[0]
    assert found[:4] == pytest.approx([1.0 / 0.16, 0.0, -2.0, -np.inf])
    assert found[4] == -np.inf  # 16.7 degrees off the axis
    assert found[5] == pytest.approx((2.0 - np.hypot(1.0, 0.25)) / 0.16)


def test_what_does_not_return_says_nothing() -> None:
    cones = cones_of_sonars([SonarScan(sensors=(3, 1), ranges_m=(None, 0.7))], robot())
    assert cones.heard[0].tolist() == [False, True] + [False] * 10
    assert cones.free_m[0, [1, 3]].tolist() == [0.7, 0.0]


def test_a_laser_taken_in_sectors_keeps_the_nearest_end_of_each() -> None:
    scan = LaserScan(angle_min_rad=radians(0.5), angle_step_rad=radians(1.0), ranges_m=(3.0, 2.0, 4.0, None, 5.0, 6.0))
    cones = cones_of_lasers([scan], robot())
    assert cones.arcs.shape[1] == 72
    assert cones.free_m[0, :3].tolist() == [2.0, 6.0, 0.0]


def test_an_echo_is_carved_where_another_found_nothing() -> None:
    near, far = SonarScan(sensors=(0,), ranges_m=(1.0,)), SonarScan(sensors=(0,), ranges_m=(2.0,))
    standing = np.zeros((2, 3))
    cones = cones_of_sonars([near, far], robot())
    assert carve(cones, standing).any(axis=2)[:, 0].tolist() == [False, True]
    assert unbroken_fraction(cones, standing) == 0.5
    # Seen from 1 m further on, the far end lies where the near one does, and nothing is broken.
    assert unbroken_fraction(cones, np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])) == 1.0


def test_another_pass_contradicts_a_wrong_way_and_not_the_right_one() -> None:
    poses = laps()
    cones = heard(poses)
    right, seen_again = contradicted_fraction(cones, poses)
    assert right < 0.02
    assert seen_again > 300
    assert contradicted_fraction(cones, dead_reckon(drifting(poses, 0.03), OdometryModel()))[0] > 0.3
    assert contradicted_fraction(cones_of_sonars([], robot()), np.zeros((0, 3))) == (0.0, 0)


@given(st.floats(-3, 3), st.floats(-20, 20), st.floats(-20, 20))
def test_where_the_map_lies_does_not_matter(heading_rad: float, x_m: float, y_m: float) -> None:
    poses = laps(1)[:20]
    moved = compose(np.array([x_m, y_m, heading_rad]), poses)
    cones = heard(poses)
    assert (carve(cones, poses) != carve(cones, moved)).mean() < 0.01  # places on the very margin


@pytest.mark.parametrize(("drift", "scale"), [(0.06, 0.95), (-0.03, 1.0), (0.0, 1.04)])
def test_odometry_s_errors_are_found_from_echoes(drift: float, scale: float) -> None:
    poses = laps()
    odometry = drifting(poses, drift, scale)
    model = next(starting_models(heard(poses), odometry, np.arange(len(poses))))
    # round and round the same way, drift and turn scale are worth the same: what counts is the heading
    error_rad = dead_reckon(odometry, model)[:, 2] - between(poses[0], poses)[:, 2]
    assert np.abs(wrap(error_rad)).max() < 0.3  # over 36 m
    assert model.distance_scale == pytest.approx(scale, abs=0.05)  # the margins leave some slack; the graph refines it


def test_windows_of_two_laps_find_each_other() -> None:
    poses = laps()
    cones = heard(poses)
    keep = carve(cones, poses)
    shifted = poses.copy()
    shifted[LAP:] = compose(np.array([0.3, -0.2, 0.08]), poses[LAP:])
    found = match_windows(cones, shifted, keep, [(16, 16 + LAP)], Window(shift_m=0.8, turn_rad=0.3), 0.5)
    true = between(poses[16], poses[16 + LAP])
    assert len(found) == 1
    assert np.hypot(*(found.measured[0] - true)[:2]) < 0.08
    assert abs(float(wrap(found.measured[0, 2] - true[2]))) < 0.04


def test_a_drive_with_drift_closes() -> None:
    poses = laps()
    odometry = drifting(poses, 0.05, 0.96)
    apart = between(odometry[:-LAP], odometry[LAP:]) - between(poses[:-LAP], poses[LAP:])
    assert np.hypot(*apart[:, :2].T).min() > 0.5
    solution = solve_cones(heard(poses), odometry, np.arange(len(poses)))
    assert solution.closed
    assert solution.closures > 20
    apart = between(solution.poses[:-LAP], solution.poses[LAP:]) - between(poses[:-LAP], poses[LAP:])
    assert np.hypot(*apart[:, :2].T).mean() < 0.05  # the laps lie on each other
    assert np.hypot(*(solution.poses - poses)[:, :2].T).mean() < 0.3


def test_a_drive_that_fits_nothing_seen_before_does_not_close() -> None:
    # The second lap leads through a room of another shape: nothing there is where it was.
    poses = laps()
    other = np.array([[1, -2, 8, -2], [8, -2, 8, 3.5], [8, 3.5, 7, 7], [7, 7, 1, 5.2], [1, 5.2, 1, -2]], dtype=float)
    one, two = heard(poses[:LAP]), heard(poses[LAP:], other)
    both = Cones(
        one.mounts,
        one.widths_rad,
        np.concatenate([one.arcs, two.arcs]),
        np.concatenate([one.heard, two.heard]),
        np.concatenate([one.free_m, two.free_m]),
    )
    solution = solve_cones(both, poses, np.arange(len(poses)))
    assert solution.candidates > 0
    assert not solution.closed
    assert solution.contradicted_fraction > 0.2


def test_a_drive_that_heard_hardly_anything_does_not_close() -> None:
    poses = laps()
    solution = solve_cones(heard(poses, farthest_m=0.5), drifting(poses, 0.05), np.arange(len(poses)))
    assert solution.closures == 0
    assert solution.closed == (solution.candidates == 0)
