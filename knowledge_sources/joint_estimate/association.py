"""Which echo came from which line: by normal distance under the joint covariance, and only where that is clear."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from blackboard.uncertainty.chi_square import chi_square_quantile
from blackboard.uncertainty.matrices import Array
from knowledge_sources.joint_estimate.echo_model import Cones, LineTable, derivatives, predict, variances
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import JointState

CLEAR = 4.0  # so much further, in squared deviations, the second best line must be: two deviations
ALIKE_M = 0.05  # two lines that predict the same echo are no riddle


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Paired:
    """Echoes with the lines they came from: numbers (k,), differences (k,) measured less predicted, H (k, n), variances (k,)."""

    cone: npt.NDArray[np.intp]
    line: npt.NDArray[np.intp]
    difference_m: Array
    h: Array
    noise: Array

    def only(self, kept: npt.NDArray[np.intp]) -> "Paired":
        """Return some of the pairs."""
        return Paired(**{name: getattr(self, name)[kept] for name in self.__dataclass_fields__})

    def spread(self, state: JointState) -> Array:
        """Return the covariance (k, k) of the differences."""
        spread: Array = self.h @ state.covariance @ self.h.T + np.diag(self.noise)
        return spread


def associate(
    state: JointState, cones: Cones, ranges_m: Array, motion: tuple[float, float, float], params: JointLinesParams
) -> Paired:
    """Return the echoes that one line explains, and a long one; `ranges_m` (m,), inf where nothing was heard."""
    table = LineTable.of(state)
    predicted = predict(state, table, cones, params)
    gaps = ranges_m[:, None] - predicted.ranges_m
    with np.errstate(invalid="ignore"):
        near = np.isfinite(gaps) & (np.abs(gaps) <= params.gate_sigmas * params.unsure_m + 0.3)
    cone, line = np.nonzero(near)
    h = derivatives(state, table, predicted, cone, line, motion)
    noise = variances(predicted, cones, cone, line, params)
    from_state = np.einsum("ij,ij->i", h @ state.covariance, h)
    gap = gaps[cone, line]
    distance = gap**2 / (from_state + noise)
    fits = (distance <= params.gate_sigmas**2) & (from_state <= params.unsure_m**2)
    fits &= table.length_m[line] >= params.least_m  # a short one only speaks against the others
    kept = [i for i in _clear(cone, distance, predicted.ranges_m[cone, line], params) if fits[i]]
    return Paired(cone=cone[kept], line=line[kept], difference_m=gap[kept], h=h[kept], noise=noise[kept])


def _clear(cone: npt.NDArray[np.intp], distance: Array, ranges_m: Array, params: JointLinesParams) -> list[int]:
    """Return for each cone the pair of least distance, unless another line does nearly as well and is elsewhere."""
    kept = []
    for number in np.unique(cone).tolist():
        rivals = np.flatnonzero(cone == number)
        best = rivals[np.argmin(distance[rivals])]
        close = (distance[rivals] <= distance[best] + CLEAR) & (np.abs(ranges_m[rivals] - ranges_m[best]) > ALIKE_M)
        if not close.any():
            kept.append(int(best))
    return kept


def consistent(state: JointState, paired: Paired, confidence: float) -> tuple[Paired, float, float]:
    """Return the pairs without those that the others speak against, the squared normal distance of all together, and its bound.

    The worst is left out until the rest fits or half of them are gone.
    """
    least = (len(paired.cone) + 1) // 2
    while True:
        count = len(paired.cone)
        if count == 0:
            return paired, 0.0, 0.0
        s = paired.spread(state)
        weighted = np.linalg.solve(s, paired.difference_m)
        distance, bound = float(paired.difference_m @ weighted), chi_square_quantile(confidence, count)
        if distance <= bound or count <= least:
            return paired, distance, bound
        # what each would leave of the distance if it were left out
        worst = int(np.argmax(weighted**2 / np.diag(np.linalg.inv(s))))
        paired = paired.only(np.delete(np.arange(count), worst))
