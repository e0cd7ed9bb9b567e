"""Lines of a batch as estimates: what is matched with the lines that are known.

Reads  observations/feature/line, observations/feature/supported_points
"""

from collections.abc import Sequence

import numpy as np

from blackboard.access import Access
from blackboard.entry import Entry
from blackboard.messages.world import Line, PointSet
from blackboard.uncertainty.matrices import Array
from knowledge_sources.line_estimates import NoiseFloor, from_line
from knowledge_sources.line_model import Observed

NEAR_LINE_M = 0.3  # points this near to a line say from which side it was sensed


def observed_line(entry: Entry[Line], board: Access, floor: NoiseFloor) -> Observed:
    """Return a line as an estimate, and where its points were sensed from."""
    points = [e.value for support in entry.supports for e in board.revisions(support)]
    sensed_from = _sensed_from([p for p in points if isinstance(p, PointSet)], entry.value)
    line = from_line(entry.value, sensed_from, floor)
    mean = sensed_from.mean(axis=0).tolist() if len(sensed_from) else [line.x_m, line.y_m]
    return Observed(id=str(entry.id), line=line, from_x_m=mean[0], from_y_m=mean[1])


def _sensed_from(points: Sequence[PointSet], line: Line) -> Array:
    """Return (n, 2) where those points were sensed from that lie near a line; where none does, where all were."""
    if not points:
        return np.zeros((0, 2))
    places = np.concatenate([p.points.unpack() for p in points]).astype(np.float64)
    origins = np.concatenate([p.sensed_from.unpack() for p in points]).astype(np.float64)
    start = np.array([line.start.x_m, line.start.y_m])
    way = np.array([line.end.x_m, line.end.y_m]) - start
    length = max(float(np.hypot(*way)), 1e-9)
    c, s = way / length
    along = (places - start) @ np.array([c, s])
    out = (places - start) @ np.array([s, -c])
    near = (np.abs(out) <= NEAR_LINE_M) & (along >= 0.0) & (along <= length)
    return origins[near] if near.any() else origins
