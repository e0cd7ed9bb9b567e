"""Each part of the laser graph by hand: a box room, a square drive, a known odometry."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.messages.geometry import IDENTITY
from blackboard.messages.sensing import LaserScan, RobotDescription, SonarScan, SonarSensor
from knowledge_sources.laser_graph.bend import bend
from knowledge_sources.laser_graph.closures import Closures, agreeing
from knowledge_sources.laser_graph.cones import cones_of_sonars
from knowledge_sources.laser_graph.field import Window, lay_field, search
from knowledge_sources.laser_graph.map_points import beam_ends, echo_middles
from knowledge_sources.laser_graph.odometry_model import OdometryModel, fit_odometry
from knowledge_sources.laser_graph.point_to_line import align, surface
from knowledge_sources.laser_graph.pose_graph import Edges, solve_graph
from knowledge_sources.laser_graph.poses import Floats, between, compose, transform, wrap
from knowledge_sources.laser_graph.scan_points import ScanPoints, scan_points

COORDINATE = st.floats(-20, 20)
POSE = st.tuples(COORDINATE, COORDINATE, st.floats(-3.1, 3.1)).map(np.array)
NO_PRIOR = np.eye(3) * 1e-6


def scan_in_a_box(pose: Floats, half_x_m: float = 3.0, half_y_m: float = 2.0) -> ScanPoints:
    """Return what a laser all round sees at a pose in a box room about the origin."""
    angles = np.linspace(-pi, pi, 360, endpoint=False)
    c, s = np.cos(angles + pose[2]), np.sin(angles + pose[2])
    with np.errstate(divide="ignore"):
        to_x = (np.where(c > 0, half_x_m, -half_x_m) - pose[0]) / c
        to_y = (np.where(s > 0, half_y_m, -half_y_m) - pose[1]) / s
    ranges = np.minimum(np.abs(to_x), np.abs(to_y))
    scan = LaserScan(angle_min_rad=-pi, angle_step_rad=2 * pi / 360, ranges_m=tuple(ranges.tolist()))
    return scan_points(scan, IDENTITY, 30.0)


@given(POSE, POSE)
def test_between_undoes_compose(a: Floats, b: Floats) -> None:
    found = between(a, compose(a, b))
    assert np.allclose(found[:2], b[:2], atol=1e-9)
    assert abs(float(wrap(found[2] - b[2]))) < 1e-9


def test_normals_look_at_the_laser() -> None:
    scan = scan_in_a_box(np.array([0.5, -0.3, 0.0]))
    assert scan.flat.mean() > 0.9
    assert (np.sum(scan.normals * -scan.points, axis=1)[scan.flat] > 0).all()
    right = scan.flat & (np.abs(scan.points[:, 0] - 2.5) < 1e-6) & (np.abs(scan.points[:, 1]) < 1.0)
    assert np.allclose(scan.normals[right], [-1.0, 0.0], atol=1e-6)


def test_search_and_alignment_find_a_known_offset() -> None:
    there, here = np.zeros(3), np.array([0.31, -0.17, 0.12])
    before, now = scan_in_a_box(there), scan_in_a_box(here)
    found, fit = search(
        lay_field(before.points, (-4, -4, 4, 4)), now.points, np.zeros(3), Window(shift_m=0.6, turn_rad=0.3)
    )
    assert fit > 0.6
    assert np.hypot(*(found - here)[:2]) < 0.08
    target = surface(before.points[before.flat], before.normals[before.flat])
    fine = align(target, now.points[now.flat], now.normals[now.flat], found, found, NO_PRIOR)
    assert np.allclose(fine.pose, here, atol=1e-3)
    assert fine.matched_fraction > 0.9


def test_nothing_moves_along_a_corridor_but_by_the_prior() -> None:
    scan = scan_in_a_box(np.zeros(3), half_x_m=1000.0, half_y_m=1.0)
    near = np.abs(scan.points[:, 0]) < 8.0
    points, normals = scan.points[near & scan.flat], scan.normals[near & scan.flat]
    guess = np.array([0.4, 0.1, 0.02])
    found = align(surface(points, normals), points, normals, guess, guess, np.diag([1.0, 1.0, 1.0]))
    assert found.pose[1:] == pytest.approx([0.0, 0.0], abs=1e-3)
    assert found.pose[0] == pytest.approx(0.4, abs=1e-2)
    assert found.information[0, 0] < 0.01 * found.information[1, 1]


def test_a_square_drive_closes() -> None:
    true = np.array([[0, 0, 0], [4, 0, pi / 2], [4, 4, -pi], [0, 4, -pi / 2], [0, 0, 0]], dtype=float)
    steps = between(true[:-1], true[1:])
    drifting = steps + np.array([0.1, 0.0, 0.08])
    poses = [true[0]]
    for step in drifting:
        poses.append(compose(poses[-1], step))
    start = np.array(poses)
    assert np.hypot(*start[-1, :2]) > 0.5
    edges = Edges(
        np.array([0, 1, 2, 3, 0]),
        np.array([1, 2, 3, 4, 4]),
        np.concatenate([drifting, between(true[:1], true[4:])]),
        np.repeat(np.diag([100.0, 100.0, 400.0])[None], 5, axis=0) * np.array([1, 1, 1, 1, 1e4])[:, None, None],
        np.array([False] * 4 + [True]),
    )
    solved = solve_graph(start, edges)
    assert np.hypot(*solved[-1, :2]) < 0.02
    assert np.hypot(*(solved[2] - true[2])[:2]) < np.hypot(*(start[2] - true[2])[:2])
    assert solved[0] == pytest.approx(true[0], abs=1e-9)  # the first pose is held


def test_a_closure_that_stands_alone_is_dropped() -> None:
    poses = np.column_stack([np.arange(40.0), np.zeros(40), np.zeros(40)])
    first, last = np.array([2, 3, 4, 5]), np.array([30, 31, 32, 33])
    measured = between(poses[first], poses[last])
    measured[3] += [3.0, 0.0, 0.0]
    kept = agreeing(Closures(first, last, measured, np.repeat(np.eye(3)[None], 4, axis=0)), poses)
    assert kept.last.tolist() == [30, 31, 32]


def test_odometry_errors_are_found() -> None:
    rng = np.random.default_rng(3)
    raw = np.column_stack([rng.uniform(0.3, 1.5, 200), np.zeros(200), rng.normal(0, 0.3, 200)])
    true = OdometryModel(distance_scale=0.96, turn_scale=0.98, drift_rad_per_m=0.05)
    corrected = true.correct(raw) + rng.normal(0, 0.002, (200, 3))
    corrected[::10] += 0.5  # gross errors do not move it
    found = fit_odometry(raw, corrected)
    assert found.distance_scale == pytest.approx(0.96, abs=0.005)
    assert found.turn_scale == pytest.approx(0.98, abs=0.01)
    assert found.drift_rad_per_m == pytest.approx(0.05, abs=0.005)
    assert fit_odometry(raw[:10], corrected[:10]) == OdometryModel()


def test_a_bent_way_passes_through_its_keyframes() -> None:
    odometry = np.column_stack([np.linspace(0, 10, 101), np.zeros(101), np.zeros(101)])
    at = np.array([10, 50, 100])
    keyframes = np.array([[1.0, 0.2, 0.1], [5.0, 0.6, 0.1], [9.8, 1.0, 0.0]])
    way = bend(odometry, at, keyframes, OdometryModel())
    assert np.allclose(way[at], keyframes, atol=1e-9)
    assert np.hypot(*np.diff(way[:, :2], axis=0).T).max() < 0.15  # no jumps
    assert np.allclose(transform(keyframes[0], np.array([[1.0, 0.0]]))[0], way[20, :2], atol=0.2)


def test_the_map_s_points_are_means_of_cells_that_were_seen_twice() -> None:
    scan = ScanPoints(np.array([[1.01, 0.01], [3.0, 0.02], [9.0, 0.0]]), np.zeros((3, 2)), np.zeros(3, np.bool_))
    points = beam_ends([scan, scan], np.array([[0.0, 0.0, 0.0], [0.02, 0.02, 0.0]]))
    assert points.points.unpack().tolist() == [pytest.approx([1.02, 0.02]), pytest.approx([3.01, 0.03])]
    assert points.sensed_from.unpack().tolist() == [[0.0, 0.0], [0.0, 0.0]]
    assert beam_ends([scan], np.zeros((1, 3))).points.shape == (0, 2)
    assert beam_ends([scan], np.zeros((1, 3))).dropped == 2  # the third is too far off


def test_the_middle_of_what_is_left_of_an_arc_counts() -> None:
    ring = RobotDescription(
        name="one",
        radius_m=0.2,
        max_speed_mps=1.0,
        max_turn_radps=1.0,
        max_acceleration_mps2=1.0,
        sonars=(SonarSensor(mount=IDENTITY, cone_rad=0.4, max_range_m=5.0),),
    )
    cones = cones_of_sonars([SonarScan(sensors=(0,), ranges_m=(2.0,))], ring)
    whole = np.ones((1, 1, cones.arcs.shape[2]), dtype=np.bool_)
    assert echo_middles(cones, np.zeros((1, 3)), whole).points.shape == (0, 2)  # 0.7 m long
    part = whole.copy()
    part[..., 2:] = False
    ends = cones.arcs[0, 0, :2]
    found = echo_middles(cones, np.array([[0.0, 0.0, pi / 2]]), part).points.unpack()
    assert found[0].tolist() == pytest.approx([-ends[:, 1].mean(), ends[:, 0].mean()])
