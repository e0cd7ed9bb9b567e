"""The recent past: echoes that no line explained when they were heard, with the poses where they were heard.

A line is only believed once it has been seen from two places. By then many of its echoes have been heard: the poses that they were
heard at are still in the state, so that they say now what they would have said then.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from blackboard.uncertainty.matrices import Array
from knowledge_sources.joint_estimate.association import Paired, consistent
from knowledge_sources.joint_estimate.echo_model import Cones, LineTable, derivatives, predict, variances
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import JointState

LOOSE_RAD = 0.2  # of a line before its echoes have spoken: what the fit to a batch says of it came from the same echoes
LOOSE_M = 0.2
LEAST = 3  # echoes that say more of a line than its fit does


@dataclass(eq=False)
class Look:
    """Echoes heard at one pose, and which of them are still unexplained."""

    cones: Cones
    ranges_m: Array
    motion: tuple[float, float, float]
    open: npt.NDArray[np.bool_]


class Window:
    """The looks that belong to the remembered poses."""

    def __init__(self) -> None:
        self._looks: dict[int, Look] = {}  # by where their pose stands in the mean

    def add(self, state: JointState, look: Look) -> int:
        """Keep a look at the pose where the robot is; return where that stands in the mean."""
        at = state.remember()
        self._looks[at] = look
        return at

    def look_back(self, state: JointState, params: JointLinesParams) -> int:
        """Take in what the past says of the newest line; return how many echoes did."""
        number, count = len(state.lines) - 1, 0
        table = LineTable.of(state).only(number)
        if table.length_m[0] < params.least_m:
            return 0
        parts: list[tuple[int, Paired]] = []
        for at, look in self._looks.items():
            predicted = predict(state, table, look.cones, params, at)
            gap = look.ranges_m - predicted.ranges_m[:, 0]
            near = np.flatnonzero(look.open & np.isfinite(gap) & (np.abs(gap) <= 1.0))
            if not len(near):
                continue
            line = np.zeros_like(near)
            h = derivatives(state, table, predicted, near, line, look.motion, at, number)
            noise = variances(predicted, look.cones, near, line, params)
            own = np.einsum("ij,ij->i", h @ state.covariance, h) + noise
            fits = gap[near] ** 2 <= params.gate_sigmas**2 * own
            if fits.any():
                near = near[fits]
                pair = Paired(
                    cone=near, line=np.full_like(near, number), difference_m=gap[near], h=h[fits], noise=noise[fits]
                )
                parts.append((at, pair))
                count += len(near)
        if count < LEAST:
            return 0
        together = Paired(
            cone=np.concatenate([p.cone for _, p in parts]),
            line=np.concatenate([p.line for _, p in parts]),
            difference_m=np.concatenate([p.difference_m for _, p in parts]),
            h=np.vstack([p.h for _, p in parts]),
            noise=np.concatenate([p.noise for _, p in parts]),
        )
        kept, distance, bound = consistent(state, together, params.confidence)
        if distance > bound or len(kept.cone) < LEAST:
            return 0
        for at, pair in parts:
            self._looks[at].open[pair.cone] = False
        state.loosen(number, LOOSE_RAD, LOOSE_M)
        state.update(kept.difference_m, kept.h, np.diag(kept.noise))
        return count
