"""Keeps, while a mission runs, the few moments that `figures.png` shows.

Entries never change once they are posted, so to remember a moment is to keep references: what is drawn is put together at the end.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import cos, inf, sin
from typing import Any

import numpy as np

from blackboard.command.seen_run import SeenRun
from blackboard.entry import Entry
from blackboard.grid import Grid
from blackboard.kinds import (
    BEHAVIOUR,
    GRID,
    LASER_SCAN,
    LINE,
    LINE_SET,
    MODEL_LINE,
    MOTIVATION,
    SONAR_SCAN,
    SUPPORTED_POINTS,
    Kind,
)
from blackboard.messages.geometry import Point
from blackboard.messages.motion import BehaviourStatus, Motivation
from blackboard.messages.sensing import LaserScan, RobotDescription, SonarScan
from blackboard.messages.world import GridTile, Line, PointSet
from blackboard.mission import Mission
from blackboard.report.milestones import GridStage, Lead, LineStage, Milestones, Points, Visit
from blackboard.report.result import Trajectory, segments
from blackboard.report.view import known_part

EARLY_SCANS = (1, 5)  # full scans after which the grid is shown (Bou-Ghannam 1992, Figure 6.2)
SET_POINTS = 500  # points of a set of lines (Figures 6.4 to 6.7); smaller batches are joined until they have as many
HELD_SCANS = 3000  # of the first set; a mission that never gathers one must not hold them for ever
SETTLED_S = 1.0  # after a set of lines, what merges them has had its turn
PLACE = ("x_m", "y_m")  # parameters of a behaviour that goes somewhere


@dataclass
class _Set:
    """Batches of points with their lines, gathered until there are enough."""

    batches: list[Entry[PointSet]] = field(default_factory=list)
    lines: list[Line] = field(default_factory=list)
    points: int = 0
    stamp_s: float = 0.0


class MilestoneCollector:
    """Watches the board of a run and keeps what its figures need."""

    def __init__(self, run: SeenRun) -> None:
        self._run = run
        self._board = run.board
        self._tiles: dict[str, GridTile] = {}
        self._grid_s: float | None = None  # when the grid was posted last
        self._stages: list[tuple[float, int, dict[str, GridTile]]] = []
        self._accumulated: tuple[float, int, dict[str, GridTile]] | None = None  # under the first set of points
        self._scans = 0
        self._heard: set[int] = set()
        self._first_scans: deque[Entry[Any]] = deque(maxlen=HELD_SCANS)
        self._sets: list[_Set] = [_Set()]
        self._merged: tuple[float, list[Any]] | None = None
        self._competing = competing(run.mission)
        self._active: dict[str, bool] = {}
        self._leads: list[Lead] = []
        self._goes = {spec.name for spec in run.mission.behaviours if _goes_somewhere(spec.type)}
        self._visits: dict[tuple[str, int], Visit] = {}
        for kind, watcher in (
            (SONAR_SCAN, self._note_scan),
            (LASER_SCAN, self._note_scan),
            (GRID, self._note_tile),
            (SUPPORTED_POINTS, self._note_points),
            (LINE_SET, self._note_lines),
            (BEHAVIOUR, self._note_behaviour),
            (MOTIVATION, self._note_motivation),
        ):
            self._board.subscribe(_everywhere(self._board.robot, kind), watcher)

    def milestones(self) -> Milestones:
        """Return what was kept, put together; call it once the run is over."""
        self._settle(inf)
        sets = [one for one in self._sets if one.lines]
        whole = sets[0].batches if sets else self._sets[0].batches
        latest = self._accumulated or (self._board.now_s, self._scans, self._tiles)
        stages = [_grid_stage(*stage) for stage in (*self._stages, latest)]
        return Milestones(
            scans=[stage for stage in stages if stage is not None],
            raw=self._raw(whole),
            filtered=_joined([batch.value.points.unpack() for batch in whole]),
            first=_line_stage(sets[0], self._run.robot.start_s) if sets else None,
            second=_line_stage(sets[1], sets[0].stamp_s) if len(sets) > 1 else None,
            merged=self._merged_stage(),
            behaviours=[spec.name for spec in self._run.mission.behaviours],
            leads=self._leads,
            visits=list(self._visits.values()),
        )

    # Scans and the grid

    def _note_scan(self, entry: Entry[Any]) -> None:
        self._settle(entry.stamp_s)
        if self._sets_done:
            return
        self._first_scans.append(entry)
        robot = self._run.robot.description
        if isinstance(entry.value, SonarScan):
            self._heard.update(entry.value.sensors)
            if len(self._heard) < len(robot.sonars):
                return
            self._heard.clear()
        self._scans += 1

    def _note_tile(self, entry: Entry[GridTile]) -> None:
        if self._sets_done:
            return
        self._settle(self._board.now_s)
        self._tiles[entry.key] = entry.value
        self._grid_s = self._board.now_s

    def _settle(self, now_s: float) -> None:
        """Keep what is complete: a posting of the grid consists of many tiles, and lines are merged after they are seen."""
        if self._grid_s is not None and now_s > self._grid_s:
            wanted = EARLY_SCANS[len(self._stages)] if len(self._stages) < len(EARLY_SCANS) else None
            if wanted is not None and self._scans >= wanted:
                self._stages.append((self._grid_s, self._scans, dict(self._tiles)))
            self._grid_s = None
        complete = len(self._sets) > 2 or now_s == inf
        if self._merged is None and complete and self._sets[1:] and now_s > self._sets[1].stamp_s + SETTLED_S:
            self._merged = (self._board.now_s, [entry.value for entry in self._board.entries(MODEL_LINE)])

    # Points and lines

    @property
    def _sets_done(self) -> bool:
        return len(self._sets) > 1

    def _note_points(self, entry: Entry[PointSet]) -> None:
        current = self._sets[-1]
        if len(self._sets) > 2 or current.points >= SET_POINTS:
            return
        current.batches.append(entry)
        current.points += entry.value.points.shape[0]
        if not self._sets_done and current.points >= SET_POINTS and self._tiles:
            self._accumulated = (entry.stamp_s, self._scans, dict(self._tiles))

    def _note_lines(self, entry: Entry[Any]) -> None:
        if len(self._sets) > 2:
            return
        current = self._sets[-1]
        found = [self._board.newest(LINE, name) for name in entry.value.lines]
        current.lines += [line.value for line in found if line is not None]
        current.stamp_s = entry.stamp_s
        if current.points >= SET_POINTS:
            self._sets.append(_Set())

    def _raw(self, batches: Sequence[Entry[PointSet]]) -> Points | None:
        """Return every echo of the scans that the batches were taken from."""
        wanted: dict[str, set[int]] = {}
        for batch in batches:
            for support in batch.supports:
                wanted.setdefault(support.key, set()).update(range(support.first, support.last + 1))
        scans = [entry for entry in self._first_scans if entry.revision in wanted.get(entry.key, ())]
        trajectory, robot = self._run.trajectory(), self._run.robot.description
        if not scans or not len(trajectory):
            return None
        return _joined([echo_points(scan, robot, trajectory) for scan in scans])

    def _merged_stage(self) -> LineStage | None:
        if self._merged is None or not self._merged[1]:
            return None
        stamp_s, lines = self._merged
        return LineStage(from_s=self._run.robot.start_s, stamp_s=stamp_s, ends=segments(lines))

    # Behaviours and where they go

    def _note_behaviour(self, entry: Entry[BehaviourStatus]) -> None:
        name, status = entry.id or "", entry.value
        self._active[name] = entry.event != "retracted" and status.state == "active"
        lead = self._lead()
        if not self._leads or self._leads[-1].behaviour != lead:
            if self._leads and self._leads[-1].stamp_s == entry.stamp_s:
                self._leads.pop()
            self._leads.append(Lead(stamp_s=entry.stamp_s, behaviour=lead))
        asked = (name, status.acknowledged)
        if asked in self._visits and status.outcome in ("reached", "blocked"):
            self._visits[asked] = replace(self._visits[asked], outcome=status.outcome)

    def _lead(self) -> str:
        """Return the first of those behaviours that silence each other, else the first of all that answer."""
        names = [spec.name for spec in self._run.mission.behaviours if self._active.get(spec.name)]
        return next((name for name in names if name in self._competing), names[0] if names else "")

    def _note_motivation(self, entry: Entry[Motivation]) -> None:
        name, asked = entry.id or "", entry.value
        if entry.event == "retracted" or not asked.on or name not in self._goes or len(asked.parameters) < len(PLACE):
            return
        x_m, y_m = asked.parameters[: len(PLACE)]
        if isinstance(x_m, float) and isinstance(y_m, float):
            place = Point(x_m=x_m, y_m=y_m)
            visit = Visit(place=place, behaviour=name, stamp_s=entry.stamp_s)
            self._visits.setdefault((name, asked.number), visit)


def competing(mission: Mission) -> frozenset[str]:
    """Return the behaviours that silence another or are silenced; the others only add to what these do."""
    silenced = {name for spec in mission.behaviours for name in spec.wiring.inhibits}
    return frozenset(silenced | {spec.name for spec in mission.behaviours if spec.wiring.inhibits})


def echo_points(entry: Entry[Any], robot: RobotDescription, trajectory: Trajectory) -> Points:
    """Return the echoes of a scan as points, each on the axis of its cone, from where the robot believed to be then."""
    stamps, heading = trajectory[:, 0], np.unwrap(trajectory[:, 3])
    x_m, y_m, turn = (float(np.interp(entry.stamp_s, stamps, row)) for row in (*trajectory[:, 1:3].T, heading))
    scan: SonarScan | LaserScan = entry.value
    points: list[tuple[float, float]] = []
    if isinstance(scan, LaserScan):
        laser = robot.lasers[scan.laser]
        mounts = [
            (laser.mount, laser.max_range_m, scan.angle_min_rad + i * scan.angle_step_rad)
            for i in range(len(scan.ranges_m))
        ]
    else:
        mounts = [(robot.sonars[i].mount, robot.sonars[i].max_range_m, 0.0) for i in scan.sensors]
    for (mount, limit_m, angle_rad), range_m in zip(mounts, scan.ranges_m, strict=True):
        if range_m is None or range_m >= limit_m:
            continue
        bearing = mount.heading_rad + angle_rad
        forward, left = mount.x_m + range_m * cos(bearing), mount.y_m + range_m * sin(bearing)
        points.append((x_m + forward * cos(turn) - left * sin(turn), y_m + forward * sin(turn) + left * cos(turn)))
    return np.array(points, dtype=np.float64).reshape(-1, 2)


def _everywhere(robot: str, kind: Kind[Any]) -> str:
    return f"ski/{robot}/{kind.path}" + ("/*" if kind.collection else "")


def _goes_somewhere(behaviour: type[Any]) -> bool:
    return tuple(getattr(behaviour, "parameters", ()))[: len(PLACE)] == PLACE


def _grid_stage(stamp_s: float, scans: int, tiles: dict[str, GridTile]) -> GridStage | None:
    grid = Grid.from_tiles(tiles.values())
    known = known_part(grid) if grid is not None else None
    return GridStage(stamp_s=stamp_s, scans=scans, grid=known) if known is not None else None


def _line_stage(gathered: _Set, from_s: float) -> LineStage:
    return LineStage(from_s=from_s, stamp_s=gathered.stamp_s, ends=segments(gathered.lines), points=gathered.points)


def _joined(parts: Sequence[Any]) -> Points | None:
    return np.concatenate([np.asarray(part, dtype=np.float64) for part in parts]) if parts else None
