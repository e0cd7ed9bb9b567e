"""The graph of what was seen: by hand, and of a run beside what its mission declares."""

import json
from pathlib import Path

import pytest

from blackboard.command.main import main
from blackboard.errors import BoardError
from blackboard.journal import FILE_NAME, JournalWriter, read_journal
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run
from blackboard.watching.declared_graph import declared_graph
from blackboard.watching.observed_graph import observed_graph, path_of

SCAN, POSE = "observations/signal/sonar_scan", "observations/feature/odom_from_robot"


def line(path: str, source: str, *supports: str, robot: str = "k2a", value: object = None) -> str:
    return json.dumps(
        {
            "key": f"ski/{robot}/{path}",
            "revision": 1,
            "event": "posted",
            "stamp_s": 0.0,
            "source": source,
            "value": value or {},
            "supports": [{"key": f"ski/{robot}/{support}", "first": 1, "last": 1} for support in supports],
        }
    )


def journal(folder: Path, *lines: str) -> Path:
    (folder / FILE_NAME).write_text("\n".join(lines) + "\n")
    return folder


ACTIVATION = {
    "source": "pose", "trigger_key": f"ski/k2a/{SCAN}", "trigger_revision": 1, "rating": 0, "work": 1, "outcome": "done",
}  # fmt: skip
HOST = {"state": "alive", "boot": "b", "components": ["pose"]}


def test_roles_and_reads_by_what_was_posted(tmp_path: Path) -> None:
    lines = [
        line(SCAN, "k2a"),
        line("control/activation/pose", "control", SCAN, value=ACTIVATION),
        line(POSE, "pose", SCAN, "hypotheses/feature/grid/0_0"),
        line("commands/response/avoid", "avoid", SCAN),
        line("commands/velocity", "sum", "commands/response/avoid"),
        line("commands/drive", "safety", "commands/velocity"),
        line("control/rules", "planner"),
        line("status/host/maps", "keeper", value=HOST),
        line("motivations/motivation/avoid", "operator"),
    ]
    graph = observed_graph("seen", read_journal(journal(tmp_path, *lines)), {"pose": "maps"})
    assert {one.name: one.role for one in graph.members} == {
        "k2a": "robot", "pose": "knowledge source", "operator": "knowledge source", "planner": "rules",
        "avoid": "behaviour", "sum": "coordinator", "safety": "safety layer", "control": "control", "keeper": "keeper",
    }  # fmt: skip
    pose = next(one for one in graph.members if one.name == "pose")
    assert (pose.woken_by, pose.reads, pose.posts, pose.host) == (
        (SCAN,),
        ("hypotheses/feature/grid",),
        (POSE,),
        "maps",
    )
    assert graph.readers(SCAN) == ["avoid"]  # control only names what woke others


def test_nothing_to_draw() -> None:
    with pytest.raises(BoardError, match="nothing stands there"):
        observed_graph("x", [])


def test_paths() -> None:
    assert path_of("ski/k2a/hypotheses/feature/grid/0_0") == "hypotheses/feature/grid"
    assert path_of("ski/k2a/commands/response/avoid") == "commands/response"
    assert path_of("ski/k2a/commands/drive") == "commands/drive"


def test_what_is_seen_in_a_run_was_declared(tmp_path: Path) -> None:
    mission = load_mission(find_mission("explore-lab"))
    declared = {one.name: one for one in declared_graph(mission).members}
    run = Run(mission)
    with JournalWriter(tmp_path / FILE_NAME) as writer:
        run.board.journal = writer
        run.run(20.0)
    run.close()
    seen = observed_graph("run", read_journal(tmp_path))
    assert len(seen.members) > 15
    for one in seen.members:
        known = declared[one.name]
        assert one.role == known.role
        assert set(one.posts) <= set(known.posts), one.name
        assert set(one.woken_by) <= set(known.woken_by), one.name
        if one.role != "rules":  # these also name facts and firings of their own
            assert set(one.reads) <= {*known.reads, *known.woken_by, *known.posts}, one.name


def test_the_verb_on_a_record(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    journal(tmp_path, line(SCAN, "k2a"), line("status/host/maps", "keeper", value=HOST), line(POSE, "pose", SCAN))
    assert main(["graph", "--in", str(tmp_path), "--by", "component"]) == 0
    assert (
        "knowledge sources\n  pose on maps\n    reads      observations/signal/sonar_scan\n" in capsys.readouterr().out
    )
    journal(tmp_path, line(SCAN, "a", robot="a"), line(SCAN, "b", robot="b"))
    assert main(["graph", "--in", str(tmp_path)]) == 2
    assert "has the boards of a, b; choose one with --on ROBOT" in capsys.readouterr().err
    assert main(["graph", "--in", str(tmp_path), "--on", "b", "--json"]) == 0
    assert list(json.loads(capsys.readouterr().out)["members"]) == ["b"]
    assert main(["graph", "explore-lab", "--in", str(tmp_path)]) == 2
    assert "not both" in capsys.readouterr().err
