"""Whole runs through the command line: the main job's results, determinism, and what a user may get wrong."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from blackboard.command.main import main
from blackboard.journal import read_journal

SKI = (sys.executable, "-m", "blackboard.command.main")
CHECKOUT = Path(__file__).resolve().parents[1]


def ski(*arguments: str, hash_seed: str = "0", cwd: Path = CHECKOUT) -> "subprocess.CompletedProcess[str]":
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONPATH": str(CHECKOUT)}
    return subprocess.run(
        [*SKI, *arguments], cwd=cwd, env=environment, capture_output=True, text=True, check=False, timeout=100
    )


def test_same_seed_same_bytes_whatever_the_hash_seed(tmp_path: Path) -> None:
    for name, seed, hash_seed in (("a", "3", "1"), ("b", "3", "4242"), ("c", "4", "1")):
        done = ski(
            "run", "wander-lab", "--seed", seed, "--duration", "60", "--set", "robot.people=true",
            "--out", str(tmp_path / name), hash_seed=hash_seed,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
    a, b, c = ((tmp_path / name / "board.jsonl").read_bytes() for name in "abc")
    assert len(a) > 100_000
    assert a == b
    assert a != c
    for file in ("grid.png", "map.pgm", "lines.geojson", "trajectory.tum", "overview.png", "figures.png"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes(), file


@pytest.fixture(scope="module")
def explored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("explored") / "lab"
    done = ski("run", "wander-lab", "--duration", "120", "--out", str(folder), "--json")
    assert done.returncode == 0, done.stderr
    (folder.parent / "table.json").write_text(done.stdout)
    return folder


def test_the_main_job_leaves_its_results(explored: Path) -> None:
    table = json.loads((explored.parent / "table.json").read_text())
    assert table["collisions"] == 0
    assert table["path_m"] > 5
    for file in ("board.jsonl", "grid.png", "lines.geojson", "map.pgm", "map.yaml", "overview.png", "trajectory.tum"):
        assert (explored / file).stat().st_size > 0
    assert len(json.loads((explored / "lines.geojson").read_text())["features"]) == table["lines"] > 3


def test_every_post_is_in_the_record_once_and_supports_exist(explored: Path) -> None:
    seen: dict[str, int] = {}
    for line in read_journal(explored):
        assert line.revision == seen.get(line.key, 0) + 1
        seen[line.key] = line.revision
        for support in line.supports:
            assert support.first <= support.last <= seen.get(support.key, 0), f"{line.key} stands on {support}"
    kinds = {"/".join(key.split("/")[2:4]) for key in seen}
    assert kinds >= {
        "observations/signal",
        "observations/feature",
        "hypotheses/feature",
        "commands/drive",
        "control/activation",
    }
    assert not [key for key in seen if "activation_time" in key]


def test_why_goes_down_to_the_readings(explored: Path) -> None:
    done = ski("why", "commands/drive", "--in", str(explored))
    assert "commands/velocity" in done.stdout
    assert "observations/signal/sonar_scan" in done.stdout
    ids = [f["properties"]["id"] for f in json.loads((explored / "lines.geojson").read_text())["features"]]
    tree = json.loads(ski("why", f"observations/feature/line/{ids[-1]}", "--in", str(explored), "--json").stdout)

    def leaves(node: dict[str, object]) -> set[str]:
        below = node["supports"]
        assert isinstance(below, list)
        return set().union(*(leaves(n) for n in below)) if below else {str(node["key"]).rpartition("/")[2]}

    assert "sonar_scan" in leaves(tree)


def test_help_is_light() -> None:
    loaded = "import sys, blackboard.command.main as m; m.build_parser(None); print(sorted(sys.modules))"
    done = subprocess.run([sys.executable, "-c", loaded], cwd=CHECKOUT, capture_output=True, text=True, check=True)
    for heavy in ("numpy", "matplotlib", "shapely", "rich", "msgspec", "rosbags"):
        assert f"'{heavy}'" not in done.stdout


INTERRUPTING = """
import os
import signal

from blackboard.component import KnowledgeSource
from blackboard.kinds import SONAR_SCAN


class Interrupting(KnowledgeSource):
    triggers = (SONAR_SCAN,)

    def activate(self, trigger, board):
        if trigger.revision == 100:
            os.kill(os.getpid(), signal.SIGINT)
"""


def test_ctrl_c_writes_what_was_gathered(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "ctrl_c.py").write_text(INTERRUPTING)
    shipped = (CHECKOUT / "rules" / "missions" / "wander-lab.toml").read_text()
    (tmp_path / "m.toml").write_text(shipped + '\n[[knowledge_source]]\nuse = "ctrl_c.py:Interrupting"\n')
    assert main(["run", str(tmp_path / "m.toml"), "--out", str(tmp_path / "out"), "--json"]) == 130
    said = capsys.readouterr()
    assert "interrupted; what was gathered until then is in" in said.err
    assert 19 < json.loads(said.out)["time_s"] < 21  # 100 scans at 5 Hz
    assert (tmp_path / "out" / "overview.png").stat().st_size > 0
    assert max(line.stamp_s for line in read_journal(tmp_path / "out")) < 21


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["rnu", "wander-lab"], "there is no verb 'rnu'; did you mean 'run'?"),
        (["run", "explore-lap"], "there is no mission 'explore-lap'; did you mean 'explore-lab'?"),
        (["run", "wander-lab", "--world", "lap"], "did you mean 'lab'?"),
        (["run", "wander-lab", "--robot", "k2b"], "did you mean 'k2a'?"),
        (["run", "wander-lab", "--set", "eou_grid.cel_m=0.1"], "did you mean 'cell_m'?"),
        (["run", "wander-lab", "--set", "eou_gird.cell_m=0.1"], "did you mean 'eou_grid'?"),
        (["run", "wander-lab", "--set", "eou_grid.cell_m=-1"], "cell_m = -1.0"),
        (["run", "wander-lab", "--duration", "-3"], "--duration -3: must be in (0, 1e7] seconds"),
        (["run", "wander-lab", "--seed", "x"], "--seed"),
        (["run", "wander-lab", "--colour", "red"], "unrecognized arguments: --colour red"),
        (["map", "nowhere.log"], "nowhere.log"),
        (["why", "commands/drive", "--in", "nowhere"], "there is no such file; name the output folder of a run"),
        (["vocabulary", "observations/signal/sonar"], "did you mean 'observations/signal/sonar_scan'?"),
    ],
)
def test_a_users_mistakes_get_one_line(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    try:
        status = main(arguments)
    except SystemExit as stop:
        status = int(str(stop.code))
    said = capsys.readouterr()
    assert status == 2
    assert words in said.err
    assert said.err.startswith("ski: ")
    assert said.err.count("\n") == 1
    assert said.out == ""
    assert list(tmp_path.iterdir()) == []  # nothing was written


def test_a_folder_that_holds_something_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "precious.txt").write_text("mine")
    arguments = ["run", "wander-lab", "--duration", "2", "--out", str(tmp_path)]
    assert main(arguments) == 2
    assert "--force" in capsys.readouterr().err
    assert main([*arguments, "--force"]) == 0
    assert (tmp_path / "precious.txt").read_text() == "mine"
    assert (tmp_path / "overview.png").exists()


BROKEN = """
from blackboard.component import KnowledgeSource
from blackboard.kinds import SONAR_SCAN

class Broken(KnowledgeSource):
    triggers = (SONAR_SCAN,)

    def activate(self, trigger, board):
        raise RuntimeError("out of order")
"""


def test_a_broken_source_is_named_and_the_run_goes_on_unless_strict(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "broken.py").write_text(BROKEN)
    shipped = (CHECKOUT / "rules" / "missions" / "wander-lab.toml").read_text()
    (tmp_path / "m.toml").write_text(shipped + '\n[[knowledge_source]]\nuse = "broken.py:Broken"\n')
    arguments = ["run", str(tmp_path / "m.toml"), "--duration", "30"]
    assert main([*arguments, "--out", str(tmp_path / "a")]) == 0
    said = capsys.readouterr()
    assert "broken failed on ski/k2a/observations/signal/sonar_scan" in said.err
    assert "RuntimeError: out of order" in said.err
    assert any(line.stamp_s > 29 and "odom_from_robot" in line.key for line in read_journal(tmp_path / "a"))
    assert main([*arguments, "--out", str(tmp_path / "b"), "--strict"]) == 2
    said = capsys.readouterr()
    assert said.err.startswith("ski: broken failed on ski/k2a/observations/signal/sonar_scan revision 1: RuntimeError")
    assert len(list(read_journal(tmp_path / "b"))) > 5
    assert (tmp_path / "b" / "overview.png").exists()


def test_check_and_vocabulary(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "wander-lab"]) == 0
    assert "The mission is sound." in capsys.readouterr().out
    assert main(["check", "wander-lab", "--json"]) == 0
    assert "eou_grid" in json.loads(capsys.readouterr().out)["knowledge_sources"]
    assert main(["vocabulary", "--json"]) == 0
    assert "observations/signal/sonar_scan" in json.loads(capsys.readouterr().out)
    assert main(["vocabulary", "commands/drive"]) == 0
    assert json.loads(capsys.readouterr().out)["$ref"] == "#/$defs/Drive"
