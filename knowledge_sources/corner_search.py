"""Corners: where two walls meet or nearly meet, how surely, and whether they are corners of a room or of a thing in it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import cos, hypot, pi, radians, sin, sqrt
from typing import Literal

import numpy as np

from blackboard.grid import EMPTY_MAX, Grid
from blackboard.messages.geometry import wrap_angle
from blackboard.parameters import require
from knowledge_sources.walls import Wall

Shape = Literal["concave", "convex", "unknown"]
LOOK_M = (0.10, 0.35)  # how far from the corner the grid is looked at: past its blurred edge, short of the next thing
LOOKS = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class CornerLimits:
    """What counts as a corner."""

    opening_rad: float = radians(30.0)  # walls at less than this to each other meet at no certain place
    gap_m: float = 0.3  # that two walls end short of their meeting: half a robot, so it cannot pass between them
    overrun_m: float = 0.2  # that a wall runs on beyond it: echoes stray about a line's end by some cells
    arm_m: float = 0.2  # a wall that leaves the corner for less proves no corner
    apart_m: float = 0.25  # corners nearer to each other that open the same way are one

    def __post_init__(self) -> None:
        require(0.0 < self.opening_rad < pi / 2, "opening_rad", self.opening_rad, "(0, 90) degrees")
        for name in ("gap_m", "overrun_m", "arm_m", "apart_m"):
            require(0.0 <= getattr(self, name) <= 10.0, name, getattr(self, name), "[0, 10] metres")


@dataclass(frozen=True, slots=True, kw_only=True)
class Meeting:
    """Two walls that meet at (x, y): covariance there (xx, xy, yy), the directions of the arms, and how far they end short.

    `through`: one of the walls runs on behind the other, so that there may be a second corner on its other side.
    """

    first: Wall
    second: Wall
    x_m: float
    y_m: float
    covariance: tuple[float, float, float]
    arms_rad: tuple[float, float]
    gap_m: float
    through: bool = False
    shape: Shape = "unknown"

    @property
    def name(self) -> str:
        """The corner's id: its walls' numbers, and for one of two at a wall that runs through, on which side of it."""
        numbers = f"{self.first.number}-{self.second.number}"
        if not self.through:
            return numbers
        wall, arm = (self.first, self.arms_rad[0]) if self._runs_first else (self.second, self.arms_rad[1])
        return f"{numbers}-{'ahead' if cos(arm - wall.theta_rad) > 0 else 'behind'}"

    @property
    def _runs_first(self) -> bool:
        return _past_end_m(self.first, self.x_m, self.y_m) < _past_end_m(self.second, self.x_m, self.y_m)

    @property
    def opening_rad(self) -> float:
        """The angle between the arms, in (0, pi)."""
        return abs(wrap_angle(self.arms_rad[1] - self.arms_rad[0]))

    @property
    def bisector_rad(self) -> float:
        """The direction half way between the arms."""
        a, b = self.arms_rad
        return wrap_angle(a + wrap_angle(b - a) / 2)

    @property
    def shorter_arm_m(self) -> float:
        """How far the shorter of the walls leads away."""
        return min(_arm_m(self.first, self.arms_rad[0], self), _arm_m(self.second, self.arms_rad[1], self))


def meetings(walls: Sequence[Wall], limits: CornerLimits) -> list[Meeting]:
    """Return where walls meet, each pair at most once, or twice where one of them runs through behind the other."""
    found = []
    for i, j in _candidates(walls, limits):
        found += _meet(walls[i], walls[j], limits)
    return found


def corners(walls: Sequence[Wall], grid: Grid | None, limits: CornerLimits) -> list[Meeting]:
    """Return the corners of these walls with their shapes, of several at one place that with the longest arms."""
    closed = [m for m in meetings(walls, limits) if grid is None or not is_open(m, grid)]
    shaped = [replace(m, shape=shape_of(m, grid)) for m in closed]
    shaped = [m for m in shaped if not m.through or m.shape == "concave"]  # the side where there is room
    kept: list[Meeting] = []
    for meeting in sorted(shaped, key=lambda m: (-m.shorter_arm_m, m.name)):
        if not any(_same_place(meeting, other, limits) for other in kept):
            kept.append(meeting)
    return sorted(kept, key=lambda m: (m.first.number, m.second.number, m.name))


def is_open(meeting: Meeting, grid: Grid) -> bool:
    """Say whether the grid shows that a wall ends where its line ends, short of the corner: more than a cell between is empty.

    A line lies within a cell of its wall, so that only what is empty to either side, too, is no wall.
    """
    for wall in (meeting.first, meeting.second):
        past = _past_end_m(wall, meeting.x_m, meeting.y_m)
        steps = np.arange(1.0, past / (grid.cell_m / 2.0) - 1.0)[:, None] * grid.cell_m / 2.0
        if len(steps) == 0:
            continue
        away = _away_rad(wall, meeting.x_m, meeting.y_m)
        direction, across = np.array([cos(away), sin(away)]), np.array([-sin(away), cos(away)]) * grid.cell_m
        places = np.array([meeting.x_m, meeting.y_m]) + steps * direction
        beside = np.stack([grid.values_at(places + k * across) for k in (-1, 0, 1)])
        empty = (beside <= EMPTY_MAX).all(axis=0)
        if np.count_nonzero(empty) > 2:  # steps of half a cell
            return True
    return False


def shape_of(meeting: Meeting, grid: Grid | None) -> Shape:
    """Return on which side of the corner the grid is empty: within its angle (concave), outside (convex), or neither surely."""
    if grid is None:
        return "unknown"
    reach = np.linspace(*LOOK_M, LOOKS)
    direction = np.array([cos(meeting.bisector_rad), sin(meeting.bisector_rad)])
    points = np.array([meeting.x_m, meeting.y_m]) + np.concatenate([reach, -reach])[:, None] * direction
    empty = grid.values_at(points) <= EMPTY_MAX
    inside, outside = int(empty[:LOOKS].sum()), int(empty[LOOKS:].sum())
    if inside >= LOOKS // 2 and outside <= LOOKS // 3 and inside > outside:
        return "concave"
    if outside >= LOOKS // 2 and inside <= LOOKS // 3 and outside > inside:
        return "convex"
    return "unknown"


def sigmas(covariance: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return (sigma x, sigma y, correlation) of a covariance (xx, xy, yy)."""
    xx, xy, yy = covariance
    product = sqrt(max(xx, 0.0) * max(yy, 0.0))
    correlation = max(-1.0, min(1.0, xy / product)) if product > 0 else 0.0
    return sqrt(max(xx, 0.0)), sqrt(max(yy, 0.0)), correlation


def _candidates(walls: Sequence[Wall], limits: CornerLimits) -> list[tuple[int, int]]:
    """Return the pairs at an angle to each other whose carriers cross near both (vectorised: it leaves few)."""
    if len(walls) < 2:
        return []
    theta = np.array([w.theta_rad for w in walls])
    middle = np.array([(w.x_m, w.y_m) for w in walls])
    half = np.array([w.half_length_m for w in walls])
    c, s = np.cos(theta), np.sin(theta)
    turn = s[None, :] * c[:, None] - c[None, :] * s[:, None]  # (i, j): sin of j's direction as seen from i's
    steep = np.abs(turn) >= sin(limits.opening_rad)
    dx, dy = middle[None, :, 0] - middle[:, None, 0], middle[None, :, 1] - middle[:, None, 1]
    safe = np.where(steep, turn, 1.0)
    along_i = (dx * s[None, :] - dy * c[None, :]) / safe  # of the crossing, from i's middle along i
    near = steep & (np.abs(along_i) <= half[:, None] + limits.gap_m)
    near &= near.T
    return [(int(i), int(j)) for i, j in np.argwhere(np.triu(near, 1))]


def _meet(a: Wall, b: Wall, limits: CornerLimits) -> list[Meeting]:
    normals = np.array([(-sin(w.theta_rad), cos(w.theta_rad)) for w in (a, b)])
    offsets = [n[0] * w.x_m + n[1] * w.y_m for n, w in zip(normals, (a, b), strict=True)]
    inverse = np.linalg.inv(normals)
    x, y = (float(v) for v in inverse @ offsets)
    past = [_past_end_m(w, x, y) for w in (a, b)]  # negative: that far inside
    variances = [w.sigma_rho_m**2 + (w.sigma_theta_rad * _along_m(w, x, y)) ** 2 for w in (a, b)]
    spread = inverse @ np.diag(variances) @ inverse.T
    through = [p < -limits.overrun_m for p in past]
    if all(through):
        return []  # two walls cannot cross: one of them is a mistake
    away = [[_away_rad(w, x, y)] for w in (a, b)]
    for number, wall in enumerate((a, b)):
        if through[number]:
            away[number] = [wall.theta_rad, wrap_angle(wall.theta_rad + pi)]
    found = []
    for arm_a in away[0]:
        for arm_b in away[1]:
            meeting = Meeting(
                first=a,
                second=b,
                x_m=x,
                y_m=y,
                covariance=(float(spread[0, 0]), float(spread[0, 1]), float(spread[1, 1])),
                arms_rad=(arm_a, arm_b),
                gap_m=max(0.0, *past),
                through=any(through),
            )
            if meeting.shorter_arm_m >= limits.arm_m:
                found.append(meeting)
    return found


def _along_m(wall: Wall, x: float, y: float) -> float:
    return (x - wall.x_m) * cos(wall.theta_rad) + (y - wall.y_m) * sin(wall.theta_rad)


def _past_end_m(wall: Wall, x: float, y: float) -> float:
    return abs(_along_m(wall, x, y)) - wall.half_length_m


def _away_rad(wall: Wall, x: float, y: float) -> float:
    """Return the direction from (x, y) along the wall to its middle."""
    return wall.theta_rad if _along_m(wall, x, y) <= 0 else wrap_angle(wall.theta_rad + pi)


def _arm_m(wall: Wall, arm_rad: float, meeting: Meeting) -> float:
    c, s = cos(arm_rad), sin(arm_rad)
    return max((x - meeting.x_m) * c + (y - meeting.y_m) * s for x, y in wall.ends)


def _same_place(a: Meeting, b: Meeting, limits: CornerLimits) -> bool:
    near = hypot(a.x_m - b.x_m, a.y_m - b.y_m) <= limits.apart_m
    return near and abs(wrap_angle(a.bisector_rad - b.bisector_rad)) <= pi / 4
