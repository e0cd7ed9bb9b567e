"""Max-min clustering: centres as far from each other as the samples allow.

Source: Bou-Ghannam 1992, section 5.2.3, step 4, after Tou and Gonzalez 1974, section 3.3.2.
"""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def max_min_centres(
    n: int, distances_from: Callable[[int], Array], fraction: float, resolution: float = np.inf
) -> tuple[list[int], npt.NDArray[np.intp]]:
    """Return the centres (sample numbers; sample 0 is the first) and, for each of n samples, which centre is nearest.

    `distances_from(k)` gives the distances (n,) of all samples from sample k. The next centre is the sample whose
    smallest distance to the centres is largest, as long as that exceeds `fraction` of the mean of the earlier such
    distances, or exceeds `resolution`: samples further apart than that are never one cluster.
    """
    if n == 0:
        return [], np.zeros(0, dtype=np.intp)
    centres = [0]
    smallest = distances_from(0)
    nearest = np.zeros(n, dtype=np.intp)
    total = 0.0
    while len(centres) < n:
        farthest = int(np.argmax(smallest))
        distance = float(smallest[farthest])
        earlier = len(centres) - 1
        if distance <= 0.0 or (earlier and distance <= min(fraction * total / earlier, resolution)):
            break
        total += distance
        distances = distances_from(farthest)
        nearest[distances < smallest] = len(centres)
        smallest = np.minimum(smallest, distances)
        centres.append(farthest)
    return centres, nearest
