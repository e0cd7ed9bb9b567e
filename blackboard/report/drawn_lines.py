"""How the lines found compare with lines that others drew through the same points."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from blackboard.messages.world import Line
from blackboard.report.result import segments
from blackboard.report.scores import covered
from blackboard.report.walls import Segments, sample

NEAR_M = 0.10  # a line lies on another within this distance ...
NEAR_RAD = np.deg2rad(3.0)  # ... and this angle
STEP_M = 0.05  # they are compared piece by piece, each no longer than this


def drawn_lines_table(
    lines: Sequence[Line], drawn: Segments | None, points: npt.NDArray[np.float64] | None
) -> dict[str, float | int]:
    """Return rows for the table at the end; none where nobody drew lines.

    `points` are those that the lines were sought among: of what was drawn where there is none nothing could be found.
    """
    if drawn is None or not len(drawn):
        return {}
    theirs, ours = sample(drawn, STEP_M), sample(segments(lines), STEP_M)
    found = covered(theirs.points, theirs.directions, segments(lines), NEAR_M, NEAR_RAD)
    drawn_too = covered(ours.points, ours.directions, drawn, NEAR_M, NEAR_RAD)
    drawn_m, ours_m = float(theirs.weights_m.sum()), float(ours.weights_m.sum())
    table: dict[str, float | int] = {"drawn_lines": len(drawn), "drawn_length_m": drawn_m}
    if drawn_m > 0:
        table["drawn_found_fraction"] = float(theirs.weights_m[found].sum()) / drawn_m
    if drawn_m > 0 and points is not None and len(points):
        near = cKDTree(points).query(theirs.points)[0] <= NEAR_M
        table["drawn_near_points_fraction"] = float(theirs.weights_m[near].sum()) / drawn_m
    table["lines_length_m"] = ours_m
    if ours_m > 0:
        table["lines_not_drawn_fraction"] = float(ours.weights_m[~drawn_too].sum()) / ours_m
    return table
