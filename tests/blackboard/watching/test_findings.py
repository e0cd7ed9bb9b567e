"""From facts about a setup to what is wrong with it and what to do."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import MissionError
from blackboard.watching.finding import DoctorParams, Finding
from blackboard.watching.findings import findings
from blackboard.watching.setup_facts import HostFacts, KeeperFacts, RobotFacts, SetupFacts, StreamFacts

SONAR = StreamFacts(name="observations/signal/sonar_scan", count=1000, stamp_s=100.0)
GRID = StreamFacts(name="eou_grid", count=200, stamp_s=100.0, woken_by=SONAR.name, wakers_came=20)
ROBOT = HostFacts(robot="k2a", name="robot", version="1.0", machine="here", components=("robot", "safety"))
SOURCES = HostFacts(robot="k2a", name="sources", version="1.0", machine="there", components=("eou_grid",))
BOARD = RobotFacts(name="k2a", clock_s=100.1, mission="underway", readings=(SONAR,), activations=(GRID,))
SOUND = SetupFacts(
    address="tcp/127.0.0.1:7447",
    version="1.0",
    answers="a keeper",
    keeper=KeeperFacts(version="1.0", folder="/board"),
    robots=(BOARD,),
    hosts=(ROBOT, SOURCES),
)


def the_one(facts: SetupFacts) -> Finding:
    (found,) = findings(facts)
    assert "\n" not in found.what + found.do
    return found


def with_host(**changes: object) -> SetupFacts:
    return replace(SOUND, hosts=(ROBOT, replace(SOURCES, **changes)))  # type: ignore[arg-type]


def with_board(**changes: object) -> SetupFacts:
    return replace(SOUND, robots=(replace(BOARD, **changes),))  # type: ignore[arg-type]


def with_keeper(**changes: object) -> SetupFacts:
    assert SOUND.keeper is not None
    return replace(SOUND, keeper=replace(SOUND.keeper, **changes))  # type: ignore[arg-type]


def test_nothing_is_wrong_with_a_sound_setup() -> None:
    assert findings(SOUND) == []
    assert findings(replace(SOUND, expected={"robot": "robot", "eou_grid": "sources"})) == []


@pytest.mark.parametrize(
    ("answers", "about", "what"),
    [
        ("nobody", "nothing running", "nothing listens at tcp/127.0.0.1:7447"),
        ("something else", "wrong port", "is no board keeper and speaks no zenoh"),
        ("certificates", "certificate", "takes members with certificates only"),
        ("refused", "certificate", "do not accept each other (expired)"),
        ("no certificates", "certificate", "takes no certificates"),
        ("a router", "no keeper", "a zenoh router listens"),
    ],
)
def test_where_the_keeper_is_not_reached_that_is_all(answers: str, about: str, what: str) -> None:
    found = the_one(replace(SOUND, answers=answers, trouble="expired", keeper=None))  # type: ignore[arg-type]
    assert (found.about, what in found.what) == (about, True)


def test_keys_that_were_withdrawn() -> None:
    found = the_one(replace(SOUND, answers="a router", keeper=None, member="eve (viewer)"))
    assert (found.about, "lets eve (viewer) in and answers nothing" in found.what) == ("certificate", True)


def test_versions() -> None:
    found = the_one(with_host(version="0.9"))
    assert (found.about, found.what) == (
        "version difference",
        "host sources on there is ski 0.9, the keeper is ski 1.0",
    )
    found = the_one(replace(SOUND, version="1.1"))
    assert found.what == "the keeper is ski 1.0, this is ski 1.1"
    assert findings(with_host(version="")) == []


def test_what_the_keeper_says_of_itself() -> None:
    found = the_one(with_keeper(journal_trouble="No space left on device"))
    assert (found.about, found.what) == (
        "journal",
        "the keeper cannot write its journal in /board: No space left on device",
    )
    found = the_one(with_keeper(refused={"value": 3}, refused_example={"value": "x: forward_mps = 900"}))
    assert (found.about, found.what) == (
        "rejected writer",
        "the keeper refused 3 posts (value), the last: x: forward_mps = 900",
    )
    assert the_one(with_keeper(overflowed=1)).what.startswith("the keeper could not keep up and dropped 1 message,")


def test_hosts_that_do_not_fare_well() -> None:
    found = the_one(with_host(state="dead"))
    assert (found.about, found.what) == (
        "host dead",
        "host sources on there is gone (killed, frozen or cut off) with eou_grid",
    )
    assert the_one(with_host(state="hung")).about == "host hung"
    assert findings(with_host(state="stopped")) == []
    found = the_one(with_host(missed=2))
    assert (found.about, "2 entries could not be had" in found.what) == ("slow reader", True)
    found = the_one(with_host(lacking=1))
    assert (found.about, found.what) == (
        "missing entries",
        "the keeper has not got 1 entry that host sources on there sent",
    )
    full = replace(with_host(lacking=1), keeper=replace(SOUND.keeper, journal_trouble="full"))  # type: ignore[type-var]
    assert the_one(full).about == "journal"  # what follows from it is not told
    assert the_one(with_host(boots=2)).what == "2 processes are linked as host sources"


def test_clocks() -> None:
    found = the_one(with_host(offset_s=-2.5))
    assert (found.about, found.what) == (
        "clock difference",
        "the clock of host sources on there is 2.50 s behind the keeper's",
    )
    assert "ahead of" in the_one(with_host(offset_s=0.7)).what
    assert findings(with_host(offset_s=0.7, round_trip_s=0.5)) == []  # it may be the way
    assert findings(with_host(offset_s=0.4)) == []


def test_who_runs_what() -> None:
    found = the_one(with_host(components=("eou_grid", "safety")))
    assert (found.about, found.what.split(":")[0]) == ("two of one", "safety of k2a runs in robot and sources")
    other = replace(SOURCES, robot="other", components=("safety",))
    assert findings(replace(SOUND, hosts=(ROBOT, SOURCES, other))) == []  # another robot's
    dead = replace(SOURCES, state="dead", components=("safety",))
    assert [found.about for found in findings(replace(SOUND, hosts=(ROBOT, dead)))] == ["host dead"]
    found = the_one(replace(SOUND, expected={"rules": "rules", "look": "rules", "eou_grid": "sources"}))
    assert (found.about, found.what) == ("host missing", "nobody runs rules, look, which host rules should")
    gone = replace(SOUND, expected={"eou_grid": "sources"}, hosts=(ROBOT, replace(SOURCES, state="dead")))
    assert the_one(gone).about == "host dead"  # and not told twice
    assert [f.about for f in findings(replace(SOUND, hosts=()))] == ["no hosts"]


def test_of_several_robots_each_is_to_have_its_own() -> None:
    here, there = f"{SOURCES.robot}/eou_grid", "other/eou_grid"
    assert findings(replace(SOUND, expected={here: "sources"})) == []
    found = the_one(replace(SOUND, expected={here: "sources", there: "other.sources"}))
    assert found.what == "nobody runs eou_grid, which host other.sources should"


def test_a_component_that_failed() -> None:
    found = the_one(with_board(failed={"line_finder": "ValueError: no"}))
    assert (found.about, "line_finder of k2a has failed and is left out: ValueError: no" in found.what) == (
        "component failed",
        True,
    )


def test_rules_behaviours_and_processes_in_trouble() -> None:
    found = the_one(with_board(rule_errors={"go": "no such switch"}))
    assert (found.about, found.what) == ("rule error", "rule go of k2a went wrong: no such switch")
    assert the_one(with_board(unanswered={"docking": 2.0})).about == "no acknowledgement"
    found = the_one(with_board(given_up={"maps": "MemoryError"}))
    assert found.what == "the process of host maps ended too often and is not started again: MemoryError"


def test_silence_is_measured_by_the_rhythm_until_then() -> None:
    # a scan every 0.1 s: silent from max(3, 20 x 0.1) = 3 s on
    assert findings(with_board(clock_s=102.9)) == []
    assert the_one(with_board(clock_s=103.1)).what == "observations/signal/sonar_scan of k2a has not come for 3 s"
    # the grid worked every 0.5 s: silent from 10 s on
    later = replace(SONAR, stamp_s=110.0)
    assert findings(with_board(clock_s=109.9, readings=(later,))) == []
    found = the_one(with_board(clock_s=110.1, readings=(later,)))
    assert found.what == (
        "eou_grid in host sources on there has done nothing for 10 s, though observations/signal/sonar_scan comes"
    )


def test_what_is_no_silence() -> None:
    late = {"clock_s": 200.0, "readings": ()}
    assert findings(with_board(**late, activations=(replace(GRID, wakers_came=0),))) == []  # nothing wakes it
    assert findings(with_board(**late, activations=(replace(GRID, rests=True),))) == []
    assert the_one(with_board(**late, failed={"eou_grid": "KeyError"})).about == "component failed"
    assert findings(with_board(**late, activations=(replace(GRID, count=19),))) == []  # no rhythm yet
    assert findings(with_board(**late, mission="done")) == []
    assert findings(with_board(clock_s=200.0, activations=(), readings=(replace(SONAR, count=3),))) == []
    begun = replace(SONAR, stamp_s=1.7e9)  # a recording's clock
    assert findings(with_board(clock_s=1.7e9 + 60, readings=(begun,), activations=())) == []
    assert the_one(with_board(clock_s=None)).about == "no clock"


def test_parameters_are_checked() -> None:
    with pytest.raises(MissionError, match="clock_limit_s"):
        DoctorParams(clock_limit_s=-1)


texts = st.text(max_size=20)
hosts = st.builds(
    HostFacts,
    robot=texts,
    name=texts,
    state=st.sampled_from(["alive", "hung", "dead", "stopped", "?"]),
    version=texts,
    components=st.lists(texts, max_size=3).map(tuple),
    offset_s=st.floats(-100, 100),
    missed=st.integers(0, 5),
)


@given(st.lists(hosts, max_size=4), texts, st.dictionaries(texts, texts, max_size=3))
def test_whatever_is_gathered_findings_are_whole_lines(
    found: list[HostFacts], version: str, expected: dict[str, str]
) -> None:
    facts = replace(SOUND, hosts=tuple(found), version=version, expected=expected)
    for finding in findings(facts):
        plain = finding.as_dict()
        assert all(text and text.isprintable() for text in plain.values())
