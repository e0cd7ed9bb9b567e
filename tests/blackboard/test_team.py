"""Several robots of one mission in lock-step: boards that do not mix, one time, and an end when all are at theirs."""

from pathlib import Path

import pytest

from blackboard.journal import JournalWriter, read_journal
from blackboard.members import member
from blackboard.mission import Mission, find_mission, load_mission
from blackboard.runner import Run, RunOptions
from blackboard.team import Team

ROOMS = """
[floor]
outline = [[0, 0], [10, 0], [10, 5], [0, 5], [0, 0]]

[[wall]]
line = [[5, 0], [5, 5]]
thickness_m = 0.2
"""


def team(mission: Mission, folder: Path, duration_s: float, seed: int = 5) -> Team:
    """Run a mission of several robots with the journal of each in a file named after it."""
    made = Team(mission, RunOptions(seed=seed, strict=True))
    writers = []
    for name, run in made.runs.items():
        (folder / name).mkdir(parents=True)
        writers.append(JournalWriter(folder / name / "board.jsonl"))
        run.board.journal = writers[-1]
    made.run(duration_s)
    for writer in writers:
        writer.__exit__(None, None, None)
    return made


@pytest.fixture(scope="module")
def pair() -> Mission:
    return load_mission(find_mission("explore-lab-pair"))


@pytest.fixture(scope="module")
def run(pair: Mission, tmp_path_factory: pytest.TempPathFactory) -> tuple[Team, Path]:
    folder = tmp_path_factory.mktemp("run")
    return team(pair, folder, 20.0), folder


def test_boards_do_not_mix(run: tuple[Team, Path]) -> None:
    for name, board in ((name, its.board) for name, its in run[0].runs.items()):
        prefix = f"ski/{name}/"
        assert board.robot == name
        lines = list(read_journal(run[1] / name))
        assert len(lines) > 1000
        for line in lines:
            assert line.key.startswith(prefix)
            assert all(support.key.startswith(prefix) for support in line.supports)
        assert all(entry.key.startswith(prefix) for entry in board.select())


def test_time_is_the_same_on_all_boards(run: tuple[Team, Path]) -> None:
    east, west = run[0].runs.values()
    assert east.board.now_s == west.board.now_s == pytest.approx(20.0)
    ends = [its.true_trajectory() for its in (east, west)]
    assert ends[0] is not None
    assert ends[1] is not None
    assert ends[0][:, 0].tolist() == ends[1][:, 0].tolist()
    assert ends[0][-1, 1:3].tolist() != ends[1][-1, 1:3].tolist()


def test_same_seed_same_bytes_other_seed_others(pair: Mission, run: tuple[Team, Path], tmp_path: Path) -> None:
    team(pair, tmp_path / "again", 20.0)
    team(pair, tmp_path / "other", 20.0, seed=6)
    for name in ("east", "west"):
        once = (run[1] / name / "board.jsonl").read_bytes()
        assert once == (tmp_path / "again" / name / "board.jsonl").read_bytes()
        assert once != (tmp_path / "other" / name / "board.jsonl").read_bytes()


def test_who_meets_nobody_does_as_if_alone(tmp_path: Path) -> None:
    (tmp_path / "rooms.toml").write_text(ROOMS)
    shipped = find_mission("explore-lab-pair").read_text()
    text = shipped.replace('"lab"', '"rooms.toml"').replace("5.2", "7.5").replace("2.8", "2.5")
    (tmp_path / "rooms-pair.toml").write_text(text)
    mission = load_mission(tmp_path / "rooms-pair.toml")
    team(mission, tmp_path / "two", 20.0)
    for name in ("east", "west"):
        alone = Run(member(mission, name), RunOptions(seed=5, strict=True))
        with JournalWriter(tmp_path / f"{name}.jsonl") as journal:
            alone.board.journal = journal
            alone.run(20.0)
        assert (tmp_path / "two" / name / "board.jsonl").read_bytes() == (tmp_path / f"{name}.jsonl").read_bytes()


ENDER = """
from blackboard.component import KnowledgeSource
from blackboard.kinds import MISSION, ODOMETRY
from blackboard.messages.motion import MissionStatus


class Ender(KnowledgeSource):
    triggers = (ODOMETRY,)
    posts = (MISSION,)

    def activate(self, trigger, board):
        if trigger.revision == 1:
            self.last = int(self.rng.integers(10, 60))
        if trigger.revision == self.last:
            board.post(MISSION, MissionStatus(state="done"), supports=[trigger])
"""


def test_it_goes_on_until_all_are_at_their_end(pair: Mission, tmp_path: Path) -> None:
    (tmp_path / "ender.py").write_text(ENDER)
    robots = pair.path.read_text().partition("[rules]")[0]
    (tmp_path / "ends.toml").write_text(f'{robots}[[knowledge_source]]\nuse = "ender.py:Ender"\n')
    made = Team(load_mission(tmp_path / "ends.toml"), RunOptions(seed=1, strict=True))
    made.run(100.0)
    ends = sorted(run.board.select("ski/*/status/mission")[0].stamp_s for run in made.runs.values())
    assert ends[0] < ends[1] < 100.0
    assert [run.board.now_s for run in made.runs.values()] == pytest.approx([ends[1]] * 2)


def test_they_keep_out_of_each_others_way(run: tuple[Team, Path]) -> None:
    for its in run[0].runs.values():
        table = its.robot.summary()
        assert float(table["distance_m"]) > 1.0
        assert (table["collisions"], table["touched_by_others"], table["met_robots"]) == (0, 0, 0)
