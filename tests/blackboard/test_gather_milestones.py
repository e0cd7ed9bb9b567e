"""What is kept of a run on the way, for its figures."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from blackboard.command.gather_milestones import MilestoneCollector, competing, echo_points
from blackboard.entry import Entry
from blackboard.kinds import BEHAVIOUR, MOTIVATION
from blackboard.messages.geometry import Point, Pose
from blackboard.messages.motion import BehaviourStatus, Motivation
from blackboard.messages.sensing import LaserScan, LaserSensor, RobotDescription, SonarScan, SonarSensor
from blackboard.mission import find_mission, load_mission
from blackboard.report.milestones import Visit
from blackboard.runner import Run

GOER = """
from blackboard.component import Behaviour, NoParams

class Goer(Behaviour[NoParams]):
    motivated = True
    parameters = ("x_m", "y_m")

    def respond(self, board):
        return None
"""


def test_the_stages_of_a_run() -> None:
    run = Run(load_mission(find_mission("explore-lab-lines")))
    collector = MilestoneCollector(run)
    run.run(30.0)
    kept = collector.milestones()
    first_scan, some, accumulated = kept.scans
    assert (first_scan.stamp_s, first_scan.scans) == (0.0, 1)  # all twelve sonars at once
    assert some.scans == 6  # the grid is posted every second, scans come five times a second
    assert accumulated.scans > 6
    assert accumulated.stamp_s == kept.first.stamp_s
    assert np.count_nonzero(first_scan.grid.cells != 128) < np.count_nonzero(accumulated.grid.cells != 128)
    assert len(kept.filtered) == kept.first.points >= 500
    assert len(kept.raw) >= len(kept.filtered)
    assert kept.first.stamp_s == kept.second.from_s < kept.second.stamp_s < kept.merged.stamp_s
    assert min(len(stage.ends) for stage in (kept.first, kept.second, kept.merged)) > 0
    assert kept.behaviours[0] == "avoid_obstacles"
    assert [lead.behaviour for lead in kept.leads][:2] == ["curiosity", "boundary_following"]


def test_those_that_silence_each_other_lead() -> None:
    mission = load_mission(find_mission("wander-lab"))
    assert competing(mission) == {"curiosity", "boundary_following", "random_wander"}


def test_a_run_that_ends_early_keeps_what_there_is() -> None:
    run = Run(load_mission(find_mission("wander-lab")))
    collector = MilestoneCollector(run)
    run.run(0.1)
    kept = collector.milestones()
    assert [stage.scans for stage in kept.scans] == [1, 1]
    assert (kept.first, kept.second, kept.merged) == (None, None, None)


def test_where_the_robot_was_asked_to_go(tmp_path: Path) -> None:
    (tmp_path / "goer.py").write_text(GOER)
    text = find_mission("wander-lab").read_text() + '\n[[behaviour]]\nuse = "goer.py:Goer"\n'
    (tmp_path / "mission.toml").write_text(text)
    run = Run(load_mission(tmp_path / "mission.toml"))
    collector = MilestoneCollector(run)
    for number, (x_m, outcome) in enumerate([(1.0, "reached"), (2.0, "blocked"), (3.0, "underway")], 1):
        run.board.now_s = float(number)
        asked = Motivation(on=True, number=number, parameters=(x_m, 0.5))
        run.board.post(MOTIVATION, asked, id="goer", source="planner")
        status = BehaviourStatus(state="active", acknowledged=number, outcome=outcome)
        run.board.post(BEHAVIOUR, status, id="goer", source="goer")
    run.board.post(MOTIVATION, Motivation(on=False, number=4), id="goer", source="planner")
    run.board.post(MOTIVATION, Motivation(on=True, number=1, parameters=(1.0,)), id="curiosity", source="planner")
    assert collector.milestones().visits == [
        Visit(place=Point(x_m=1.0, y_m=0.5), behaviour="goer", stamp_s=1.0, outcome="reached"),
        Visit(place=Point(x_m=2.0, y_m=0.5), behaviour="goer", stamp_s=2.0, outcome="blocked"),
        Visit(place=Point(x_m=3.0, y_m=0.5), behaviour="goer", stamp_s=3.0, outcome="underway"),
    ]


def test_echoes_as_points() -> None:
    robot = RobotDescription(
        name="r",
        radius_m=0.3,
        max_speed_mps=1.0,
        max_turn_radps=1.0,
        max_acceleration_mps2=1.0,
        sonars=(
            SonarSensor(mount=Pose(x_m=0.3, y_m=0.0, heading_rad=0.0), cone_rad=0.2, max_range_m=5.0),
            SonarSensor(mount=Pose(x_m=0.0, y_m=0.3, heading_rad=pi / 2), cone_rad=0.2, max_range_m=5.0),
            SonarSensor(mount=Pose(x_m=0.0, y_m=0.3, heading_rad=pi / 2), cone_rad=0.2, max_range_m=5.0),
        ),
        lasers=(LaserSensor(mount=Pose(x_m=0.1, y_m=0.0, heading_rad=0.0), max_range_m=8.0),),
    )
    path = np.array(
        [[0.0, 0.0, 0.0, pi / 2], [1.0, 2.0, 0.0, pi / 2]]
    )  # at 0.5 s it stands at (1, 0) and looks along y

    def entry(value: object) -> Entry:
        return Entry(key="k", id=None, revision=1, event="posted", stamp_s=0.5, source="robot", value=value)

    sonar = SonarScan(sensors=(0, 1, 2), ranges_m=(2.0, 0.7, 5.0))  # the third heard nothing within its range
    assert echo_points(entry(sonar), robot, path) == pytest.approx(np.array([[1.0, 2.3], [0.0, 0.0]]))
    laser = LaserScan(angle_min_rad=0.0, angle_step_rad=pi / 2, ranges_m=(1.0, 2.0, None))
    assert echo_points(entry(laser), robot, path) == pytest.approx(np.array([[1.0, 1.1], [-1.0, 0.1]]))
