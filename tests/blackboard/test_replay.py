"""A run read back from its journal gives the results of the run itself."""

from pathlib import Path

import numpy as np
import pytest

from blackboard.assembly import assemble
from blackboard.command.gather import gather
from blackboard.command.replay import ReplayedRun
from blackboard.entry import Entry
from blackboard.journal import FILE_NAME, JournalWriter
from blackboard.kinds import ROBOT_SUMMARY, TRUE_POSE
from blackboard.messages.geometry import Pose
from blackboard.messages.hosts import RobotSummary
from blackboard.mission import Mission, load_mission, shipped_missions
from blackboard.runner import Run


@pytest.fixture(scope="module")
def mission() -> Mission:
    return load_mission(shipped_missions()["wander-lab"])


@pytest.fixture(scope="module")
def run(mission: Mission, tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, Path]:
    folder = tmp_path_factory.mktemp("run")
    run = Run(mission)
    with JournalWriter(folder / FILE_NAME) as journal:
        run.board.journal = journal
        run.run(20.0)
        for stamp_s in (20.0, 20.5):  # what a host of the robot would post for the results
            key = run.board.key(TRUE_POSE)
            pose = Pose(x_m=stamp_s, y_m=1.0, heading_rad=0.0)
            entry = Entry(
                key=key,
                id=None,
                revision=int(stamp_s * 2),
                event="revised",
                stamp_s=stamp_s,
                source="robot",
                value=pose,
            )
            journal(entry, b'{"x_m":%f,"y_m":1.0,"heading_rad":0.0}' % stamp_s)
        summary = RobotSummary(figures='{"collisions":3,"battery":"low"}')
        told = Entry(
            key=run.board.key(ROBOT_SUMMARY),
            id=None,
            revision=1,
            event="posted",
            stamp_s=20.0,
            source="robot",
            value=summary,
        )
        journal(told, b'{"figures":"{\\"collisions\\":3,\\"battery\\":\\"low\\"}"}')
    run.close()
    return run, folder


def test_what_stood_at_the_end_stands_again(mission: Mission, run: tuple[Run, Path]) -> None:
    seen, folder = run
    replayed = ReplayedRun(assemble(mission))
    replayed.read(folder)
    assert replayed.passed_over == 0
    ours = {e.key: (e.revision, e.value) for e in seen.board.select("**/feature/**")}
    assert len(ours) > 3
    assert {e.key: (e.revision, e.value) for e in replayed.board.select("**/feature/**")} == ours
    np.testing.assert_allclose(replayed.trajectory(), seen.trajectory())


def test_truth_and_figures_come_from_what_the_robots_host_told(mission: Mission, run: tuple[Run, Path]) -> None:
    replayed = ReplayedRun(assemble(mission))
    replayed.read(run[1])
    truth = replayed.true_trajectory()
    assert truth is not None
    assert truth[:, :3].tolist() == [[20.0, 20.0, 1.0], [20.5, 20.5, 1.0]]
    assert replayed.robot.summary() == {"collisions": 3, "battery": "low"}
    table = gather(replayed, "wander").table
    assert table["collisions"] == 3
    assert table["lines"] == gather(run[0], "wander").table["lines"]


def test_other_robots_and_unknown_kinds_are_passed_over(
    mission: Mission, run: tuple[Run, Path], tmp_path: Path
) -> None:
    line = b'{"key":"ski/%s/%s","revision":1,"event":"posted","stamp_s":1.0,"source":"x","value":%s}\n'
    pose = b'{"x_m":1.0,"y_m":2.0,"heading_rad":0.0}'
    path = tmp_path / FILE_NAME
    path.write_bytes(line % (b"other", b"status/true_pose", pose) + line % (b"k2a", b"status/no_such_thing", pose))
    replayed = ReplayedRun(assemble(mission))
    replayed.read(path)
    assert replayed.true_trajectory() is None
    assert replayed.passed_over == 1
    assert len(replayed.board.select()) == 0


def test_progress_is_told_on_the_missions_clock(mission: Mission, run: tuple[Run, Path]) -> None:
    told: list[float] = []
    ReplayedRun(assemble(mission)).read(run[1], lambda elapsed_s, total_s: told.append(elapsed_s))
    assert told == sorted(told)
    assert len(told) == 4
