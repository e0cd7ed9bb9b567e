"""What the echoes of a scan may do to the state, and what they may not.

They move it where they fit the lines together, where each line's have been to both sides of it, and to where the wheels can have
gone. Where not, they leave the mean as it is, and what the last two contradict becomes less sure: something is taken for what it
is not, and nobody can say for how long.
"""

from dataclasses import dataclass

import numpy as np

from blackboard.uncertainty.chi_square import chi_square_quantile
from knowledge_sources.joint_estimate.association import Paired, consistent
from knowledge_sources.joint_estimate.line_watch import LineWatch
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import JointState
from knowledge_sources.joint_estimate.wheel_check import WheelCheck


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Verdict:
    """The pairs that counted, their squared normal distance and its bound; why they were refused, empty where they were not."""

    paired: Paired
    distance: float
    bound: float
    refused: str = ""


class Corrector:
    """Takes echoes in, with an eye on each line and on the wheels."""

    def __init__(self, params: JointLinesParams) -> None:
        self._params = params
        self._watch = LineWatch(params)
        self.wheels = WheelCheck(params)

    def correct(self, state: JointState, paired: Paired) -> Verdict:
        """Move the state by the pairs, or make it less sure."""
        params = self._params
        paired, distance, bound = consistent(state, paired, params.confidence)
        count = len(paired.cone)
        if distance > bound:
            why = f"{count} echoes do not fit the lines together: normal distance {distance:.1f}, bound {bound:.1f}"
            return Verdict(paired=paired, distance=distance, bound=bound, refused=why)
        doubts = self._watch.doubts(state, paired)
        for doubt in doubts:
            state.widen(doubt.h, doubt.difference_m)
        if doubts:
            which = ", ".join(f"{state.lines[d.line].id} by {d.difference_m:+.2f} m" for d in doubts)
            why = f"echoes have been to one side of lines for too long: of {which}"
            return Verdict(paired=paired, distance=distance, bound=bound, refused=why)
        mean, covariance = state.mean.copy(), state.covariance
        state.update(paired.difference_m, paired.h, np.diag(paired.noise))
        off_by, off = self.wheels.worst(state)
        allowed = chi_square_quantile(params.confidence, len(off))
        if off_by > allowed:
            state.mean, state.covariance = mean, covariance
            state.widen_pose(off)
            self.wheels.begin_anew()
            why = f"the wheels cannot have gone that way: normal distance {off_by:.1f}, bound {allowed:.1f}"
            return Verdict(paired=paired, distance=off_by, bound=allowed, refused=why)
        return Verdict(paired=paired, distance=distance, bound=bound)
