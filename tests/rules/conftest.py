"""A board with one planning module on it, for tests of rules."""

from collections.abc import Callable
from pathlib import Path

import pytest

from blackboard.board import Board
from blackboard.checkpoint import dumped, loaded
from blackboard.component import Parts
from blackboard.entry import Entry
from blackboard.kinds import BEHAVIOUR, FACT, FIRING, MOTIVATION, TARGET
from blackboard.messages.control import Firing
from blackboard.messages.geometry import Point
from blackboard.messages.motion import BehaviourStatus, Motivation
from blackboard.messages.symbols import Target
from blackboard.planning import Planning
from blackboard.vocabulary import Vocabulary
from rules.planning import PlanningModule, PlanningParams

VOCABULARY = Vocabulary()
PARTS = Parts(
    behaviours={"target_nav": (("x_m", "y_m"), 0), "random_wander": ((), 0)},
    levels=["explore"],
    sources={"line_finder": 10.0},
    vocabulary=VOCABULARY,
    owners={TARGET.path: "frontier_targets"},
)


class Bench:
    """A board with one planning module on it, and a clock that is moved by hand."""

    def __init__(self, folder: Path, *texts: str, parts: Parts = PARTS, **params: object) -> None:
        self.paths = [folder / f"rules{i}.clp" for i in range(len(texts))]
        for path, text in zip(self.paths, texts, strict=True):
            path.write_text(text, encoding="utf-8")
        self._parts = parts
        self._params = PlanningParams(files=tuple(self.paths), **params)  # type: ignore[arg-type]
        self._start()

    def _start(self) -> None:
        self.board = Board(VOCABULARY, robot="k2a")
        module = PlanningModule(self._params, name="rules")
        self.planning = Planning(self.board, module, self._parts, strict=True)

    def kept(self) -> bytes:
        """Return what a checkpoint would keep now."""
        return dumped(self.planning.states())

    def restart(self, kept: bytes | None) -> None:
        """Let another process take the place of this one, with what was kept and what stands."""
        before = self.board
        self._start()
        self.board.load(before.select())
        self.board.now_s = before.now_s
        states = loaded(kept, VOCABULARY) if kept is not None else {}
        assert isinstance(states, dict)
        self.planning.resume(states)

    def cycle(self, seconds: float = 0.1) -> None:
        """Let a control cycle pass."""
        self.board.now_s += seconds
        self.planning.decide()

    def target(self, name: str, x_m: float = 1.0) -> Entry[Target]:
        place = Point(x_m=x_m, y_m=0.0)
        value = Target(place=place, stand=place, reason="line end", size_m=1.0)
        return self.board.post(TARGET, value, id=name, source="frontier_targets")

    def facts(self) -> list[str]:
        """Return what rules have asserted and nobody has retracted."""
        return [entry.value.fact for entry in self.board.entries(FACT)]

    def firings(self) -> list[str]:
        return [entry.value.rule for entry in sorted(self.board.entries(FIRING), key=lambda e: e.value.number)]

    def firing(self, rule: str) -> Entry[Firing]:
        entry = self.board.newest(FIRING, rule)
        assert entry is not None
        return entry

    def acknowledge(self, behaviour: str, number: int) -> None:
        status = BehaviourStatus(state="active", acknowledged=number)
        self.board.post(BEHAVIOUR, status, id=behaviour, source=behaviour)

    def motivation(self, behaviour: str) -> Motivation | None:
        entry = self.board.newest(MOTIVATION, behaviour)
        return entry.value if entry is not None else None


@pytest.fixture
def bench_of(tmp_path: Path) -> Callable[..., Bench]:
    """Return what makes a bench out of the texts of its rule files; `parts` and the planning module's parameters by name."""

    def make(*texts: str, **params: object) -> Bench:
        return Bench(tmp_path, *texts, **params)  # type: ignore[arg-type]

    return make


@pytest.fixture
def parts() -> Parts:
    """What the mission of a bench has, unless another is given."""
    return PARTS
