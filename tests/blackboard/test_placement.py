"""Which process runs what: hand-worked missions, every refusal with its place, and that nothing runs twice or nowhere."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import MissionError
from blackboard.mission import Mission, load_mission, parse_settings, shipped_missions
from blackboard.placement import WORDS, HostPlan, HostTable, placement

SOURCES = ("odometry_pose", "eou_grid", "filter_raw")
MISSION = """\
[robot]
use = "sim.simulated:SimulatedRobot"

[rules]
files = ["explore"]

[[knowledge_source]]
use = "knowledge_sources.odometry_pose:OdometryPose"

[[knowledge_source]]
use = "knowledge_sources.eou_grid:EouGrid"

[[knowledge_source]]
use = "knowledge_sources.filter_raw:FilterRaw"

[[behaviour]]
use = "behaviours.avoid_obstacles:AvoidObstacles"

[coordinator]
use = "behaviours.superposition:Superposition"

"""
FIRST_LINE = MISSION.count("\n") + 1


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "m.toml"


def load(file: Path, hosts: str = "", *settings: str) -> Mission:
    file.write_text(MISSION + hosts)
    return load_mission(file, parse_settings(settings))


def plans(file: Path, hosts: str = "", *settings: str) -> dict[str, HostPlan]:
    return {plan.name: plan for plan in placement(load(file, hosts, *settings))}


def refusal(file: Path, hosts: str, *settings: str) -> str:
    with pytest.raises(MissionError) as caught:
        load(file, hosts, *settings)
    words = str(caught.value)
    assert "\n" not in words
    return words


def test_without_tables_there_are_four(file: Path) -> None:
    found = plans(file)
    assert list(found) == list(WORDS)
    assert found["robot"].words() == ["robot"]
    assert found["behaviours"].words() == ["behaviours"]
    assert found["knowledge_sources"].sources == SOURCES
    assert found["rules"].words() == ["rules"]


def test_a_mission_without_rules_and_behaviours_has_no_host_for_them() -> None:
    mission = load_mission(shipped_missions()["map-recording"], {"robot": {"path": "drive.log"}})
    assert [plan.name for plan in placement(mission)] == ["robot", "knowledge_sources"]


def test_what_no_table_names_goes_to_the_host_of_its_word(file: Path) -> None:
    found = plans(
        file, '[hosts.body]\nruns = ["robot", "behaviours"]\n\n[hosts.map]\nruns = ["eou_grid"]\non = "desk"\n'
    )
    assert list(found) == ["body", "map", "knowledge_sources", "rules"]
    assert (found["body"].robot, found["body"].behaviours, found["body"].rules) == (True, True, False)
    assert (found["map"].sources, found["map"].params.on) == (("eou_grid",), "desk")
    assert found["knowledge_sources"].sources == ("odometry_pose", "filter_raw")


def test_the_word_means_the_rest_of_them(file: Path) -> None:
    found = plans(file, '[hosts.map]\nruns = ["filter_raw"]\n\n[hosts.body]\nruns = ["robot", "knowledge_sources"]\n')
    assert found["body"].sources == ("odometry_pose", "eou_grid")
    assert "knowledge_sources" not in found


def test_a_table_of_a_words_name_needs_no_runs(file: Path) -> None:
    found = plans(file, '[hosts.rules]\nrestart = "never"\nhang_s = 9\n')
    assert found["rules"].rules
    assert (found["rules"].params.restart, found["rules"].params.hang_s) == ("never", 9.0)
    assert found["robot"].params.restart == "on-failure"


def test_settings_go_over_tables_and_make_them(file: Path) -> None:
    found = plans(file, "[hosts.rules]\nhang_s = 9\n", "hosts.rules.hang_s=2", "hosts.robot.on=pi")
    assert (found["rules"].params.hang_s, found["robot"].params.on) == (2.0, "pi")


@pytest.mark.parametrize(
    ("hosts", "line", "words"),
    [
        ('[hosts.map]\nruns = ["eou_gird"]\n', 1, "the mission has no 'eou_gird'; did you mean 'eou_grid'?"),
        (
            '[hosts.a]\nruns = ["robot"]\n[hosts.b]\non = "x"\nruns = ["robot"]\n',
            4,
            "'robot' runs in the host 'a' already",
        ),
        ('[hosts.map]\nruns = ["avoid_obstacles"]\n', 1, "write 'behaviours', not 'avoid_obstacles'"),
        ('[hosts.map]\nruns = ["coordinator"]\n', 1, "write 'behaviours', not 'coordinator'"),
        ('[hosts.map]\nruns = ["safety"]\n', 1, "the safety layer always runs beside the robot"),
        ("[hosts.spare]\nhang_s = 4\n", 0, "the host 'spare' runs nothing"),
        ("[hosts.keeper]\nhang_s = 4\n", 0, "a host cannot be named 'keeper'"),
        ("[hosts.rules]\nhang_s = 0\n", 1, "hang_s = 0.0 is outside [1, 3600] seconds"),
        ('[hosts.rules]\nrestart = "often"\n', 1, "must be one of 'always', 'on-failure', 'never'"),
        ("[hosts.rules]\nrestart_s = 3\n", 1, "unknown key 'restart_s'; did you mean 'restarts'?"),
        ('[hosts.rules]\non = "a b"\n', 1, "on = 'a b' is outside the names of machines"),
        ('[hosts]\non = "desk"\n', 1, "write it in a table [hosts.NAME]"),
    ],
)
def test_what_is_refused_says_where_and_what_to_do(file: Path, hosts: str, line: int, words: str) -> None:
    told = refusal(file, hosts)
    assert told.startswith(f"{file}:{FIRST_LINE + line}: [hosts")
    assert words in told


def test_a_word_for_what_the_mission_lacks_is_refused(file: Path) -> None:
    file.write_text('[robot]\nuse = "sim.simulated:SimulatedRobot"\n[hosts.a]\nruns = ["rules"]\n')
    with pytest.raises(MissionError, match="the mission has no rules; drop the word"):
        load_mission(file)


def test_a_setting_for_a_host_that_runs_nothing_is_refused(file: Path) -> None:
    assert "the host 'robots' runs nothing" in refusal(file, "", "hosts.robots.on=pi")


MISSION_OF_ALL = load_mission(shipped_missions()["explore-lab"])


@given(
    st.dictionaries(
        st.sampled_from("abc"), st.lists(st.sampled_from([*WORDS, "eou_grid", "routes", "travel"])), max_size=3
    )
)
def test_every_component_runs_in_exactly_one_host(runs: dict[str, list[str]]) -> None:
    from dataclasses import replace

    from blackboard.placement import HostParams

    place = MISSION_OF_ALL.robot.place
    tables = tuple(HostTable(name, HostParams(runs=tuple(words)), place) for name, words in runs.items())
    try:
        hosts = placement(replace(MISSION_OF_ALL, hosts=tables))
    except MissionError:
        words = [word for words in runs.values() for word in words]
        assert (
            len(words) != len(set(words)) or any(not words for words in runs.values()) or "knowledge_sources" in words
        )
        return
    assert [sum(plan.robot for plan in hosts), sum(plan.behaviours for plan in hosts), sum(p.rules for p in hosts)] == [
        1,
        1,
        1,
    ]
    assert sorted(s for plan in hosts for s in plan.sources) == sorted(s.name for s in MISSION_OF_ALL.knowledge_sources)
    assert all(plan.words() for plan in hosts)
