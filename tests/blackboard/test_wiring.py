"""Missions whose parts do not fit are refused before anything runs, each with one line."""

from collections.abc import Iterator, Sequence
from typing import Any

import pytest

from blackboard.access import Access
from blackboard.component import KnowledgeSource, NoParams, Reading, Robot, Trigger
from blackboard.entry import Entry
from blackboard.errors import BoardError, MissionError
from blackboard.kinds import (
    DRIVE,
    LASER_SCAN,
    LINE,
    MAP_FROM_ODOM,
    ODOM_FROM_ROBOT,
    ODOMETRY,
    SONAR_SCAN,
    SUPPORTED_POINTS,
    TRUE_POSE,
    Kind,
    slot,
)
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import RobotDescription
from blackboard.wiring import check_wiring


class SonarRobot(Robot[NoParams]):
    """Has wheels and sonars, no laser."""

    provides = (ODOMETRY, SONAR_SCAN)

    @property
    def description(self) -> RobotDescription:
        return RobotDescription(name="r", radius_m=0.3, max_speed_mps=1, max_turn_radps=1, max_acceleration_mps2=1)

    def advance(self, until_s: float) -> Iterator[Reading[Any]]:
        yield from ()


class Source(KnowledgeSource[NoParams]):
    """A source with any wiring."""

    def __init__(
        self,
        name: str,
        triggers: Sequence[Trigger[Any] | Kind[Any]],
        posts: Sequence[Kind[Any]] = (),
        reads: Sequence[Kind[Any]] = (),
    ) -> None:
        super().__init__(NoParams(), name=name)
        self.triggers, self.posts, self.reads = triggers, posts, reads

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        raise AssertionError("nothing runs here")


def refusal(*sources: Source) -> str:
    with pytest.raises(MissionError) as caught:
        check_wiring(SonarRobot(NoParams(), name="robot"), sources, [], None)
    text = str(caught.value)
    assert "\n" not in text
    return text


def test_a_sound_mission_gets_its_vocabulary() -> None:
    own: Kind[Pose] = slot("hypotheses/symbol/mug", Pose, "a mug")
    sources = [Source("pose", [ODOMETRY], [ODOM_FROM_ROBOT]), Source("mug", [ODOM_FROM_ROBOT], [own])]
    vocabulary = check_wiring(SonarRobot(NoParams(), name="robot"), sources, [], None)
    assert own in vocabulary


def test_two_posters_of_one_slot() -> None:
    a, b = Source("a", [ODOMETRY], [MAP_FROM_ODOM]), Source("b", [ODOMETRY], [MAP_FROM_ODOM])
    assert refusal(a, b) == "'hypotheses/feature/map_from_odom' has two posters, a and b; leave one of them out"
    assert "two posters, the runner and a" in refusal(Source("a", [ODOMETRY], [DRIVE]))
    assert "two posters, robot and a" in refusal(Source("a", [SONAR_SCAN], [ODOMETRY]))


def test_a_trigger_that_nobody_posts() -> None:
    assert refusal(Source("finder", [SUPPORTED_POINTS], [LINE])).startswith(
        "finder waits for 'observations/feature/supported_points', which nobody in this mission posts"
    )
    assert "finder waits for 'observations/signal/laser_scan'" in refusal(Source("finder", [LASER_SCAN], [LINE]))
    assert "has no triggers" in refusal(Source("finder", [], [LINE]))


def test_a_reading_that_this_robot_lacks_is_allowed_beside_one_that_it_has() -> None:
    grid = Source("grid", [SONAR_SCAN, LASER_SCAN])
    check_wiring(SonarRobot(NoParams(), name="robot"), [grid], [], None)


def test_what_no_robot_knows_is_for_scores_only() -> None:
    assert refusal(Source("cheat", [SONAR_SCAN], reads=[TRUE_POSE])) == (
        "cheat reads 'status/true_pose', which no robot knows: it is for scores only"
    )


def test_reading_an_unknown_kind() -> None:
    own: Kind[Pose] = slot("observations/feature/odom_from_robots", Pose, "misspelt")
    text = refusal(Source("a", [ODOMETRY], reads=[own]))
    assert "a reads the unknown kind 'observations/feature/odom_from_robots'" in text
    assert "did you mean 'observations/feature/odom_from_robot'?" in text


def test_a_ring_that_would_never_rest() -> None:
    a = Source("a", [ODOMETRY, MAP_FROM_ODOM], [ODOM_FROM_ROBOT])
    b = Source("b", [ODOM_FROM_ROBOT], [MAP_FROM_ODOM])
    text = refusal(a, b)
    assert "would wake each other without end" in text
    assert "a (observations/feature/odom_from_robot) -> b" in text
    assert "without end" in refusal(Source("self", [ODOMETRY, LINE], [LINE]))
    calm = Source("b", [Trigger(ODOM_FROM_ROBOT, min_interval_s=1.0)], [MAP_FROM_ODOM])
    check_wiring(SonarRobot(NoParams(), name="robot"), [a, calm], [], None)


def test_one_path_for_two_types() -> None:
    other: Kind[Pose] = slot("observations/feature/supported_points", Pose, "not what it says")
    with pytest.raises(BoardError, match="declared twice, for PointSet and Pose"):
        check_wiring(SonarRobot(NoParams(), name="robot"), [Source("a", [ODOMETRY], [other])], [], None)
