"""How good the corners are: against those of the true floor."""

from collections.abc import Sequence
from math import atan2, hypot, pi
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import shapely

from blackboard.component import WorldTruth
from blackboard.messages.geometry import wrap_angle
from blackboard.messages.symbols import Corner

NEAR_M = 0.15  # a corner so near to a true one is that: three cells
LEAST_TURN_RAD = pi / 6  # less is a bend
SIDE_M = 0.4  # corners with a shorter side are not asked for: hardly a line stands for it
KNOWN_SIDE_M = 0.1  # but a corner found there is right
BESIDE_M = 0.2


class TrueCorner(NamedTuple):
    """A corner of the free floor: its place, its shape as a robot senses it, and a place on either side, BESIDE_M away."""

    x_m: float
    y_m: float
    shape: str
    beside: tuple[tuple[float, float], tuple[float, float]]

    def is_met(self, corner: Corner) -> bool:
        """Say whether a corner found is this one."""
        near = hypot(corner.place.x_m - self.x_m, corner.place.y_m - self.y_m) <= NEAR_M
        return near and corner.shape in (self.shape, "unknown")


def true_corners(truth: WorldTruth, side_m: float) -> list[TrueCorner]:
    """Return the corners of the free floor both of whose sides are this long."""
    free: Any = truth.floor.difference(truth.solid)
    found = []
    for part in getattr(free, "geoms", [free]):
        whole = shapely.geometry.polygon.orient(part.simplify(0.01))  # the free floor lies left of every ring
        for ring in (whole.exterior, *whole.interiors):
            points = np.array(ring.coords)[:-1]
            for before, here, after in zip(np.roll(points, 1, 0), points, np.roll(points, -1, 0), strict=True):
                corner = _corner(before, here, after, side_m)
                if corner is not None:
                    found.append(corner)
    return found


def corner_scores(corners: Sequence[Corner], truth: WorldTruth | None) -> dict[str, float]:
    """Return which fraction of the corners is right, and which of the true ones was found; nothing without corners or truth."""
    if truth is None or not corners:
        return {}
    known, asked = true_corners(truth, KNOWN_SIDE_M), true_corners(truth, SIDE_M)
    right = sum(any(true.is_met(corner) for true in known) for corner in corners)
    found = sum(any(true.is_met(corner) for corner in corners) for true in asked)
    scores = {"corners_right_fraction": right / len(corners)}
    return scores | ({"corners_found_fraction": found / len(asked)} if asked else {})


def _corner(
    before: npt.NDArray[np.float64], here: npt.NDArray[np.float64], after: npt.NDArray[np.float64], side_m: float
) -> TrueCorner | None:
    come, go = here - before, after - here
    lengths = np.hypot(come[0], come[1]), np.hypot(go[0], go[1])
    turn = wrap_angle(atan2(go[1], go[0]) - atan2(come[1], come[0]))
    if min(lengths) < max(side_m, 1e-9) or abs(turn) < LEAST_TURN_RAD:
        return None
    back, on = here - come / lengths[0] * BESIDE_M, here + go / lengths[1] * BESIDE_M
    beside = ((float(back[0]), float(back[1])), (float(on[0]), float(on[1])))
    return TrueCorner(float(here[0]), float(here[1]), "concave" if turn > 0 else "convex", beside)
