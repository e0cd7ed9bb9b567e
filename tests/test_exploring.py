"""Whole runs under rules: the robot explores to the end, says why, and its rules are edited while it runs."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from blackboard.command.gather import gather
from blackboard.journal import FILE_NAME, JournalWriter, read_journal
from blackboard.kinds import DRIVE, FACT, FIRING, MISSION, RULES
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run, RunOptions
from blackboard.why import Reason, Record
from rules.rule_files import shipped_rule_files

CHECKOUT = Path(__file__).resolve().parents[1]
FILES = ("arbitration", "explore", "traps", "recovery", "control")


@pytest.fixture(scope="module")
def explored(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Run, Path]]:
    """Return a run to its end, and its folder."""
    folder = tmp_path_factory.mktemp("explored")
    run = Run(load_mission(find_mission("explore-lab")), RunOptions(seed=2, strict=True))
    with JournalWriter(folder / FILE_NAME) as journal:
        run.board.journal = journal
        run.run()
    yield run, folder
    run.close()


def test_the_lab_is_explored_to_the_end(explored: tuple[Run, Path]) -> None:
    run, _ = explored
    status = run.board.newest(MISSION)
    assert status is not None
    assert status.value.state == "done"
    table = gather(run, "explore-lab").table
    assert table["collisions"] == 0
    assert float(table["reachable_decided_fraction"]) >= 0.95
    assert float(table["time_s"]) <= 1200.0


def test_why_goes_from_the_wheels_through_rules_to_readings(explored: tuple[Run, Path]) -> None:
    _, folder = explored
    record = Record(read_journal(folder))
    gone = [
        line
        for line in read_journal(folder)
        if "/motivation/path_following" in line.key and b'"on":true' in bytes(line.value)
    ]
    drive = record.find("commands/drive", at_s=gone[0].stamp_s + 1.0)
    keys = set(_keys(record.explain(drive, depth=20)))
    for part in ("commands/velocity", "response/path_following", "motivation/path_following", "firing/goal-asks-for-path",
                 "firing/nearest-target-go", "symbol/target/", "signal/sonar_scan", "signal/odometry"):  # fmt: skip
        assert any(part in key for key in keys), part


def _keys(reason: Reason) -> Iterator[str]:
    yield reason.support.key
    for inner in reason.reasons:
        yield from _keys(inner)


def test_the_hash_seed_does_not_matter_to_rules(tmp_path: Path) -> None:
    for hash_seed in ("1", "77"):
        environment = {**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONPATH": str(CHECKOUT)}
        done = subprocess.run(
            [sys.executable, "-m", "blackboard.command.main", "run", "explore-lab", "--duration", "130", "--out", hash_seed],
            cwd=tmp_path, env=environment, capture_output=True, text=True, check=False, timeout=100,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
    one, other = ((tmp_path / seed / "board.jsonl").read_bytes() for seed in ("1", "77"))
    assert one == other
    assert b"/motivation/path_following" in one  # it has come to choosing targets


def copied(folder: Path) -> list[Path]:
    """Return copies of the rule files that explore-lab uses, to be edited."""
    paths = []
    for name in FILES:
        paths.append(folder / f"{name}.clp")
        paths[-1].write_text(shipped_rule_files()[name].read_text(encoding="utf-8"), encoding="utf-8")
    return paths


def started(paths: list[Path]) -> Run:
    settings = {"rules": {"files": [str(path) for path in paths]}}
    return Run(load_mission(find_mission("explore-lab"), settings), RunOptions(seed=2, strict=True))


def lasting_facts(run: Run) -> set[str]:
    """Return what rules have asserted, but for candidates, which come and go with the map."""
    return {entry.value.fact for entry in run.board.entries(FACT) if entry.value.relation != "candidate"}


def test_rules_are_edited_under_way(tmp_path: Path) -> None:
    paths = copied(tmp_path)
    run = started(paths)
    drives: list[float] = []
    run.board.subscribe(run.board.key(DRIVE), lambda entry: drives.append(entry.stamp_s))
    for _ in range(200):
        run.cycle()
    before = lasting_facts(run)
    fired = {entry.id: entry.revision for entry in run.board.entries(FIRING)}
    explore = paths[FILES.index("explore")]
    text = explore.read_text(encoding="utf-8")
    assert any("(mode wander)" in fact for fact in before)

    explore.write_text(
        text + "\n(defrule broken (mode wander) => (behaviour-select random_wonder on))", encoding="utf-8"
    )
    for _ in range(20):
        run.cycle()
    rules = run.board.newest(RULES)
    assert rules is not None
    assert "did you mean 'random_wander'?" in rules.value.refused
    assert lasting_facts(run) == before

    explore.write_text(
        text + '\n(defrule hurry (mode wander) => (assert (hurried)) (printout t "quick" crlf))', encoding="utf-8"
    )
    for _ in range(20):
        run.cycle()
    rules = run.board.newest(RULES)
    assert rules is not None
    assert rules.value.refused == ""
    assert lasting_facts(run) == before | {"(hurried)"}
    hurry = run.board.newest(FIRING, "hurry")
    assert hurry is not None
    assert hurry.value.said == "quick\n"
    again = {entry.id: entry.revision for entry in run.board.entries(FIRING) if entry.id in fired}
    assert again["mode-asks-for-behaviour"] == fired["mode-asks-for-behaviour"]  # nothing fires anew on what stood
    assert len(drives) == 240  # the reflexes answered in every cycle
    assert len(set(drives)) == 240
    run.close()
