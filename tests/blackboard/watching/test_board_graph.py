"""Who posts and reads what: from a mission's components, as text, DOT and picture."""

import json
import re
from pathlib import Path

import pytest

from blackboard.command.main import main
from blackboard.errors import OutputError
from blackboard.mission import find_mission, load_mission
from blackboard.watching.board_graph import BoardGraph, Member, by_role, heading_of, name_of
from blackboard.watching.declared_graph import declared_graph
from blackboard.watching.graph_dot import dot
from blackboard.watching.graph_picture import graph_figure, write_graph_picture
from blackboard.watching.graph_text import lines_by_component, lines_by_panel

SCAN, POSE, DRIVE = "observations/signal/sonar_scan", "observations/feature/odom_from_robot", "commands/drive"


@pytest.fixture
def small() -> BoardGraph:
    return BoardGraph(
        title='a "small" one',
        members=by_role(
            [
                Member(name="safety", role="safety layer", reads=(SCAN,), posts=(DRIVE,)),
                Member(name="robot", role="robot", host="wheels", reads=(DRIVE,), posts=(SCAN,)),
                Member(name="pose", role="knowledge source", woken_by=(SCAN,), posts=(POSE,)),
            ]
        ),
    )


@pytest.fixture(scope="module")
def lab() -> BoardGraph:
    return declared_graph(load_mission(find_mission("explore-lab")))


def test_members_and_kinds_stand_in_the_order_of_the_data(small: BoardGraph) -> None:
    assert [one.name for one in small.members] == ["robot", "pose", "safety"]
    assert small.paths() == [SCAN, POSE, DRIVE]
    assert (small.posters(SCAN), small.woken(SCAN), small.readers(SCAN)) == (["robot"], ["pose"], ["safety"])
    assert (heading_of(SCAN), name_of(SCAN)) == ("observations/signal", "sonar_scan")
    assert (heading_of(DRIVE), name_of(DRIVE)) == ("commands", "drive")


def test_text_by_panel_and_by_component(small: BoardGraph) -> None:
    assert "\n".join(lines_by_panel(small, 80)).endswith(
        "  odom_from_robot\n    posted by  pose\n\ncommands\n  drive\n    posted by  safety\n    read by    robot"
    )
    assert "\n".join(lines_by_component(small, 80)).startswith(
        'a "small" one: who posts and reads what\n\nrobot\n  robot on wheels\n    reads      commands/drive\n'
    )
    many = Member(name="many", role="rules", reads=tuple(f"status/kind_{i}" for i in range(30)))
    graph = BoardGraph(title="many", members=(many,))
    assert max(map(len, lines_by_component(graph, 60))) <= 60
    assert "    posted by  nobody" in list(lines_by_panel(graph, 60))


def test_a_mission_as_its_components_declare_it(lab: BoardGraph) -> None:
    members = {one.name: one for one in lab.members}
    assert members["line_finder"].woken_by == ("observations/feature/supported_points",)
    assert members["line_finder"].reads == ("status/robot",)
    assert "hypotheses/symbol/target" in members["rules"].reads  # from the rules' patterns
    assert members["robot"].reads == ("commands/drive",)
    assert "control/switch" in members["path_following"].posts  # it adjusts the switch of another
    assert "control/switch" not in members["target_nav"].posts
    assert lab.posters("commands/drive") == ["safety"]
    assert lab.posters("observations/signal/laser_scan") == []  # this robot has none
    for one in lab.members:
        assert not set(one.woken_by) & set(one.reads), one.name


def test_hosts_are_told_where_the_mission_file_tells_them(lab: BoardGraph) -> None:
    assert {one.host for one in lab.members} == {""}
    mission = load_mission(find_mission("explore-lab"), {"hosts.maps": {"runs": ["eou_grid", "rules"]}})
    hosts = {one.name: one.host for one in declared_graph(mission).members}
    assert (hosts["eou_grid"], hosts["rules"], hosts["line_finder"]) == ("maps", "maps", "knowledge_sources")
    assert (hosts["robot"], hosts["safety"]) == ("robot", "robot")
    assert (hosts["avoid_obstacles"], hosts["coordinator"], hosts["control"]) == ("behaviours", "behaviours", "")


def test_a_robot_that_does_not_move_has_no_reflexes(tmp_path: Path) -> None:
    mission = tmp_path / "pose.toml"
    mission.write_text(
        '[robot]\nuse = "sim.simulated:SimulatedRobot"\n\n[[knowledge_source]]\n'
        'use = "knowledge_sources.odometry_pose:OdometryPose"\n'
    )
    graph = declared_graph(load_mission(mission))
    assert [one.role for one in graph.members] == ["robot", "knowledge source", "safety layer", "control"]
    assert graph.readers("control/focus") == ["control"]


def test_dot_has_every_node_and_edge_once_and_quotes_its_title(small: BoardGraph) -> None:
    text = dot(small)
    assert text.startswith('digraph "a \\"small\\" one" {\n')
    assert text.count(" -> ") == 6
    assert f'"{SCAN}" -> "@pose" [penwidth=2' in text
    assert f'"@safety" -> "{DRIVE}"' in text
    assert '"@robot" [label="robot\\nwheels"' in text
    assert text.count("{") == text.count("}") == 4  # the graph and three panels


def test_every_mark_of_the_picture_lies_within_it_and_no_two_at_one_place(lab: BoardGraph) -> None:
    axes = graph_figure(lab).axes[0]
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    marks = [line for line in axes.lines if line.get_marker() not in ("None", None)]
    places = [(float(mark.get_xdata()[0]), float(mark.get_ydata()[0])) for mark in marks]  # type: ignore[index, arg-type]
    edges = sum(len(one.woken_by) + len(one.reads) + len(one.posts) for one in lab.members)
    assert len(marks) == edges + 3  # and the legend's
    assert len(set(places)) == len(places)
    assert all(left < x < right and top < y < bottom for x, y in places)


def test_the_same_graph_gives_the_same_picture(small: BoardGraph, tmp_path: Path) -> None:
    for ending in ("png", "svg"):
        for name in ("a", "b"):
            write_graph_picture(small, tmp_path / f"{name}.{ending}")
        assert (tmp_path / f"a.{ending}").read_bytes() == (tmp_path / f"b.{ending}").read_bytes()
    with pytest.raises(OutputError, match=r"name a \.png or \.svg file"):
        write_graph_picture(small, tmp_path / "a.jpg")
    with pytest.raises(OutputError, match="cannot be written"):
        write_graph_picture(small, tmp_path / "none" / "a.png")


def test_the_verb(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["graph", "explore-lab", "--json"]) == 0
    graph = json.loads(capsys.readouterr().out)
    assert graph["kinds"]["commands/velocity"]["posted_by"] == ["coordinator"]
    assert main(["graph", "explore-lab", "--dot", str(tmp_path / "g.dot")]) == 0
    assert capsys.readouterr().out == ""
    assert len(re.findall(" -> ", (tmp_path / "g.dot").read_text())) > 100
    assert main(["graph", "explore-lab", "--dot", str(tmp_path / "none" / "g.dot")]) == 2
    assert "cannot be written" in capsys.readouterr().err
