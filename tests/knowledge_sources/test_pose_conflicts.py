"""A refused jump is denied by a batch that fits, confirmed by batches that ask for the same, and a task follows it."""

import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import KnowledgeSource
from blackboard.control import Control
from blackboard.kinds import MAP_FROM_ODOM, ODOM_FROM_ROBOT, POSE_CONFLICT, RE_REFERENCE, RESOLUTION_TASK, VERDICT
from blackboard.messages.geometry import IDENTITY, Point
from blackboard.messages.model import PoseConflict, ReReference
from blackboard.uncertainty.endorsements import standing
from blackboard.uncertainty.theories import THEORIES, Theory
from blackboard.vocabulary import Vocabulary
from knowledge_sources.pose_conflicts import PoseConflicts, PoseConflictsParams
from knowledge_sources.resolution_tasks import ResolutionTasks, ResolutionTasksParams


class Bench:
    """A board on which batches are re-referenced one after another, 3 s apart."""

    def __init__(self, theory: Theory = "endorsements") -> None:
        self.board = Board(Vocabulary())
        self.lines = Access(self.board, "re_reference", (), (RE_REFERENCE, POSE_CONFLICT, MAP_FROM_ODOM))
        sources: list[KnowledgeSource[object]] = [
            PoseConflicts(PoseConflictsParams(theory=theory), name="pose_conflicts"),  # type: ignore[list-item]
            ResolutionTasks(ResolutionTasksParams(), name="resolution_tasks"),  # type: ignore[list-item]
        ]
        self.control = Control(self.board, sources, strict=True)
        self.batch = 0

    def see(self, applied: bool, x: float = 0.0, turn: float = 0.0, lines: tuple[str, ...] = ("a", "b")) -> None:
        self.batch += 1
        self.board.now_s += 3.0
        self.board.post(ODOM_FROM_ROBOT, IDENTITY, source="odometry")
        value = ReReference(
            batch=self.batch,
            applied=applied,
            centre=Point(x_m=1.0, y_m=2.0),
            shift=Point(x_m=x, y_m=0.0),
            turn_rad=turn,
            normal_distance=1.0 if applied else 99.0,
            bound=11.0,
            lines=lines,
        )
        if not applied:
            self.lines.post(POSE_CONFLICT, PoseConflict(refused=value, why="too large"), id=str(self.batch))
        self.lines.post(RE_REFERENCE, value)
        self.control.run_cycle()

    def outcomes(self) -> dict[str, str]:
        return {str(e.id): e.value.outcome for e in self.board.entries(VERDICT)}

    def tasks(self) -> list[str]:
        return [e.value.outcome for e in self.board.entries(RESOLUTION_TASK)]


@pytest.mark.parametrize("theory", THEORIES)
def test_a_batch_that_fits_denies_it(theory: Theory) -> None:
    bench = Bench(theory)
    bench.see(True)
    bench.see(False, 1.0)
    assert bench.outcomes() == {"pose_conflict.2": "unresolved"}
    bench.see(True, lines=())  # a batch without lines says nothing
    assert bench.outcomes() == {"pose_conflict.2": "unresolved"}
    assert bench.tasks() == ["open"]
    bench.see(True, 0.05)
    assert bench.outcomes() == {"pose_conflict.2": "denied"}
    assert bench.tasks() == ["denied"]
    (conflict,) = bench.board.entries(POSE_CONFLICT)
    said = [(e.about, e.verdict) for e in standing(conflict.endorsements)]
    assert said == [("bound", "against"), ("lines", "for"), ("later", "against")]
    bench.see(True)
    assert bench.board.entries(POSE_CONFLICT)[0].revision == conflict.revision  # all is said


@pytest.mark.parametrize("theory", THEORIES)
def test_batches_that_ask_for_the_same_confirm_it(theory: Theory) -> None:
    bench = Bench(theory)
    bench.see(False, 1.0, 0.02)
    bench.see(False, -0.5)  # another jump
    bench.see(False, 1.1, 0.0)
    assert set(bench.outcomes().values()) == {"unresolved"}
    bench.see(False, 0.9, 0.05)
    assert bench.outcomes()["pose_conflict.1"] == "confirmed"
    assert bench.outcomes()["pose_conflict.2"] == "unresolved"
    assert bench.tasks()[0] == "confirmed"
    place = bench.board.entries(VERDICT)[0].value.place
    assert place == Point(x_m=1.0, y_m=2.0)
