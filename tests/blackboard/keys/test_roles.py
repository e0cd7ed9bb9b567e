"""What roles may do, as key expressions, and the access control that zenoh is given."""

import datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.assembly import assemble
from blackboard.errors import KeysError
from blackboard.key_expressions import check_expression, matches
from blackboard.keys.members import ROLES, Member, new_member
from blackboard.keys.roles import MEANINGS, POSTS, READABLE, Rights, may_put, rights
from blackboard.keys.rules import access_control
from blackboard.mission import load_mission, shipped_missions
from blackboard.vocabulary import core_kinds

LATER = datetime.datetime(2100, 1, 1, tzinfo=datetime.UTC)
COLLECTIONS = {kind.path for kind in core_kinds() if kind.collection}
KEEPERS = {"status/host"}  # posted by the keeper itself


def member(*roles: str, robots: tuple[str, ...] = ("k2a",), **more: object) -> Member:
    return new_member("me", roles, LATER, robots, **more)


def key(path: str, robot: str = "k2a") -> str:
    return f"ski/{robot}/{path}" + ("/1" if path in COLLECTIONS else "")


def test_roles_are_told_once():
    assert set(POSTS) == set(MEANINGS) == set(ROLES)


def test_every_kind_is_posted_by_some_role_and_none_by_a_viewer_or_an_agent():
    for kind in core_kinds():
        posters = {role for role in ROLES if may_put(member(role), key(kind.path))}
        assert bool(posters) is (kind.path not in KEEPERS), kind.path
        assert not posters & {"viewer", "agent"}


@pytest.mark.parametrize(
    ("path", "who"),
    [
        ("observations/signal/laser_scan", {"robot"}),
        ("commands/drive", {"robot"}),
        ("status/robot", {"robot"}),
        ("commands/velocity", {"robot", "operator"}),
        ("motivations/motivation", {"planner", "operator"}),
        ("motivations/resolution_task", {"planner", "operator", "knowledge"}),
        ("hypotheses/symbol/corner", {"knowledge", "operator"}),
        ("control/switch", {"planner", "robot", "operator"}),
        ("control/agenda", {"knowledge", "operator"}),
        ("status/mission", {"planner", "operator"}),
        ("status/host", set()),
    ],
)
def test_who_posts_what(path, who):
    assert {role for role in ROLES if may_put(member(role), key(path))} == who
    assert not any(may_put(member(role), key(path, robot="other")) for role in ROLES)
    assert {role for role in ROLES if role != "robot" and may_put(member(role, robots=()), key(path))} == who - {
        "robot"
    }


@pytest.mark.parametrize("mission", ["explore-lab", "explore-lab-symbols", "explore-workshop-conflicts", "find-drums"])
def test_the_sources_of_shipped_missions_need_no_other_role(mission):
    assembly = assemble(load_mission(shipped_missions()[mission]))
    try:
        posted = {kind.path for source in assembly.sources for kind in source.posts}
    finally:
        assembly.robot.close()
    assert posted
    assert [path for path in posted if not may_put(member("knowledge"), key(path))] == []


def test_one_process_may_be_two_robots():
    pair = member("robot", robots=("east", "west"), hosts=["robot"])
    assert [may_put(pair, key("commands/drive", robot)) for robot in ("east", "west", "north")] == [True, True, False]
    assert "ski/west/@hosts/robot/**" in rights(pair).announces


def test_roles_add_up():
    both = member("planner", "knowledge")
    assert set(rights(both).puts) == set(rights(member("planner")).puts) | set(rights(member("knowledge")).puts)


def test_revoked_is_without_rights():
    assert rights(Member(name="me", roles=("operator",), expires=LATER, revoked=True)) == Rights()


@pytest.mark.parametrize("role", ROLES)
def test_expressions_are_fit_for_zenoh_and_stay_with_the_own_robot(role):
    may = rights(member(role))
    for expression in (*READABLE, *may.puts, *may.asks, *may.serves, *may.announces):
        check_expression(expression)
    own = [*may.puts, *may.announces, *(e for e in may.asks if "@late" in e or "begin" in e)]
    assert all(e.startswith(("ski/k2a/", "ski/@agents/", "ski/@manager/")) for e in own)
    assert not any(matches(e, "ski/k2a/@keeper/beat") for e in may.puts)
    assert not any(matches(e, "ski/k2a/@keeper/snapshot") for e in may.serves)


@pytest.mark.parametrize("role", ROLES)
def test_who_posts_somewhere_hands_in_there(role):
    may = rights(member(role))
    places = [e.removeprefix("ski/k2a/@late/") for e in may.asks if e.startswith("ski/k2a/@late/")]
    assert places == [e.removeprefix("ski/k2a/") for e in may.puts if "@" not in e]


@pytest.mark.parametrize(
    ("roles", "more", "says"),
    [
        (["plannr"], {}, "did you mean 'planner'"),
        ([], {}, "has no role"),
        (["robot"], {"robots": ()}, "add `--robot NAME`"),
        (["viewer"], {"hosts": ["h"]}, "runs no hosts"),
        (["planner"], {"hosts": ["a/b"]}, "host 'a/b'"),
        (["planner"], {"robots": ("*",)}, r"robot '\*'"),
    ],
)
def test_members_that_do_not_fit_are_refused(roles, more, says):
    with pytest.raises(KeysError, match=says):
        member(*roles, **more)


@given(st.text(max_size=50))
def test_a_name_is_one_chunk_and_one_file(name):
    try:
        made = new_member(name, ["knowledge"], LATER)
    except KeysError:
        return
    assert "/" not in name
    assert name.strip(".")
    for expression in rights(made).puts:
        check_expression(expression)


def test_access_control_denies_by_default_and_knows_certificates_by_their_names():
    renewed = Member(name="mapper", roles=("knowledge",), hosts=("mapper",), generation=3, expires=LATER)
    gone = Member(name="gone", roles=("operator",), expires=LATER, revoked=True)
    table = access_control([renewed, gone])
    assert (table["enabled"], table["default_permission"]) == (True, "deny")
    names = {subject["id"]: subject["cert_common_names"] for subject in table["subjects"]}
    assert names == {"mapper.3": ["mapper.3"], "mapper before": ["mapper.1", "mapper.2"], "gone.1": ["gone.1"]}
    allowed = {rule["id"] for rule in table["rules"] if rule["permission"] == "allow"}
    granted = {policy["subjects"][0]: set(policy["rules"]) & allowed for policy in table["policies"]}
    assert granted["gone.1"] == granted["mapper before"] == set()
    assert {"watch", "arrive", "mapper.3 puts", "mapper.3 asks", "mapper.3 announces"} <= granted["mapper.3"]
    assert all(rule["key_exprs"] and rule["messages"] and rule["flows"] for rule in table["rules"])
    assert not any("delete" in rule["messages"] for rule in table["rules"])
