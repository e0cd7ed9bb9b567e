"""A hypothesis that stays in doubt becomes a task: look at the place again from elsewhere, or wait and see.

Triggered by  hypotheses/symbol/verdict/*              Verdict: on whatever hypothesis, of whatever source
              observations/feature/odom_from_robot     Pose: now and then, since time passes
Reads         hypotheses/feature/grid, status/robot    where the robot could stand
Posts         motivations/resolution_task/<n>          ResolutionTask

A task carries the hypothesis' reasons for and against as its own endorsements, as they come and go, and ends confirmed,
denied, or given up after a stated time; closed ones stay on the board until there are too many of them. Source:
Bou-Ghannam 1992, sections 2.6 and 3.3, after Cohen.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import hypot
from typing import Any

from msgspec.structs import replace

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Endorsement, Entry
from blackboard.grid import Grid, way_is_empty
from blackboard.kinds import GRID, ODOM_FROM_ROBOT, RESOLUTION_TASK, ROBOT, VERDICT
from blackboard.messages.conflicts import ResolutionTask, Verdict
from blackboard.messages.geometry import Point
from blackboard.parameters import require
from blackboard.uncertainty.endorsements import standing
from knowledge_sources.frontiers import place_to_stand
from knowledge_sources.grid_mirror import GridMirror

SIGHT_M = 0.02  # half the width of the way along which one sees


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolutionTasksParams:
    """When a doubt becomes a task, and when one is given up."""

    patience_s: float = 2.0  # what resolves itself in the next ten scans is no task
    give_up_s: float = 300.0  # after the first moment at which something can come of it
    stand_m: float = 1.5  # from the place to where the robot stands; nearer than most sensors' reach, out of its way
    reach_m: float = 1.0  # from there to where there is room
    keep: int = 100  # closed tasks on the board; all are in the record

    def __post_init__(self) -> None:
        require(0.0 <= self.patience_s <= 3600.0, "patience_s", self.patience_s, "[0, 3600] seconds")
        require(1.0 <= self.give_up_s <= 1e6, "give_up_s", self.give_up_s, "[1, 1e6] seconds")
        require(0.1 <= self.stand_m <= 10.0, "stand_m", self.stand_m, "[0.1, 10] metres")
        require(0.0 <= self.reach_m <= 10.0, "reach_m", self.reach_m, "[0, 10] metres")
        require(1 <= self.keep <= 10_000, "keep", self.keep, "[1, 10000]")


@dataclass
class _Doubt:
    """A hypothesis that is unresolved, and since when."""

    verdict: Entry[Verdict]
    since_s: float
    task: str | None = None
    given_up: bool = False


@dataclass
class _Book:
    doubts: dict[str, _Doubt] = field(default_factory=dict)  # by the hypothesis' key
    closed: list[str] = field(default_factory=list)
    opened: int = 0


class ResolutionTasks(KnowledgeSource[ResolutionTasksParams]):
    """Opens, follows and closes tasks."""

    Params = ResolutionTasksParams
    triggers = (VERDICT, Trigger(kind=ODOM_FROM_ROBOT, min_interval_s=1.0))
    reads = (GRID, ROBOT)
    posts = (RESOLUTION_TASK,)
    rating = 2.0

    def __init__(self, params: ResolutionTasksParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._book = _Book()
        self._grid = GridMirror()

    def resume(self, state: object, board: Access) -> None:
        """Go on with the tasks and verdicts that stand."""
        super().resume(state, board)
        book, verdicts = self._book, {entry.value.hypothesis: entry for entry in board.entries(VERDICT)}
        book.opened = max(book.opened, board.last_number(RESOLUTION_TASK))
        tasks = board.own(RESOLUTION_TASK)
        book.closed = [str(task.id) for task in tasks if task.value.outcome != "open"]
        book.doubts = {key: doubt for key, doubt in book.doubts.items() if key in verdicts}
        for task in tasks:
            verdict = verdicts.get(task.value.hypothesis)
            if task.value.outcome == "open" and verdict is None:  # its hypothesis went while nobody followed it
                board.retract(RESOLUTION_TASK, task.id)
            elif task.value.outcome == "open" and verdict is not None:
                doubt = book.doubts.setdefault(task.value.hypothesis, _Doubt(verdict, task.value.opened_s))
                doubt.task = str(task.id)
        for verdict in verdicts.values():
            self._hear(verdict, board)

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        if isinstance(trigger.value, Verdict):
            self._hear(trigger, board)
        self._tend(board)

    def finish(self, board: Access) -> None:
        self._tend(board)

    def _hear(self, verdict: Entry[Verdict], board: Access) -> None:
        """Take note of a verdict: a doubt begins, changes, or ends."""
        key, doubts = verdict.value.hypothesis, self._book.doubts
        doubt = doubts.get(key)
        if verdict.value.outcome == "unresolved":
            if doubt is None:
                doubt = doubts[key] = _Doubt(verdict, verdict.stamp_s)
            doubt.verdict = verdict
        if doubt is None:
            return
        task = board.newest(RESOLUTION_TASK, doubt.task) if doubt.task is not None else None
        if task is not None and task.value.outcome == "open":
            task = self._follow(task, verdict, board)
            if verdict.value.outcome != "unresolved":
                detail = f"by {verdict.value.theory}, {verdict.stamp_s - task.value.opened_s:.1f} s after it was opened"
                self._close(task, verdict, verdict.value.outcome, detail, board)
        if verdict.value.outcome != "unresolved":
            del doubts[key]

    def _tend(self, board: Access) -> None:
        """Open what has been in doubt long enough; give up what has been open too long."""
        now_s, params = board.now_s, self.params
        for doubt in list(self._book.doubts.values()):
            if doubt.task is None:
                if now_s - doubt.since_s >= params.patience_s:
                    self._open(doubt, board)
                continue
            task = board.newest(RESOLUTION_TASK, doubt.task)
            if task is None or task.value.outcome != "open":
                continue
            if now_s >= task.value.until_s:
                lacking = ", ".join(doubt.verdict.value.lacking) or "more reasons"
                detail = (
                    f"within {task.value.until_s - task.value.opened_s:.0f} s nothing came of it; lacking: {lacking}"
                )
                self._close(task, doubt.verdict, "given up", detail, board)
            elif task.value.stand is None and task.value.place is not None:
                stand = self._stand(doubt.verdict.value, board)  # there may be room, now that more is known
                if stand is not None:
                    board.post(RESOLUTION_TASK, replace(task.value, stand=stand), id=task.id, supports=[doubt.verdict])

    def _open(self, doubt: _Doubt, board: Access) -> None:
        self._book.opened += 1
        verdict, now_s = doubt.verdict.value, board.now_s
        not_before_s = max(now_s, verdict.wait_until_s or now_s)
        value = ResolutionTask(
            hypothesis=verdict.hypothesis,
            todo="look again" if verdict.wait_until_s is None else "wait and see",
            outcome="open",
            opened_s=now_s,
            not_before_s=not_before_s,
            until_s=not_before_s + self.params.give_up_s,
            place=verdict.place,
            stand=self._stand(verdict, board),
            detail=f"lacking: {', '.join(verdict.lacking)}" if verdict.lacking else "",
        )
        doubt.task = str(self._book.opened)
        task = board.post(RESOLUTION_TASK, value, id=doubt.task, supports=[doubt.verdict])
        self._mirror(task, doubt.verdict, board)

    def _follow(self, task: Entry[ResolutionTask], verdict: Entry[Verdict], board: Access) -> Entry[ResolutionTask]:
        """Keep a task's reasons, and where to look from, in step with its hypothesis."""
        value = task.value
        if verdict.value.outcome == "unresolved":
            stand = self._stand(verdict.value, board) or value.stand
            if stand is not None and value.stand is not None and _apart_m(stand, value.stand) < self.params.reach_m / 2:
                stand = value.stand  # much the same place
            value = replace(value, place=verdict.value.place, stand=stand)
            if value != task.value:
                task = board.post(RESOLUTION_TASK, value, id=task.id, supports=[verdict])
        return self._mirror(task, verdict, board)

    def _mirror(self, task: Entry[Any], verdict: Entry[Verdict], board: Access) -> Entry[Any]:
        reasons = {f"{e.who}/{e.about}" if e.about else e.who: e for e in _reasons(verdict, board)}
        said = {e.about: e for e in standing(task.endorsements) if e.who == board.name}
        for about in said:
            if about not in reasons:
                task = board.withdraw(task, about, "withdrawn there too")
        for about, e in reasons.items():
            last = said.get(about)
            if (last is None or (last.verdict, last.why) != (e.verdict, e.why)) and e.verdict != "withdrawn":
                task = board.endorse(task, e.verdict, e.why, about=about, strength=e.strength)
        return task

    def _close(
        self, task: Entry[ResolutionTask], verdict: Entry[Verdict], outcome: Any, detail: str, board: Access
    ) -> None:
        value = replace(task.value, outcome=outcome, closed_s=board.now_s, detail=detail)
        board.post(RESOLUTION_TASK, value, id=task.id, supports=[verdict])
        self._book.closed.append(str(task.id))
        while len(self._book.closed) > self.params.keep:
            board.retract(RESOLUTION_TASK, self._book.closed.pop(0))

    def _stand(self, verdict: Verdict, board: Access) -> Point | None:
        """Return where to look from: near where the verdict says, or somewhere before the place and in sight of it."""
        robot, grid, place = board.newest(ROBOT), self._grid.look(board), verdict.place
        if robot is None or grid is None or place is None:
            return None
        if verdict.look_from is not None:
            wanted = [verdict.look_from]
        else:
            wanted = [
                Point(x_m=place.x_m + self.params.stand_m * dx, y_m=place.y_m + self.params.stand_m * dy)
                for dx, dy in ROUND
            ]
        return first_stand(grid, wanted, place, robot.value.radius_m, self.params.reach_m)


ROUND = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (0.7, 0.7), (-0.7, 0.7), (-0.7, -0.7), (0.7, -0.7))
SEEN_UP_TO = 0.6  # of the way to the place must be known to be empty: the rest may be what is in doubt


def first_stand(grid: Grid, wanted: Sequence[Point], place: Point, radius_m: float, reach_m: float) -> Point | None:
    """Return the first place near one of those wanted where the robot has room and sees most of the way to `place`."""
    for point in wanted:
        room = place_to_stand(grid, point.x_m, point.y_m, radius_m, reach_m)
        if room is None:
            continue
        part = (
            room.x_m + SEEN_UP_TO * (place.x_m - room.x_m),
            room.y_m + SEEN_UP_TO * (place.y_m - room.y_m),
        )
        if way_is_empty(grid, (room.x_m, room.y_m), part, SIGHT_M):
            return Point(x_m=room.x_m, y_m=room.y_m)
    return None


def _reasons(verdict: Entry[Verdict], board: Access) -> tuple[Endorsement, ...]:
    hypothesis = board.revisions(verdict.supports[0]) if verdict.supports else []
    return standing(hypothesis[-1].endorsements) if hypothesis else ()


def _apart_m(a: Point, b: Point) -> float:
    return hypot(a.x_m - b.x_m, a.y_m - b.y_m)
