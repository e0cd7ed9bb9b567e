"""Lines put together that are pieces of one wall: the same wall seen again, or on both sides of a short gap.

What asks how walls lie to each other works on these, so that it does not matter whether the lines come from single batches (with
many for each wall) or from the model (with one).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from math import atan2, cos, hypot, inf, pi, radians, sin, sqrt
from typing import Any

import numpy as np
import numpy.typing as npt

from blackboard.entry import Entry
from blackboard.messages.geometry import wrap_angle
from blackboard.messages.model import ModelLine
from blackboard.messages.world import Line
from blackboard.parameters import require
from knowledge_sources.line_estimates import NoiseFloor, line_covariance

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class WallLimits:
    """How alike two lines must run to be pieces of one wall."""

    angle_rad: float = radians(6.0)  # short lines are tilted by a few degrees
    offset_m: float = (
        0.10  # of either end from the other's carrier: two cells; a thinner partition seen from both sides is one
    )
    gap_m: float = 0.6  # the thesis breaks a line where the robot could pass, and its robot is that wide

    def __post_init__(self) -> None:
        require(0.0 < self.angle_rad <= radians(45.0), "angle_rad", self.angle_rad, "(0, 45] degrees")
        require(0.0 < self.offset_m <= 10.0, "offset_m", self.offset_m, "(0, 10] metres")
        require(0.0 <= self.gap_m <= 100.0, "gap_m", self.gap_m, "[0, 100] metres")


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """A line from (x0, y0) to (x1, y1), with deviations of its offset at the middle and of its direction.

    `side`: -1 or 1, the side of its direction from which it was sensed, 1 being left; 0 where nobody says.
    """

    key: str
    x0_m: float
    y0_m: float
    x1_m: float
    y1_m: float
    sigma_rho_m: float
    sigma_theta_rad: float
    side: int = 0

    @property
    def length_m(self) -> float:
        return hypot(self.x1_m - self.x0_m, self.y1_m - self.y0_m)


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """A straight wall by its middle, direction and half length; `entries` are the lines that it is made of, longest first.

    The deviations are those of the offset at the middle and of the direction.
    """

    number: int
    x_m: float
    y_m: float
    theta_rad: float
    half_length_m: float
    sigma_rho_m: float
    sigma_theta_rad: float
    side: int
    entries: tuple[Entry[Any], ...] = field(default=())

    @property
    def ends(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The two ends, against the direction first."""
        c, s, h = cos(self.theta_rad), sin(self.theta_rad), self.half_length_m
        return (self.x_m - h * c, self.y_m - h * s), (self.x_m + h * c, self.y_m + h * s)


def as_piece(entry: Entry[Any]) -> Piece:
    """Return a line of either kind as a piece."""
    line: Line | ModelLine = entry.value
    ends = (line.start.x_m, line.start.y_m, line.end.x_m, line.end.y_m)
    if isinstance(line, ModelLine):
        sigmas, side = (line.sigma_rho_m, line.sigma_theta_rad), 1 if line.faces_left else -1
    else:
        half_m = hypot(ends[2] - ends[0], ends[3] - ends[1]) / 2
        variances = line_covariance(half_m, line.sigma_rho_m, line.support, NoiseFloor())  # of theta and of the offset
        sigmas, side = (sqrt(float(variances[1, 1])), sqrt(float(variances[0, 0]))), 0
    return Piece(
        key=entry.key,
        x0_m=ends[0],
        y0_m=ends[1],
        x1_m=ends[2],
        y1_m=ends[3],
        sigma_rho_m=sigmas[0],
        sigma_theta_rad=sigmas[1],
        side=side,
    )


def fuse(pieces: Sequence[Piece], number: int = 0) -> Wall:
    """Return the wall that runs best through all pieces (least squares over their whole lengths) and covers them.

    Errors that the pieces share do not lessen with their number: the deviations are those of the best piece, widened by how
    far the pieces scatter about the wall.
    """
    ends = np.array([(p.x0_m, p.y0_m, p.x1_m, p.y1_m) for p in pieces])
    middles, halves = (ends[:, :2] + ends[:, 2:]) / 2, (ends[:, 2:] - ends[:, :2]) / 2
    lengths = np.hypot(halves[:, 0], halves[:, 1])
    weights = np.maximum(lengths, 1e-6)
    middle = weights @ middles / weights.sum()
    away = middles - middle
    moments = (weights[:, None] * away).T @ away + (weights[:, None] * halves).T @ halves / 3
    theta = 0.5 * atan2(2 * float(moments[0, 1]), float(moments[0, 0] - moments[1, 1]))
    longest = max(range(len(pieces)), key=lambda i: (float(lengths[i]), -i))
    if halves[longest] @ (cos(theta), sin(theta)) < 0:  # runs as its longest piece, so that sides stay what they are
        theta = wrap_angle(theta + pi)
    direction, normal = np.array([cos(theta), sin(theta)]), np.array([-sin(theta), cos(theta)])
    along = np.concatenate([(ends[:, :2] - middle) @ direction, (ends[:, 2:] - middle) @ direction])
    low, high = float(along.min()), float(along.max())
    scatter = float(weights @ (away @ normal) ** 2 / weights.sum()) / len(pieces)
    centre = middle + (low + high) / 2 * direction
    return Wall(
        number=number,
        x_m=float(centre[0]),
        y_m=float(centre[1]),
        theta_rad=theta,
        half_length_m=(high - low) / 2,
        sigma_rho_m=sqrt(min(p.sigma_rho_m for p in pieces) ** 2 + scatter),
        sigma_theta_rad=min(p.sigma_theta_rad for p in pieces),
        side=pieces[longest].side,
    )


class Walls:
    """The walls that the standing lines make up, kept from one look to the next: a wall keeps its number while it grows."""

    def __init__(self, limits: WallLimits) -> None:
        self._limits = limits
        self._known: dict[str, Entry[Any]] = {}
        self._wall_of: dict[str, int] = {}
        self._pieces: dict[int, dict[str, Piece]] = {}
        self._walls: dict[int, Wall] = {}
        self._shown: dict[int, Wall] = {}  # with their lines; only those that changed are put together again
        self._next = 1

    def update(self, lines: Iterable[Entry[Any]]) -> list[Wall]:
        """Take over which lines stand now; return the walls, by number."""
        standing = {entry.key: entry for entry in lines}
        changed: dict[int, None] = {}
        for key in [k for k, e in self._known.items() if k not in standing or standing[k].revision != e.revision]:
            number = self._wall_of.pop(key)
            del self._known[key], self._pieces[number][key]
            changed[number] = None
        for number in list(changed):
            changed |= dict.fromkeys(self._put_together_again(number))
        for key, entry in standing.items():
            if key not in self._known:
                self._known[key] = entry
                changed[self._admit(as_piece(entry))] = None
        self._join([number for number in changed if number in self._walls])
        return [self._with_entries(number) for number in sorted(self._walls)]

    def _admit(self, piece: Piece) -> int:
        number = self._home(fuse([piece]), list(self._walls.values()))
        if number is None:
            number, self._next = self._next, self._next + 1
        self._put(piece, number)
        return number

    def _put(self, piece: Piece, number: int) -> None:
        self._pieces.setdefault(number, {})[piece.key] = piece
        self._wall_of[piece.key] = number
        self._refit(number)

    def _put_together_again(self, number: int) -> list[int]:
        """Put a wall that has lost a line together anew: the others may be pieces of one wall no more. Return the walls' numbers.

        The longest piece keeps the wall's number.
        """
        left = sorted(self._pieces.pop(number).values(), key=lambda p: (-p.length_m, p.key))
        del self._walls[number]
        self._shown.pop(number, None)
        if not left:
            return []
        self._put(left[0], number)
        numbers = [number]
        for piece in left[1:]:
            homes = [self._walls[n] for n in numbers]
            home = self._home(fuse([piece]), homes)
            if home is None:
                home, self._next = self._next, self._next + 1
                numbers.append(home)
            self._put(piece, home)
        return numbers

    def _refit(self, number: int) -> None:
        self._shown.pop(number, None)
        self._walls[number] = fuse(list(self._pieces[number].values()), number)

    def _join(self, changed: list[int]) -> None:
        """Join walls that have grown together; the lower number stays."""
        waiting = sorted(changed)
        while waiting:
            number = waiting.pop(0)
            if number not in self._walls:
                continue
            other = self._home(self._walls[number], [w for n, w in self._walls.items() if n != number])
            if other is None:
                continue
            stays, goes = min(number, other), max(number, other)
            for key, piece in self._pieces[goes].items():
                self._pieces[stays][key] = piece
                self._wall_of[key] = stays
            del self._pieces[goes], self._walls[goes]
            self._shown.pop(goes, None)
            self._refit(stays)
            waiting.append(stays)

    def _home(self, wall: Wall, walls: Sequence[Wall]) -> int | None:
        """Return the number of the wall that this one is a piece of, the nearest where several are."""
        best, best_m = None, inf
        for other in walls:
            offset_m = piece_offset_m(wall, other, self._limits)
            if offset_m is not None and offset_m < best_m:
                best, best_m = other.number, offset_m
        return best

    def _with_entries(self, number: int) -> Wall:
        if number not in self._shown:
            pieces = sorted(self._pieces[number].values(), key=lambda p: (-p.length_m, p.key))
            self._shown[number] = replace(self._walls[number], entries=tuple(self._known[p.key] for p in pieces))
        return self._shown[number]


def piece_offset_m(a: Wall, b: Wall, limits: WallLimits) -> float | None:
    """Return how far the shorter of two walls lies from the carrier of the longer at most; None where they are not one wall."""
    turn = abs(wrap_angle(2 * (a.theta_rad - b.theta_rad))) / 2  # undirected
    if turn > limits.angle_rad:
        return None
    if a.side and b.side and (a.side == b.side) != (cos(a.theta_rad - b.theta_rad) > 0):
        return None
    long, short = (a, b) if a.half_length_m >= b.half_length_m else (b, a)
    c, s = cos(long.theta_rad), sin(long.theta_rad)
    dx, dy = short.x_m - long.x_m, short.y_m - long.y_m
    half_along = short.half_length_m * abs(cos(short.theta_rad - long.theta_rad))
    if abs(dx * c + dy * s) - half_along - long.half_length_m > limits.gap_m:
        return None
    offset_m = abs(dy * c - dx * s) + short.half_length_m * abs(sin(short.theta_rad - long.theta_rad))
    return offset_m if offset_m <= limits.offset_m else None
