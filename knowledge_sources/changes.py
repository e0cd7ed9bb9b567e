"""What is seen and what the map has shown for long differ: somebody stands there, a door was closed, a chair moved.

Triggered by  hypotheses/feature/grid                  GridTile: at most once in an interval
              observations/signal/laser_scan           LaserScan: what it says of the changes that stand
              observations/signal/sonar_scan           SonarScan: of a robot without a laser (smooth things are deaf at a slant)
Reads         status/robot, observations/feature/odom_from_robot, hypotheses/feature/map_from_odom
Posts         hypotheses/symbol/change/<n>             Change
              hypotheses/symbol/verdict/change.*       Verdict: with the time until which to wait and see

A change is in doubt until it has stayed: what is seen there again after `stay_s` is accepted as how the world is from now on;
what is as it was before, is denied and retracted. An accepted thing that is gone later is retracted too. Source: Bou-Ghannam 1992,
section 3.3: a conflict between what the sensors see and what they should see is reasoned about, not averaged away. Functions
in `long_standing` and `looks`.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from msgspec.structs import replace

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry
from blackboard.kinds import CHANGE, GRID, LASER_SCAN, ROBOT, SONAR_SCAN, VERDICT
from blackboard.messages.conflicts import Change
from blackboard.messages.geometry import Point
from blackboard.messages.sensing import LaserScan, SonarScan
from blackboard.parameters import require
from blackboard.uncertainty.theories import Theory
from knowledge_sources.grid_mirror import GridMirror
from knowledge_sources.long_standing import Difference, Floats, LongStanding
from knowledge_sources.looks import SEEN, THROUGH, Beams, beams_of, look
from knowledge_sources.poses import READS, map_from_robot_at
from knowledge_sources.standing_hypotheses import Reason, give
from knowledge_sources.stretches import Stretches
from knowledge_sources.verdicts import Verdicts

FADE_S = 60.0  # so long at most the grid may take to show what the looks have said
NEAR_M = 0.2  # cells so near to a change belong to it: its other sides, and its blur
TOLERANCE_M = 0.08  # of a range, at a cell of 5 cm with a laser's or a sonar's noise


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangesParams:
    """What is of long standing, what is a change, and when it has stayed."""

    interval_s: float = 1.0
    settled_s: float = 30.0  # what the grid has shown for so long is what the map expects
    lasted_s: float = 3.0  # what differs for less is somebody walking by
    least_cells: int = 5  # the front of a chair's seat or of a person; fewer are a beam's error
    near_m: float = 0.15  # of a wall: its front is blurred by two or three cells
    stay_s: float = 90.0  # a person stands still for a minute; what is there after half as long again is furniture
    least_looks: int = 5  # in a row that say the same: a second of a laser
    reach_m: float = 8.0  # what a scan says of places further off is not trusted
    theory: Theory = "endorsements"  # that weighs the reasons

    def __post_init__(self) -> None:
        for name in ("interval_s", "settled_s", "lasted_s", "stay_s"):
            require(0.0 <= getattr(self, name) <= 1e6, name, getattr(self, name), "[0, 1e6] seconds")
        require(self.lasted_s < self.settled_s, "lasted_s", self.lasted_s, "less than settled_s")
        for name in ("least_cells", "least_looks"):
            require(1 <= getattr(self, name) <= 10_000, name, getattr(self, name), "[1, 10000]")
        for name in ("near_m", "reach_m"):
            require(0.0 <= getattr(self, name) <= 100.0, name, getattr(self, name), "[0, 100] metres")


@dataclass
class _Watched:
    """A change that stands: its cells, and what scans have said of it lately."""

    id: str
    appeared: bool
    places: Floats  # (n, 2) m
    first_s: float
    supports: Stretches = field(default_factory=Stretches)
    there: int = 0  # looks in a row by which something stands there
    through: int = 0  # and by which nothing does
    accepted: bool = False
    until_s: float = 0.0

    def take(self, beams: Beams, reach_m: float) -> bool:
        """Count what a scan says of it; say whether it says anything."""
        said = look(beams, self.places, TOLERANCE_M, reach_m)
        seen, through = int((said == SEEN).sum()), int((said == THROUGH).sum())
        if seen >= 2 and seen > through:
            self.there, self.through = self.there + 1, 0
        elif through >= max(2, 0.3 * len(self.places)) and seen <= 0.1 * through:
            self.there, self.through = 0, self.through + 1
        else:
            return False
        return True

    @property
    def as_it_differs(self) -> int:
        """Looks in a row that bear the change out."""
        return self.there if self.appeared else self.through

    @property
    def as_it_was(self) -> int:
        """Looks in a row that speak against it."""
        return self.through if self.appeared else self.there


class Changes(KnowledgeSource[ChangesParams]):
    """Keeps a hypothesis for each change, until it has stayed or is undone."""

    Params = ChangesParams
    reads = (ROBOT, GRID, *READS)
    posts = (CHANGE, VERDICT)
    rating = 3.0

    def __init__(self, params: ChangesParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        watched = self._is_watching
        self.triggers = (
            Trigger(kind=GRID, min_interval_s=params.interval_s),
            Trigger(kind=LASER_SCAN, when=watched),
            Trigger(kind=SONAR_SCAN, when=watched),
        )
        self._grid = GridMirror()
        self._long = LongStanding(params.settled_s)
        self._watched: list[_Watched] = []
        self._fading: list[_Watched] = []  # denied; the grid takes a while to show it too
        self._named = 0
        self._verdicts = Verdicts(params.theory, needs=("stay",))

    def resume(self, state: object, board: Access) -> None:
        """Go on with the changes that stand and are remembered; what nobody remembers is taken back, to be found again."""
        super().resume(state, board)
        self._named = max(self._named, board.last_number(CHANGE))
        self._watched = [w for w in self._watched if board.newest(CHANGE, w.id) is not None]
        watched = {w.id for w in self._watched}
        for entry in board.own(CHANGE):
            if entry.id not in watched and not entry.value.accepted:
                board.retract(CHANGE, entry.id)
        self._verdicts.resume(board, CHANGE)

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        if isinstance(trigger.value, LaserScan | SonarScan):
            self._hear(trigger, board)
        else:
            self._compare(board)

    def _is_watching(self, entry: Entry[Any]) -> bool:
        return bool(self._watched)

    def _compare(self, board: Access) -> None:
        """Look for new differences, and for more of those that stand."""
        grid, params, now_s = self._grid.look(board), self.params, board.now_s
        if grid is None:
            return
        self._long.look(grid, now_s)
        for watched in self._watched:
            self._widen(watched)
        for watched in list(self._fading):
            shown = self._long.shown_occupied(watched.places)
            if now_s >= watched.until_s or (shown <= 0.05 if watched.appeared else shown >= 0.5):
                self._fading.remove(watched)
                self._settle(watched, occupied=not watched.appeared)
        for found in self._long.differences(now_s, params.lasted_s, params.near_m, params.least_cells):
            self._post(found, board)

    def _widen(self, watched: _Watched) -> None:
        """Take in what is seen of it from other sides."""
        more = self._long.around(watched.places, NEAR_M, watched.appeared)
        both = np.unique(np.round(np.concatenate([watched.places, more]), 6), axis=0)
        if len(both) > len(watched.places):
            watched.places = both
            if watched.accepted:
                self._long.settle(both, NEAR_M, watched.appeared)
            else:
                self._long.hold(both, NEAR_M, hold=True)

    def _post(self, found: Difference, board: Access) -> None:
        self._named += 1
        watched = _Watched(str(self._named), found.appeared, found.places, board.now_s - self.params.lasted_s)
        self._long.hold(found.places, NEAR_M, hold=True)
        self._watched.append(watched)
        watched.supports.add(self._tiles(found.places))
        entry = self._revise(watched, board)
        for_s = self.params.settled_s
        why = (
            f"{len(found.places)} cells that were empty for {for_s:.0f} s and more answer now"
            if found.appeared
            else f"{len(found.places)} cells where something stood for {for_s:.0f} s and more are seen through now"
        )
        self._judge(watched, give(board, entry, [Reason(why, "map")]), board)

    def _hear(self, scan: Entry[Any], board: Access) -> None:
        """Let a scan say what is there now, of all changes in view."""
        robot, found = board.newest(ROBOT), map_from_robot_at(board, scan.stamp_s)
        if robot is None or found is None or (robot.value.lasers and isinstance(scan.value, SonarScan)):
            return
        beams = beams_of(scan.value, robot.value, found[0])
        for watched in list(self._watched):
            if watched.take(beams, self.params.reach_m):
                watched.supports.add((scan, *found[1]))
                self._weigh(watched, scan.stamp_s, board)

    def _weigh(self, watched: _Watched, now_s: float, board: Access) -> None:
        enough, stayed_s = self.params.least_looks, now_s - watched.first_s
        entry = board.newest(CHANGE, watched.id)
        if entry is None:
            return
        if watched.as_it_was >= enough:
            before = "it is gone" if watched.appeared else "something stands there"
            why = f"seen {enough} times in a row, after {stayed_s:.0f} s: {before} again"
            entry = self._revise(watched, board)
            self._judge(watched, give(board, entry, [Reason(why, "map", "against", "strong")]), board)
            self._drop(watched, board)
        elif watched.as_it_differs >= enough and stayed_s >= self.params.stay_s and not watched.accepted:
            now = "still there" if watched.appeared else "still gone"
            map_ = next(e for e in entry.endorsements if e.about == "map")
            entry = self._revise(watched, board)
            reasons = [Reason(map_.why, "map"), Reason(f"{now} after {stayed_s:.0f} s", "stay", "for", "strong")]
            entry = give(board, entry, reasons)
            if self._judge(watched, entry, board) == "confirmed":
                self._accept(watched, entry, board)

    def _accept(self, watched: _Watched, entry: Entry[Change], board: Access) -> None:
        watched.accepted = True
        self._settle(watched, occupied=watched.appeared)
        entry = board.post(CHANGE, replace(entry.value, accepted=True), id=watched.id, supports=[entry])
        self._judge(watched, entry, board)
        if not watched.appeared:
            self._watched.remove(watched)  # floor like any other

    def _drop(self, watched: _Watched, board: Access) -> None:
        """Take back what is not so, or not any more."""
        entry = board.newest(CHANGE, watched.id)
        if entry is not None:
            self._verdicts.close(board, entry)
            board.retract(CHANGE, watched.id)
        self._watched.remove(watched)
        self._long.hold(watched.places, NEAR_M, hold=True)
        watched.until_s = board.now_s + FADE_S
        self._fading.append(watched)

    def _settle(self, watched: _Watched, occupied: bool) -> None:
        """Let the map expect there what the looks have said, where the grid shows it."""
        self._long.hold(watched.places, NEAR_M, hold=False)
        self._long.settle(watched.places, NEAR_M, occupied)

    def _revise(self, watched: _Watched, board: Access) -> Entry[Change]:
        low, high = watched.places.min(axis=0), watched.places.max(axis=0)
        middle = ((low + high) / 2).tolist()
        value = Change(
            change="appeared" if watched.appeared else "gone",
            place=Point(x_m=middle[0], y_m=middle[1]),
            size_m=float((high - low).max()),
            first_s=watched.first_s,
            accepted=watched.accepted,
        )
        return board.post(CHANGE, value, id=watched.id, supports=watched.supports.supports())

    def _judge(self, watched: _Watched, entry: Entry[Change], board: Access) -> str:
        return self._verdicts.judge(board, entry, wait_until_s=watched.first_s + self.params.stay_s).outcome

    def _tiles(self, places: Floats) -> list[Entry[Any]]:
        low, high = places.min(axis=0).tolist(), places.max(axis=0).tolist()
        return [*self._grid.tiles_in(low[0], low[1], high[0], high[1])]
