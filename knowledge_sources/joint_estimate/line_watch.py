"""Whether a line keeps its word: echoes of a line that is where it is said to be err to both sides of it.

Each echo may be within its gate, and all of them to one side: of furniture before a wall, a wall taken for its neighbour, a pose
that is dragged along. The cumulative sum tells a shift from chance (Page 1954): of the differences of one line, in standard
deviations, less a slack, for either side; where it passes its limit the line is in doubt.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from blackboard.uncertainty.matrices import Array
from knowledge_sources.joint_estimate.association import Paired
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import JointState


@dataclass(frozen=True, slots=True, kw_only=True)
class Excess:
    """Of one side: the sum, how many scans it was gathered in, and their differences in all."""

    sum: float = 0.0
    scans: int = 0
    difference_m: float = 0.0

    def after(self, sigmas: float, difference_m: float, slack: float) -> "Excess":
        """Return the excess after another scan."""
        total = self.sum + sigmas - slack
        if total <= 0.0:
            return Excess()
        return Excess(sum=total, scans=self.scans + 1, difference_m=self.difference_m + difference_m)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Doubt:
    """A line whose echoes have been to one side for too long: by how much, and how that answers to the state."""

    line: int
    difference_m: float
    h: Array  # (n,)


class LineWatch:
    """Keeps the cumulative sums of all lines."""

    _NONE: ClassVar[tuple[Excess, Excess]] = (Excess(), Excess())

    def __init__(self, params: JointLinesParams) -> None:
        self._params = params
        self._excess: Mapping[str, tuple[Excess, Excess]] = {}

    def doubts(self, state: JointState, paired: Paired) -> list[Doubt]:
        """Take in a scan before it moves the state; return the lines that are in doubt with it, which begin anew."""
        excess = {extent.id: self._excess.get(extent.id, self._NONE) for extent in state.lines}
        found = []
        for line in sorted(set(paired.line.tolist())):
            own = paired.only(np.flatnonzero(paired.line == line))
            weights = np.linalg.solve(own.spread(state), np.ones(len(own.cone)))
            sharpness = float(weights.sum())
            difference_m = float(weights @ own.difference_m) / sharpness
            sigmas = difference_m * np.sqrt(sharpness)
            id_, slack = state.lines[line].id, self._params.drag_slack_sigmas
            further, nearer = excess[id_]
            further, nearer = further.after(sigmas, difference_m, slack), nearer.after(-sigmas, difference_m, slack)
            for side in (further, nearer):
                if side.sum > self._params.drag_limit_sigmas:
                    h = weights @ own.h / sharpness
                    found.append(Doubt(line=line, difference_m=side.difference_m / side.scans, h=h))
                    further, nearer = self._NONE
            excess[id_] = further, nearer
        self._excess = excess
        return found
