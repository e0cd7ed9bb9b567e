"""A doubt becomes a task, carries the reasons, knows where to stand, and ends confirmed, denied or given up."""

from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.board import Board
from blackboard.entry import Entry, Support
from blackboard.grid import Grid, tile_id, way_is_empty
from blackboard.kinds import CHANGE, GRID, ODOM_FROM_ROBOT, RESOLUTION_TASK, ROBOT, TRAP, VERDICT
from blackboard.messages.conflicts import ResolutionTask
from blackboard.messages.geometry import IDENTITY, Point
from blackboard.messages.sensing import RobotDescription
from blackboard.messages.symbols import Trap
from blackboard.uncertainty.endorsements import standing
from blackboard.vocabulary import Vocabulary
from knowledge_sources.resolution_tasks import ResolutionTasks, ResolutionTasksParams, first_stand
from knowledge_sources.verdicts import Verdicts


def room() -> Grid:
    """Return a grid of 4 by 4 m that is empty, but for a wall at x = 2 with a gap from y = 3 on."""
    grid = Grid(0.05)
    grid.cover(0.0, 0.0, 3.99, 3.99)
    grid.cells[:80, :80] = 0
    grid.cells[:60, 40] = 255
    return grid


class Story:
    """A doubter whose hypothesis is a trap at (1, 2), and the source of tasks, on one board."""

    def __init__(self, params: ResolutionTasksParams | None = None) -> None:
        self.board = Board(Vocabulary())
        self.doubter = Access(self.board, "doubter", (), (TRAP, VERDICT))
        self.source = ResolutionTasks(params or ResolutionTasksParams(), name="tasks")
        self.access = Access(self.board, "tasks", (VERDICT, ODOM_FROM_ROBOT, *self.source.reads), self.source.posts)
        self.verdicts = Verdicts("endorsements", needs=("handle",))
        self.entry: Entry[Any] = self.doubter.post(
            TRAP, Trap(trap="u-shape", place=Point(x_m=1.0, y_m=2.0), size_m=1.0), id="1"
        )
        for tile in room().take_changed():
            self.board.post(GRID, tile, id=tile_id(tile), source="grid")
        robot = RobotDescription(
            name="r", radius_m=0.2, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=1.0
        )
        self.board.post(ROBOT, robot, source="robot")

    def say(self, at_s: float, verdict: Any, about: str, strength: Any = "fair", **look: Any) -> None:
        self.board.now_s = at_s
        self.entry = self.doubter.endorse(self.entry, verdict, f"{about} {verdict}", about=about, strength=strength)
        self.verdicts.judge(self.doubter, self.entry, **look)
        self.source.activate(self.board.entries(VERDICT)[0], self.access)

    def wait(self, until_s: float) -> list[ResolutionTask]:
        self.board.now_s = until_s
        self.source.activate(self.board.post(ODOM_FROM_ROBOT, IDENTITY, source="odometry"), self.access)
        return [e.value for e in self.board.entries(RESOLUTION_TASK)]


def test_spawned_followed_and_confirmed() -> None:
    story = Story()
    story.say(0.0, "for", "body", look_from=Point(x_m=1.0, y_m=0.7))
    assert story.wait(1.0) == []  # it may resolve itself
    (task,) = story.wait(2.5)
    assert (task.outcome, task.todo, task.opened_s, task.until_s) == ("open", "look again", 2.5, 302.5)
    assert task.hypothesis == story.entry.key
    assert task.stand is not None
    assert abs(task.stand.x_m - 1.0) + abs(task.stand.y_m - 0.7) < 0.1
    story.say(4.0, "against", "handle")
    (entry,) = story.board.entries(RESOLUTION_TASK)
    said = [(e.verdict, e.about, e.why) for e in standing(entry.endorsements)]
    assert said == [("for", "doubter/body", "body for"), ("against", "doubter/handle", "handle against")]
    story.say(9.0, "for", "handle", "strong")
    (entry,) = story.board.entries(RESOLUTION_TASK)
    assert (entry.value.outcome, entry.value.closed_s) == ("confirmed", 9.0)
    assert [e.verdict for e in standing(entry.endorsements)] == ["for", "for"]
    assert len(entry.endorsements) == 3  # what stands no more is not lost
    assert story.wait(1000.0) == [entry.value]  # it stays as it ended
    assert story.board.at(entry.supports[0].key) is not None


def test_denied_by_a_verdict_that_is_taken_away_at_once() -> None:
    story = Story()
    story.say(0.0, "for", "body")
    story.wait(3.0)
    story.entry = story.doubter.endorse(story.entry, "against", "seen all round", about="handle", strength="strong")
    story.verdicts.judge(story.doubter, story.entry)
    verdict = story.board.entries(VERDICT)[0]
    story.verdicts.close(story.doubter, story.entry)
    story.doubter.retract(TRAP, "1")
    story.source.activate(verdict, story.access)
    (task,) = story.wait(4.0)
    assert task.outcome == "denied"


def test_given_up_after_the_stated_time_and_not_opened_again() -> None:
    story = Story(ResolutionTasksParams(give_up_s=20.0))
    story.say(0.0, "for", "body", wait_until_s=50.0)
    (task,) = story.wait(3.0)
    assert (task.todo, task.not_before_s, task.until_s) == ("wait and see", 50.0, 70.0)
    assert story.wait(69.0)[0].outcome == "open"
    (task,) = story.wait(70.0)
    assert (task.outcome, task.closed_s) == ("given up", 70.0)
    assert "lacking: handle" in task.detail
    assert story.wait(500.0) == [task]
    story.say(600.0, "for", "handle", "strong")  # the evidence came too late for the task, not for the hypothesis
    assert story.board.entries(VERDICT)[0].value.outcome == "confirmed"
    assert story.wait(601.0)[0].outcome == "given up"
    story.say(602.0, "against", "handle", "strong")
    story.say(603.0, "against", "handle", "weak")  # a doubt anew is a task anew
    assert [t.outcome for t in story.wait(606.0)] == ["given up", "open"]


def test_what_resolves_itself_is_no_task() -> None:
    story = Story()
    story.say(0.0, "for", "body")
    story.say(1.0, "for", "handle", "strong")
    assert story.wait(10.0) == []
    assert story.board.entries(CHANGE) == []


def test_closed_ones_leave_the_board_when_there_are_too_many() -> None:
    story = Story(ResolutionTasksParams(keep=2))
    for round_ in range(4):
        at_s = 100.0 * round_
        story.say(at_s, "against", "handle", "weak")
        story.wait(at_s + 5.0)
        story.say(at_s + 10.0, "for", "handle", "strong")
    assert [e.id for e in story.board.entries(RESOLUTION_TASK)] == ["3", "4"]
    gone = story.board.history.revisions(Support("ski/robot/motivations/resolution_task/1", 1, 99))
    assert (gone[-1].event, gone[-1].value.outcome) == ("retracted", "confirmed")


def test_one_stands_where_the_place_is_in_sight() -> None:
    grid, place = room(), Point(x_m=1.2, y_m=1.0)
    behind_the_wall, before_it = Point(x_m=2.8, y_m=1.0), Point(x_m=0.4, y_m=0.4)
    assert first_stand(grid, [behind_the_wall], place, 0.2, 0.3) is None
    stand = first_stand(grid, [behind_the_wall, before_it], place, 0.2, 0.3)
    assert stand is not None
    assert stand.x_m < 1.0
    assert first_stand(grid, [Point(x_m=9.0, y_m=9.0)], place, 0.2, 0.3) is None  # nothing is known there


def test_the_straight_way() -> None:
    grid = room()
    assert way_is_empty(grid, (0.5, 0.5), (1.5, 3.0), 0.2)
    assert not way_is_empty(grid, (0.5, 0.5), (3.5, 0.5), 0.2)  # through the wall
    assert way_is_empty(grid, (0.5, 3.5), (3.5, 3.5), 0.2)  # through its gap
    assert not way_is_empty(grid, (0.5, 3.1), (3.5, 3.1), 0.2)  # brushing its end
    assert not way_is_empty(grid, (0.5, 0.5), (1.75, 0.5), 0.3)  # room for a body at the end too
    assert not way_is_empty(grid, (1.0, 1.0), (1.0, 5.0), 0.1)  # into what is not known
    assert way_is_empty(grid, (1.0, 1.0), (1.0, 1.0), 0.0)
    assert np.array_equal(grid.cells, room().cells)
