"""Repairs stamps that run back, keeping the order in which a recording was written.

Logs are written in the order in which things happened, but their clocks are not always to be trusted: seconds that come
twice, bursts written late, lines that bear a stamp of half an hour ago. Sorting by such stamps tears the drive apart. So the
longest sequence of stamps that never runs back is believed, and the others are placed between their believed neighbours.
"""

from bisect import bisect_right

import numpy as np
import numpy.typing as npt

from blackboard.messages.base import LONG_S

PAUSE_S = 60.0  # a few stamps further than this from all others are an error of the clock, not a pause of the drive
PAUSE_STEPS = 1000.0  # or this many usual steps, for recordings that are slow throughout
FEW_STAMPS = 5

Stamps = npt.NDArray[np.float64]


def longest_rising(stamps: Stamps) -> npt.NDArray[np.intp]:
    """Return the indices of the longest subsequence that never runs back (patience sorting, Fredman 1975), ascending."""
    if stamps.size == 0 or bool(np.all(stamps[1:] >= stamps[:-1])):
        return np.arange(stamps.size)
    tails: list[float] = []  # the smallest stamp that ends a rising subsequence of length k + 1
    ends: list[int] = []
    before = np.full(stamps.size, -1, dtype=np.intp)
    for i, stamp_s in enumerate(stamps.tolist()):
        length = bisect_right(tails, stamp_s)
        before[i] = ends[length - 1] if length else -1
        if length == len(tails):
            tails.append(stamp_s)
            ends.append(i)
        else:
            tails[length] = stamp_s
            ends[length] = i
    chain = [ends[-1]]
    while before[chain[-1]] >= 0:
        chain.append(int(before[chain[-1]]))
    return np.array(chain[::-1], dtype=np.intp)


def trusted(stamps: Stamps) -> npt.NDArray[np.bool_]:
    """Say which stamps are believed: finite, on the longest rising sequence, and not a few far from all the others."""
    believed = np.zeros(stamps.size, dtype=np.bool_)
    possible = np.flatnonzero(np.isfinite(stamps) & (np.abs(stamps) <= LONG_S))
    if possible.size == 0:
        return believed
    rising = possible[longest_rising(stamps[possible])]
    steps = np.diff(stamps[rising])
    usual_s = float(np.median(steps)) if steps.size else 0.0
    runs = np.split(rising, np.flatnonzero(steps > max(PAUSE_S, PAUSE_STEPS * usual_s)) + 1)
    long_runs = [run for run in runs if run.size >= FEW_STAMPS] or runs
    believed[np.concatenate(long_runs)] = True
    return believed


def repair(stamps: Stamps) -> tuple[Stamps, int]:
    """Return stamps that never run back, and how many had to be changed.

    A believed stamp stays as it is; any other is interpolated by its place in the file between the believed ones around it.
    Raises ValueError where no stamp can be believed.
    """
    believed = trusted(stamps)
    if not believed.any():
        if stamps.size:
            raise ValueError("none of its stamps is a finite time")
        return stamps.copy(), 0
    if believed.all():
        return stamps.copy(), 0
    places = np.arange(stamps.size)
    placed = np.where(believed, stamps, np.interp(places, places[believed], stamps[believed]))
    return np.maximum.accumulate(placed), int(np.count_nonzero(~believed))
