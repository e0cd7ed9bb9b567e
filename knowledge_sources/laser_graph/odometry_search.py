"""Odometry's systematic errors from echoes alone: those with which the fewest echoes contradict their neighbours in time.

No pose needs to be known beforehand. The heading's drift goes first, since it bends every window of readings, and is tried over
the whole range of worn robots; the scales follow by steps that halve.
"""

from collections.abc import Iterator

import numpy as np

from knowledge_sources.laser_graph.bend import dead_reckon
from knowledge_sources.laser_graph.carving import unbroken_fraction
from knowledge_sources.laser_graph.cones import Cones
from knowledge_sources.laser_graph.odometry_model import OdometryModel
from knowledge_sources.laser_graph.pose_graph import Indices
from knowledge_sources.laser_graph.poses import Floats

LARGEST_DRIFT_RAD_PER_M = 0.12  # a worn robot drifts by up to 0.1 rad a metre
DRIFT_STEP_RAD_PER_M = 0.01
APART_RAD_PER_M = 0.025  # starts: nearer ones come to the same summit
FIRST_STEPS = (0.008, 0.04, 0.04)  # of drift, distance scale, turn scale
HALVINGS = 4


def starting_models(cones: Cones, odometry: Floats, at: Indices) -> Iterator[OdometryModel]:
    """Yield the models to start from, the best first; each from a drift that is not near those before."""
    steps = round(LARGEST_DRIFT_RAD_PER_M / DRIFT_STEP_RAD_PER_M)
    drifts = DRIFT_STEP_RAD_PER_M * np.arange(-steps, steps + 1)
    worth = np.array([_worth(cones, odometry, at, np.array([drift, 1.0, 1.0])) for drift in drifts])
    while (worth > -np.inf).any():
        k = min(range(len(drifts)), key=lambda i: (-worth[i], abs(drifts[i])))
        yield _model(_climb(cones, odometry, at, np.array([drifts[k], 1.0, 1.0]), float(worth[k])))
        worth[np.abs(drifts - drifts[k]) < APART_RAD_PER_M] = -np.inf


def _climb(cones: Cones, odometry: Floats, at: Indices, terms: Floats, worth: float) -> Floats:
    """Return the terms (drift, distance scale, turn scale) of the nearest summit."""
    steps = np.array(FIRST_STEPS)
    for _ in range(HALVINGS):
        moved = True
        while moved:
            moved = False
            for step in np.concatenate([np.diag(steps), -np.diag(steps)]):
                tried = _worth(cones, odometry, at, terms + step)
                if tried > worth:
                    terms, worth, moved = terms + step, tried, True
        steps = steps / 2.0
    return terms


def _worth(cones: Cones, odometry: Floats, at: Indices, terms: Floats) -> float:
    return unbroken_fraction(cones, dead_reckon(odometry, _model(terms))[at])


def _model(terms: Floats) -> OdometryModel:
    drift, distance, turn = terms.tolist()
    return OdometryModel(distance_scale=distance, turn_scale=turn, drift_rad_per_m=drift)
