"""Where round a body its part was looked for, and where it was seen: in sectors, by what beams say of places in each."""

from dataclasses import dataclass, field
from math import cos, pi, sin

import numpy as np
import numpy.typing as npt

from knowledge_sources.looks import SEEN, THROUGH, Beams, look

Floats = npt.NDArray[np.float64]
Counts = npt.NDArray[np.int64]

SECTORS = 36  # 10 degrees: less than a handle is wide, seen from its body's middle
WITHIN = (0.5, 0.7, 0.9)  # of the part's length, where it is looked for: clear of the body's own surface
BEYOND_M = 0.12  # past its end nothing may be: what reaches further is not the part
TOLERANCE_M = 0.05  # between a place within the part and the part's own surface
LEAST_SCANS = 3  # that saw through a sector: then there is no part in it
SURE_SCANS = 6  # that saw something of the part's length in it


@dataclass
class PartView:
    """For each sector, counted counter-clockwise from the map's x axis, how many scans saw something, or through it."""

    seen: Counts = field(default_factory=lambda: np.zeros(SECTORS, dtype=np.int64))
    through: Counts = field(default_factory=lambda: np.zeros(SECTORS, dtype=np.int64))

    def add(self, beams: Beams, x_m: float, y_m: float, body_m: float, part_m: float, reach_m: float) -> None:
        """Take note of what a scan shows round a body."""
        inside = [body_m + share * part_m for share in WITHIN]
        places = _ring(x_m, y_m, (*inside, body_m + part_m + BEYOND_M))
        found = look(beams, places.reshape(-1, 2), TOLERANCE_M, reach_m).reshape(SECTORS, len(WITHIN) + 1)
        here, beyond = found[:, :-1], found[:, -1]
        self.seen += (here == SEEN).any(axis=1) & ~(here == THROUGH).any(axis=1) & (beyond != SEEN)
        self.through += ((here == THROUGH).sum(axis=1) >= 2) & ~(here == SEEN).any(axis=1)

    @property
    def absent(self) -> npt.NDArray[np.bool_]:
        """Which sectors hold no part."""
        return (self.through >= LEAST_SCANS) & (self.seen * 2 < self.through)

    def part_rad(self) -> float | None:
        """Return the direction in which the part was seen; None where it was not."""
        sure = np.flatnonzero((self.seen >= SURE_SCANS) & (self.seen > 2 * self.through))
        if not len(sure):
            return None
        angles = _angles()[sure]
        weights = self.seen[sure].astype(np.float64)
        return float(np.arctan2((weights * np.sin(angles)).sum(), (weights * np.cos(angles)).sum()))

    def unseen_rad(self) -> float | None:
        """Return the middle of the widest stretch of sectors that were not looked at; None where there is none."""
        open_ = ~self.absent
        if open_.all() or not open_.any():
            return None
        start = int(np.flatnonzero(~open_)[0])
        turned = np.roll(open_, -start)
        best, run = (0, 0), 0
        for i, free in enumerate([*turned.tolist(), False]):
            if free:
                run += 1
                continue
            if run > best[0]:
                best = (run, i - run)
            run = 0
        middle = start + best[1] + (best[0] - 1) / 2
        angle = 2.0 * pi * (middle + 0.5) / SECTORS
        return float(np.arctan2(sin(angle), cos(angle)))


def _angles() -> Floats:
    angles: Floats = 2.0 * pi * (np.arange(SECTORS) + 0.5) / SECTORS
    return angles


def _ring(x_m: float, y_m: float, radii_m: tuple[float, ...]) -> Floats:
    """Return places (sectors, radii, 2)."""
    angles, radii = _angles()[:, None], np.array(radii_m)
    return np.stack([x_m + radii * np.cos(angles), y_m + radii * np.sin(angles)], axis=2)
