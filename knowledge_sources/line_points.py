"""Which points belong to a line, in which order, and where the line breaks.

Source: Bou-Ghannam 1992, section 5.2.3, steps 6 to 8.
"""

import numpy as np

from knowledge_sources.echoes import Array, Index


def group(distance_m: Array, largest_m: float) -> Index:
    """Return the points within `largest_m` of the line (step 6)."""
    return np.flatnonzero(np.abs(distance_m) <= largest_m)


def order(along_m: Array, members: Index) -> Index:
    """Return the members by their place along the line (step 7).

    The thesis orders by x, or by y where the line is steep; the place along the line needs no such choice.
    """
    return members[np.argsort(along_m[members], kind="stable")]


def split_at_breaks(along_m: Array, ordered: Index, largest_gap_m: float) -> list[Index]:
    """Return the pieces between gaps wider than `largest_gap_m`, usually the robot's diameter (step 8)."""
    if len(ordered) == 0:
        return []
    breaks = np.flatnonzero(np.diff(along_m[ordered]) > largest_gap_m) + 1
    return np.split(ordered, breaks)
