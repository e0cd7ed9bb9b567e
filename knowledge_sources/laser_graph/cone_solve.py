"""Looks back on a whole drive with cones: windows of readings are matched along the way, then where the robot came back to.

Odometry's systematic errors come first, from the echoes (`odometry_search`), and are fitted anew after every round; where a
drive does not close, other starts are tried and the one with most closures is kept. Source: as `solve`; windows of
consecutive scans after Bosse and Zlot 2008, "Map matching and data association for large-scale two-dimensional laser
scan-based SLAM".
"""

from itertools import islice

import numpy as np

from knowledge_sources.laser_graph.bend import dead_reckon
from knowledge_sources.laser_graph.carving import carve, contradicted_fraction
from knowledge_sources.laser_graph.closures import Closures, agreeing, candidates
from knowledge_sources.laser_graph.cone_windows import match_windows
from knowledge_sources.laser_graph.cones import Cones
from knowledge_sources.laser_graph.field import Window
from knowledge_sources.laser_graph.odometry_model import OdometryModel, fit_odometry
from knowledge_sources.laser_graph.odometry_search import starting_models
from knowledge_sources.laser_graph.pose_graph import Edges, Indices, solve_graph
from knowledge_sources.laser_graph.poses import Floats, between, compose
from knowledge_sources.laser_graph.solution import Solution

STARTS = 3
# as in `solve`: how near a place must seem to be one met again, how far off it is searched (m, rad), every how manieth
# keyframe; the first rounds only straighten the way itself
ROUNDS = (
    (0.0, 0.0, 0.0, 2),
    (0.0, 0.0, 0.0, 2),
    (4.0, 3.0, 0.5, 2),
    (4.0, 3.0, 0.5, 2),
    (3.0, 1.0, 0.2, 2),
    (3.0, 0.6, 0.15, 1),
)
LEAST_FIT = 0.5
ALONG_WINDOW = Window(
    shift_m=0.6, turn_rad=0.2
)  # three sigmas of odometry without its systematic errors over ten metres
ALONG_LEAST_FIT = 0.35  # such a window cannot be far off
ALONG_STEPS = (12, 18)  # keyframes between windows of the same pass: they share a few readings, and hardly any
APART = 25  # keyframes between two passes: windows that share none
WINDOW_DOUBT = 10.0  # the points of a window err together
AGREE_M, AGREE_RAD = 0.5, 0.15  # windows of cones are blurred by a raster's cells, and lie up to 16 keyframes apart


def solve_cones(cones: Cones, odometry: Floats, at: Indices) -> Solution:
    """Return the keyframes of a drive with cones, keyframe k at reading `at[k]` of the odometry (m, 3). Two at least."""
    best: Solution | None = None
    for model in islice(starting_models(cones, odometry, at), STARTS):
        solution = _solve_from(cones, odometry, at, model)
        if best is None or solution.closures > best.closures:
            best = solution
        if best.closed:
            break
    assert best is not None
    return best


def _solve_from(cones: Cones, odometry: Floats, at: Indices, model: OdometryModel) -> Solution:
    pieces = between(odometry[at[:-1]], odometry[at[1:]])
    reckoned = poses = compose(odometry[0], dead_reckon(odometry, model)[at])  # the map begins where odometry does
    pairs: list[tuple[int, int]] = []
    found = 0
    for near_m, shift_m, turn_rad, every in ROUNDS:
        keep = carve(cones, poses)
        way = [(i - step, i) for i in range(0, len(at), 2) for step in ALONG_STEPS if step <= i]
        along = match_windows(cones, poses, keep, way, ALONG_WINDOW, ALONG_LEAST_FIT)
        closures = Closures.of([])
        if near_m > 0.0:
            pairs = candidates(poses, near_m, every, APART, np.pi)
            window = Window(shift_m=shift_m, turn_rad=turn_rad)
            matched = match_windows(cones, poses, keep, pairs, window, LEAST_FIT)
            closures = agreeing(matched, poses, AGREE_M, AGREE_RAD)
            found = len(closures)
        poses = solve_graph(poses, _edges(reckoned, pieces, model, along, closures))
        model = fit_odometry(pieces, between(poses[:-1], poses[1:]))
        reckoned = dead_reckon(odometry, model)[at]
    contradicted, seen_again = contradicted_fraction(cones, poses)
    return Solution(poses, model, found, len(pairs), seen_again, contradicted)


def _edges(reckoned: Floats, pieces: Floats, model: OdometryModel, along: Closures, closures: Closures) -> Edges:
    """Return odometry's steps, which hold, and what the windows say, which may be wrong."""
    steps = np.arange(len(pieces))
    sigmas = model.sigmas(np.hypot(pieces[:, 0], pieces[:, 1]), np.abs(pieces[:, 2]))
    matched = len(along) + len(closures)
    return Edges(
        np.concatenate([steps, along.first, closures.first]),
        np.concatenate([steps + 1, along.last, closures.last]),
        np.concatenate([between(reckoned[:-1], reckoned[1:]), along.measured, closures.measured]),
        np.concatenate(
            [np.eye(3) / sigmas[:, None, :] ** 2, along.information / WINDOW_DOUBT, closures.information / WINDOW_DOUBT]
        ),
        np.concatenate([np.zeros(len(steps), np.bool_), np.ones(matched, np.bool_)]),
    )
