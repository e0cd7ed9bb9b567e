"""Lines of the state that turn out to be one wall are made one: the difference between them is taken to be none."""

from dataclasses import replace

import numpy as np

from blackboard.uncertainty.chi_square import chi_square_quantile
from knowledge_sources.joint_estimate.line_association import LinePair, same_lines
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import JointState, LineExtent

SURE_M = 0.1  # two lines of which less is known may only look the same
CONFIDENCE = 0.95  # stricter than for another look at a line: what is made one is not parted again


def longer(extent: LineExtent, pair: LinePair) -> LineExtent:
    """Return what is known of a line after another look: it covers both."""
    return replace(
        extent,
        from_m=min(extent.from_m, pair.from_m),
        to_m=max(extent.to_m, pair.to_m),
        observations=extent.observations + 1,
    )


def unite(state: JointState, touched: list[str], params: JointLinesParams) -> list[str]:
    """Make one of each of the lines `touched` and those that it coincides with; return the ids that are gone.

    The line seen more often keeps its id, of two seen equally often the older. Ids of lines that changed are added to `touched`.
    """
    floor = np.diag([params.theta_floor_rad**2, params.rho_floor_m**2]) / 4.0
    gone: list[str] = []
    for id_ in list(touched):
        if id_ in gone:
            continue
        found = _twin(state, state.number(id_), floor)
        if found is None:
            continue
        keep, other, pair = found
        state.update(pair.difference, -pair.h, floor)
        both = state.lines[keep].observations + state.lines[other].observations
        state.lines[keep] = replace(longer(state.lines[keep], pair), observations=both)
        touched.append(state.lines[keep].id)
        gone.append(state.lines[other].id)
        state.drop(other)
    return gone


def _twin(state: JointState, a: int, floor: np.ndarray) -> tuple[int, int, LinePair] | None:
    bound = chi_square_quantile(CONFIDENCE, 2)
    for b in range(len(state.lines)):
        if a == b:
            continue
        keep, other = sorted((a, b), key=lambda i: (-state.lines[i].observations, i))
        pair = same_lines(state, keep, other, floor)
        extent = state.lines[keep]
        if pair is None or pair.distance > bound or max(pair.from_m - extent.to_m, extent.from_m - pair.to_m) > 0.0:
            continue
        spread = pair.h @ state.covariance @ pair.h.T
        if spread[1, 1] <= SURE_M**2:
            return keep, other, pair
    return None
