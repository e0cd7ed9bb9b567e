"""Objects whose model has a part, as a mug has a handle: a missing part is a reason against; a look from elsewhere may find it.

Triggered by  observations/signal/laser_scan              LaserScan
Reads         status/robot, observations/feature/odom_from_robot, hypotheses/feature/map_from_odom
Posts         hypotheses/symbol/two_part_object/<name>-<n>      TwoPartObject
              hypotheses/symbol/verdict/two_part_object.*       Verdict: with the place to look from, while the part is missing

Source: Bou-Ghannam 1992, sections 2.6 and 3.3: the absence of the handle is recorded, not only weighed; a task looks for it from
elsewhere; found, it restores the confidence. Seen all round without it, the body is something else. Functions in `round_bodies` and
`part_view`.
"""

from dataclasses import dataclass, field
from math import cos, hypot, pi, sin
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry
from blackboard.kinds import LASER_SCAN, ROBOT, TWO_PART_OBJECT, VERDICT
from blackboard.messages.conflicts import TwoPartObject
from blackboard.messages.geometry import Point
from blackboard.messages.sensing import LaserScan
from blackboard.parameters import require
from blackboard.uncertainty.theories import Theory
from knowledge_sources.looks import SEEN, THROUGH, Beams, beams_of, look
from knowledge_sources.part_view import SECTORS, PartView
from knowledge_sources.poses import READS, map_from_robot_at
from knowledge_sources.round_bodies import BodyLimits, clusters, round_body
from knowledge_sources.standing_hypotheses import Reason, give
from knowledge_sources.stretches import Stretches
from knowledge_sources.verdicts import Verdicts

STEP_SECTORS = 6  # a look that has shown 60 degrees more is worth a revision
ALL_ROUND = SECTORS - 2  # a sector or two may stay undecided beside a neighbour's shadow
GONE_SCANS = 10  # through where the body stood: two seconds of a laser at 5 Hz


@dataclass(frozen=True, slots=True, kw_only=True)
class TwoPartObjectsParams:
    """The model: a round body, and a part that sticks out of it on one side; and how it is looked at."""

    model: str = "mug"
    body_radius_m: float = 0.15
    part_length_m: float = 0.2  # from the body's surface outwards
    reach_m: float = 2.0  # further off fewer than seven beams of a laser at 1 degree meet the body
    least_scans: int = 8  # that show a body at one place before it is a hypothesis
    least_fraction: float = 0.35  # of the scans in which something answers there: a corner looks round from few places
    same_m: float = 0.15  # bodies nearer to each other than this are one
    look_from_m: float = 1.2  # where the part is looked for from: within reach, clear of the object
    theory: Theory = "endorsements"  # that weighs the reasons
    limits: BodyLimits = field(init=False)

    def __post_init__(self) -> None:
        require(bool(self.model), "model", self.model, "names of at least one letter")
        for name in ("body_radius_m", "part_length_m"):
            require(0.05 <= getattr(self, name) <= 2.0, name, getattr(self, name), "[0.05, 2] metres")
        require(0.5 <= self.reach_m <= 20.0, "reach_m", self.reach_m, "[0.5, 20] metres")
        require(1 <= self.least_scans <= 1000, "least_scans", self.least_scans, "[1, 1000]")
        require(0.0 <= self.least_fraction <= 1.0, "least_fraction", self.least_fraction, "[0, 1]")
        for name in ("same_m", "look_from_m"):
            require(0.01 <= getattr(self, name) <= 10.0, name, getattr(self, name), "[0.01, 10] metres")
        part_m = self.part_length_m
        limits = BodyLimits(radius_m=self.body_radius_m, part_m=part_m, jump_m=part_m + 0.1, reach_m=self.reach_m)
        object.__setattr__(self, "limits", limits)


@dataclass
class _Track:
    """A body that was seen at one place, and what was seen round it."""

    x_m: float
    y_m: float
    radius_m: float
    scans: int = 1
    looks: int = 0  # scans in which something answered there
    view: PartView = field(default_factory=PartView)
    supports: Stretches = field(default_factory=Stretches)
    id: str = ""
    told: tuple[int, bool] | None = None  # sectors looked at and whether the part was seen, as last posted
    passed: int = 0  # scans in a row that went through its place
    over: bool = False  # denied: it is no such object

    def add(self, x_m: float, y_m: float, radius_m: float) -> None:
        """Take the mean with one body more."""
        self.scans += 1
        share = 1.0 / min(self.scans, 50)  # later ones still count, should the map have moved
        self.x_m += share * (x_m - self.x_m)
        self.y_m += share * (y_m - self.y_m)
        self.radius_m += share * (radius_m - self.radius_m)


class TwoPartObjects(KnowledgeSource[TwoPartObjectsParams]):
    """Keeps a hypothesis for each body of the model's size, until its part is seen or it is known to have none."""

    Params = TwoPartObjectsParams
    triggers = (LASER_SCAN,)
    reads = (ROBOT, *READS)
    posts = (TWO_PART_OBJECT, VERDICT)
    rating = 4.0

    def __init__(self, params: TwoPartObjectsParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._tracks: list[_Track] = []
        self._named = 0
        self._verdicts = Verdicts(params.theory, needs=("body", "part"))

    def resume(self, state: object, board: Access) -> None:
        """Go on with the objects that stand and are remembered; what nobody remembers is taken back, to be found again."""
        super().resume(state, board)
        self._named = max(self._named, board.last_number(TWO_PART_OBJECT, f"{self.params.model}-"))
        self._tracks = [t for t in self._tracks if not t.id or board.newest(TWO_PART_OBJECT, t.id) is not None]
        known = {track.id for track in self._tracks}
        for entry in board.own(TWO_PART_OBJECT):
            if entry.id not in known:
                board.retract(TWO_PART_OBJECT, entry.id)
        self._verdicts.resume(board, TWO_PART_OBJECT)

    def activate(self, trigger: Entry[LaserScan], board: Access) -> None:
        robot, found = board.newest(ROBOT), map_from_robot_at(board, trigger.stamp_s)
        if robot is None or found is None:
            return
        beams = beams_of(trigger.value, robot.value, found[0])
        if not len(beams.range_m):
            return
        supports: tuple[Entry[Any], ...] = (trigger, *found[1])
        self._find(beams, supports)
        for track in self._tracks:
            if self._looks_at(track, beams):
                track.supports.add(supports)
                self._tell(track, board)
        self._tracks = [t for t in self._tracks if t.passed < GONE_SCANS]

    def _find(self, beams: Beams, supports: tuple[Entry[Any], ...]) -> None:
        params, sensor = self.params, (float(beams.x_m[0]), float(beams.y_m[0]))
        for points in clusters(beams, params.limits.jump_m, params.reach_m):
            body = round_body(points, sensor, params.limits)
            if body is None:
                continue
            near = [t for t in self._tracks if hypot(t.x_m - body.x_m, t.y_m - body.y_m) <= params.same_m]
            if near:
                near[0].add(body.x_m, body.y_m, body.radius_m)
            else:
                track = _Track(body.x_m, body.y_m, body.radius_m)
                track.supports.add(supports)
                self._tracks.append(track)

    def _looks_at(self, track: _Track, beams: Beams) -> bool:
        """Take note of what a scan shows of a body and round it; say whether it shows anything."""
        params = self.params
        middle = np.array([[track.x_m, track.y_m]])
        away = hypot(track.x_m - float(beams.x_m[0]), track.y_m - float(beams.y_m[0]))
        if away > params.reach_m or away < track.radius_m:
            return False
        said = int(look(beams, middle, track.radius_m + params.limits.tolerance_m, params.reach_m)[0])
        track.passed = track.passed + 1 if said == THROUGH else 0 if said else track.passed
        track.looks += said == SEEN
        if track.scans >= params.least_scans and not track.over:
            track.view.add(beams, track.x_m, track.y_m, track.radius_m, params.part_length_m, params.reach_m)
        return bool(said)

    def _tell(self, track: _Track, board: Access) -> None:
        """Post what has changed by more than a little, with the reasons for and against."""
        if track.scans < self.params.least_scans or track.over:
            return
        known = track.told is not None and track.told[1]
        if not known and track.scans < self.params.least_fraction * track.looks:
            if track.id:
                self._deny(
                    track, [Reason("from most places it does not look round", "body", "against", "strong")], board
                )
            return
        if track.passed >= GONE_SCANS:
            if track.id:
                self._deny(track, [Reason("beams go through where it stood", "body", "against", "strong")], board)
            return
        absent, part_rad = int(track.view.absent.sum()), track.view.part_rad()
        if not absent and part_rad is None:
            return  # not looked at long enough
        told = track.told
        news = told is None or (not told[1] and (part_rad is not None or absent - told[0] >= STEP_SECTORS))
        around = part_rad is None and absent >= ALL_ROUND
        if not news and not around:
            return
        reasons = [Reason(f"a round body of radius {track.radius_m:.2f} m stands free", "body")]
        if part_rad is not None:
            reasons.append(
                Reason(f"its part sticks out at {np.degrees(part_rad):.0f} degrees", "part", "for", "strong")
            )
        elif around:
            self._deny(
                track, [*reasons, Reason("looked at all round, it has no part", "part", "against", "strong")], board
            )
            return
        else:
            degrees = round(360 * absent / SECTORS)
            reasons.append(Reason(f"no part in the {degrees} of 360 degrees that were looked at", "part", "against"))
        track.told = (absent, part_rad is not None)
        entry = self._post(track, absent, part_rad, board)
        self._verdicts.judge(board, give(board, entry, reasons), look_from=self._look_from(track))

    def _post(self, track: _Track, absent: int, part_rad: float | None, board: Access) -> Entry[TwoPartObject]:
        if not track.id:
            self._named += 1
            track.id = f"{self.params.model}-{self._named}"
        value = TwoPartObject(
            model=self.params.model,
            place=Point(x_m=track.x_m, y_m=track.y_m),
            body_radius_m=track.radius_m,
            part_bearing_rad=part_rad,
            looked_rad=2 * pi * absent / SECTORS,
            scans=track.scans,
        )
        return board.post(TWO_PART_OBJECT, value, id=track.id, supports=track.supports.supports())

    def _deny(self, track: _Track, reasons: list[Reason], board: Access) -> None:
        """Say what speaks against it, and take it back."""
        track.over = True
        entry = self._post(track, int(track.view.absent.sum()), None, board)
        entry = give(board, entry, reasons)
        self._verdicts.judge(board, entry)
        self._verdicts.close(board, entry)
        board.retract(TWO_PART_OBJECT, track.id)

    def _look_from(self, track: _Track) -> Point | None:
        """Return a place on the side that was not looked at yet."""
        angle = track.view.unseen_rad()
        if angle is None:
            return None
        away = self.params.look_from_m
        return Point(x_m=track.x_m + away * cos(angle), y_m=track.y_m + away * sin(angle))
