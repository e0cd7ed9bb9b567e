"""Looks back on a whole drive: closes its loops and solves the graph of poses."""

import numpy as np

from knowledge_sources.laser_graph.carving import contradicted_fraction
from knowledge_sources.laser_graph.closures import agreeing, candidates, match_all
from knowledge_sources.laser_graph.cones import Cones
from knowledge_sources.laser_graph.field import Window
from knowledge_sources.laser_graph.front_end import Tracker
from knowledge_sources.laser_graph.odometry_model import fit_odometry
from knowledge_sources.laser_graph.pose_graph import Edges, solve_graph
from knowledge_sources.laser_graph.poses import between
from knowledge_sources.laser_graph.solution import Solution

# how near a place must seem to be one met again, how far off it is searched (m, rad), and every how manieth scan is tried:
# wide and sparse while the drive has not closed, narrow and dense once it has
ROUNDS = ((4.0, 3.0, 0.5, 2), (3.0, 1.5, 0.3, 2), (3.0, 0.8, 0.2, 1), (3.0, 0.4, 0.1, 1))
# once closed, a round is left out whose window is so much wider than the round before moved any pose; the last never is
LEAVE_OUT = 3.0
STEP_DOUBT = 10.0  # neighbouring points of a scan err together: a step's information counts by a tenth
CLOSED_FRACTION = 0.3  # of the candidates agree with their neighbours: then wide searches bring no more


def solve(tracker: Tracker, cones: Cones) -> Solution:
    """Return the keyframes of a tracked drive, corrected; `cones` are their scans as such. Two keyframes at least."""
    poses, pieces = np.array(tracker.poses), np.array(tracker.pieces)
    count = len(poses)
    steps = np.arange(count - 1)
    tracked, information = between(poses[:-1], poses[1:]), np.array(tracker.information) / STEP_DOUBT
    pairs, found, moved_m = 0, 0, np.inf
    for near_m, shift_m, turn_rad, every in ROUNDS:
        closed = found >= CLOSED_FRACTION * pairs
        if closed and shift_m > LEAVE_OUT * moved_m and shift_m > ROUNDS[-1][1]:
            continue
        before = poses
        tried = candidates(poses, near_m, every)
        closures = agreeing(match_all(tracker.scans, poses, tried, Window(shift_m=shift_m, turn_rad=turn_rad)), poses)
        pairs, found = len(tried), len(closures)
        poses = solve_graph(
            poses,
            Edges(
                np.concatenate([steps, closures.first]),
                np.concatenate([steps + 1, closures.last]),
                np.concatenate([tracked, closures.measured]),
                np.concatenate([information, closures.information / STEP_DOUBT]),
                np.concatenate([np.zeros(count - 1, np.bool_), np.ones(found, np.bool_)]),
            ),
        )
        moved_m = float(np.hypot(*(poses - before)[:, :2].T).max())
    contradicted, seen_again = contradicted_fraction(cones, poses)
    model = fit_odometry(pieces, between(poses[:-1], poses[1:]))
    return Solution(poses, model, found, pairs, seen_again, contradicted)
