"""The model of lines on a board: what joins it, what is asked about first, what leaves it."""

from math import cos, hypot, pi
from typing import Any

import numpy as np
import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import KnowledgeSource
from blackboard.control import Control
from blackboard.entry import Entry
from blackboard.kinds import (
    EXPECTED_LINES,
    LINE,
    LINE_MATCHES,
    LINE_SET,
    MODEL_LINE,
    NEW_AREA_VISITED,
    SUPPORTED_POINTS,
    VERDICT,
)
from blackboard.messages.geometry import Point, pack_array
from blackboard.messages.model import ExpectedLines, LineSet, ModelLine, NewAreaVisited
from blackboard.messages.world import Line, PointSet
from blackboard.uncertainty.theories import THEORIES, Theory
from blackboard.vocabulary import Vocabulary
from knowledge_sources.match_merge import MatchMerge
from knowledge_sources.match_merge_params import MatchMergeParams

Ends = tuple[float, float, float, float]
LEVEL: Ends = (0.0, 2.0, 3.0, 2.0)
STEEP: Ends = (4.0, -1.0, 4.0, 1.0)


class Bench:
    """A board on which lines are posted batch by batch, as the line finder does."""

    def __init__(self, params: MatchMergeParams | None = None) -> None:
        self.board = Board(Vocabulary(), robot="k2a")
        source: KnowledgeSource[MatchMergeParams] = MatchMerge(
            params or MatchMergeParams(wait_for_re_reference=False), name="match_merge"
        )
        self.control = Control(self.board, [source], strict=True)
        self.batches = 0
        self.posted: list[Entry[Any]] = []
        self.board.subscribe("ski/k2a/hypotheses/**", self.posted.append)

    def see(self, *lines: Ends, robot: tuple[float, float] = (0.0, 0.0), expect: tuple[str, ...] = ()) -> None:
        """Let the robot see these lines from a place, having expected others from three places before."""
        self.batches += 1
        self.board.now_s += 10.0
        for _ in range(3):
            views = ExpectedLines(model=expect, new_areas=())
            self.board.post(EXPECTED_LINES, views, source="expected_lines")
        places = np.array([((a + c) / 2, (b + d) / 2) for a, b, c, d in lines], dtype=np.float32).reshape(-1, 2)
        points = PointSet(
            points=pack_array(places),
            sensed_from=pack_array(np.full_like(places, robot)),
            half_cone_rad=pack_array(np.zeros(len(places), dtype=np.float32)),
        )
        batch = self.board.post(SUPPORTED_POINTS, points, source="filter_raw")
        ids = []
        for n, (a, b, c, d) in enumerate(lines):
            ids.append(f"{self.batches}-{n}")
            line = Line(
                start=Point(x_m=a, y_m=b),
                end=Point(x_m=c, y_m=d),
                alpha_rad=0.0,  # not read: ends say it all
                rho_m=0.0,
                sigma_rho_m=0.02,
                support=30,
            )
            self.board.post(LINE, line, id=ids[-1], source="line_finder", supports=(batch.as_support(),))
        value = LineSet(batch=batch.revision, lines=tuple(ids))
        self.board.post(LINE_SET, value, source="line_finder", supports=(batch.as_support(),))
        self.control.run_cycle()

    @property
    def model(self) -> dict[str, ModelLine]:
        return {str(entry.id): entry.value for entry in self.board.entries(MODEL_LINE)}

    @property
    def new_areas(self) -> dict[str, NewAreaVisited]:
        return {str(entry.id): entry.value for entry in self.board.entries(NEW_AREA_VISITED)}


def test_the_first_lines_are_the_model() -> None:
    bench = Bench()
    bench.see(LEVEL, STEEP)
    assert list(bench.model) == ["1", "2"]
    assert bench.new_areas == {}
    assert [line.faces_left for line in bench.model.values()] == [False, True]


def test_a_line_seen_again_is_merged_and_surer() -> None:
    bench = Bench()
    bench.see(LEVEL)
    before = bench.model["1"]
    bench.see((4.0, 2.01, 1.0, 2.01))  # from the other end, and longer
    after = bench.model["1"]
    assert list(bench.model) == ["1"]
    assert after.observations == 2
    assert after.sigma_rho_m <= before.sigma_rho_m
    assert (after.start.x_m, after.end.x_m) == pytest.approx((0.0, 4.0), abs=0.01)
    matches = bench.board.newest(LINE_MATCHES)
    assert matches is not None
    assert [(m.observed, m.model) for m in matches.value.matches] == [("2-0", "1")]
    entry = bench.board.newest(MODEL_LINE, "1")
    assert entry is not None
    assert [(s.key, s.first, s.last) for s in entry.supports] == [(bench.board.key(LINE_SET), 1, 2)]


def test_what_matches_nothing_is_asked_about_and_confirmed_from_elsewhere() -> None:
    bench = Bench()
    bench.see(LEVEL)
    bench.see(LEVEL, STEEP)
    assert list(bench.model) == ["1"]
    assert list(bench.new_areas) == ["2"]
    bench.see(LEVEL, STEEP, robot=(0.1, 0.0))  # nearly the same place proves nothing
    assert list(bench.new_areas) == ["2"]
    bench.see(LEVEL, STEEP, robot=(0.6, 0.0))
    assert bench.new_areas == {}
    assert bench.model["2"].observations == 3
    last = [e for e in bench.posted if "new_area_visited" in e.key][-1]
    said = [(e.about, e.verdict) for e in last.endorsements]
    assert (last.event, said) == ("retracted", [("seen", "for"), ("elsewhere", "for")])
    confirmed = bench.board.newest(MODEL_LINE, "2")
    assert confirmed is not None
    assert confirmed.supports[0].key == bench.board.key(NEW_AREA_VISITED, "2")


def test_what_is_not_seen_again_is_denied_with_reasons() -> None:
    bench = Bench(MatchMergeParams(wait_for_re_reference=False, misses_of_new=4))
    bench.see(LEVEL)
    bench.see(LEVEL, STEEP)
    for _ in range(4):
        assert list(bench.new_areas) == ["2"]
        bench.see(LEVEL, expect=("2",))
    assert bench.new_areas == {}
    last = [e for e in bench.posted if "new_area_visited" in e.key][-1]
    assert last.event == "retracted"
    assert [(e.who, e.about, e.verdict) for e in last.endorsements] == [
        ("match_merge", "seen", "for"),
        ("match_merge", "missing", "against"),
        ("match_merge", "missing", "against"),
    ]
    assert "not seen in 4" in last.endorsements[-1].why


@pytest.mark.parametrize("theory", THEORIES)
def test_new_areas_by_every_theory(theory: Theory) -> None:
    bench = Bench(MatchMergeParams(wait_for_re_reference=False, theory=theory))
    bench.see(LEVEL)
    bench.see(LEVEL, STEEP, (0.0, 6.0, 3.0, 6.0))
    outcomes = [(e.id, e.value.outcome, e.value.lacking) for e in bench.board.entries(VERDICT)]
    assert outcomes == [(f"new_area_visited.{i}", "unresolved", ("elsewhere",)) for i in (2, 3)]
    for _ in range(4):
        bench.see(LEVEL, STEEP, robot=(0.6, 0.0), expect=("3",))
    assert list(bench.model) == ["1", "2"]
    assert bench.new_areas == {}
    assert bench.board.entries(VERDICT) == []


@pytest.mark.parametrize("theory", THEORIES)
def test_others_have_a_say(theory: Theory) -> None:
    """A new line waits while somebody doubts it, and a known one goes when somebody knows better."""
    bench = Bench(MatchMergeParams(wait_for_re_reference=False, theory=theory))
    bench.see(LEVEL)
    bench.see(LEVEL, STEEP)
    other = Access(bench.board, "other", (), ())
    other.endorse(bench.board.entries(NEW_AREA_VISITED)[0], "against", "somebody stands there", about="change")
    bench.see(LEVEL, STEEP, robot=(0.6, 0.0))
    bench.see(LEVEL, STEEP, robot=(1.2, 0.0))
    assert list(bench.new_areas) == ["2"]
    other.withdraw(bench.board.entries(NEW_AREA_VISITED)[0], "change", "it is a cupboard")
    bench.see(LEVEL, STEEP)
    assert list(bench.model) == ["1", "2"]
    entry = bench.board.newest(MODEL_LINE, "2")
    assert entry is not None
    other.endorse(entry, "against", "the grid is empty there", about="grid", strength="strong")
    bench.see(LEVEL, STEEP, expect=("1",))
    assert list(bench.model) == ["1", "2"]  # not while it is seen
    bench.see(LEVEL, expect=("1",))
    assert list(bench.model) == ["1"]


def test_a_model_line_that_has_gone_is_taken_back() -> None:
    bench = Bench(MatchMergeParams(wait_for_re_reference=False, misses=6))
    bench.see(LEVEL, STEEP)
    for _ in range(5):
        bench.see(LEVEL, expect=("1", "2"))
    assert list(bench.model) == ["1", "2"]
    bench.see(LEVEL, STEEP, expect=("1", "2"))  # seen after all: counting begins anew
    for _ in range(6):
        bench.see(LEVEL, expect=("1", "2"))
    assert list(bench.model) == ["1"]


def test_where_nothing_known_is_seen_no_line_is_blamed() -> None:
    bench = Bench(MatchMergeParams(wait_for_re_reference=False, misses=2))
    bench.see(LEVEL, STEEP)
    for _ in range(5):
        bench.see((-8.0, -8.0, -6.0, -8.0), expect=("1", "2"))
    assert {"1", "2"} <= set(bench.model)


def test_the_other_side_of_a_wall_is_another_line() -> None:
    bench = Bench()
    bench.see(LEVEL)
    bench.see((0.0, 2.05, 3.0, 2.05), robot=(1.0, 4.0))
    bench.see((0.0, 2.05, 3.0, 2.05), robot=(2.0, 4.0))
    assert [line.faces_left for line in bench.model.values()] == [False, True]


@pytest.mark.parametrize("turn", [0.6, pi / 2, 3.0])
def test_the_model_turns_with_the_world(turn: float) -> None:
    def turned(x: float, y: float) -> tuple[float, float]:
        return float(cos(turn) * x - np.sin(turn) * y), float(np.sin(turn) * x + cos(turn) * y)

    sights = [LEVEL, STEEP], [(0.5, 2.02, 3.5, 2.02), STEEP], [(1.0, 1.99, 2.5, 2.0)]
    here, there = Bench(), Bench()
    for i, lines in enumerate(sights):
        here.see(*lines, robot=(0.3 * i, 0.0))
        there.see(*[(*turned(a, b), *turned(c, d)) for a, b, c, d in lines], robot=turned(0.3 * i, 0.0))
    assert list(here.model) == list(there.model)
    for id_, line in here.model.items():
        start = turned(line.start.x_m, line.start.y_m)
        moved = there.model[id_]
        assert hypot(moved.start.x_m - start[0], moved.start.y_m - start[1]) == pytest.approx(0.0, abs=1e-6)
        assert moved.sigma_rho_m == pytest.approx(line.sigma_rho_m)
        assert moved.faces_left is line.faces_left
