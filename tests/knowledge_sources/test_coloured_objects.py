"""Looking for drums of a colour and size: suspected, confirmed from several places, hidden in part, of another size, made up."""

from math import asin, atan2, hypot, pi, radians

import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.errors import MissionError
from blackboard.kinds import BLOBS, FOUND_OBJECT, ODOM_FROM_ROBOT, ROBOT
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.sensing import Blob, BlobScan, CameraSensor, RobotDescription
from blackboard.messages.symbols import FoundObject
from blackboard.vocabulary import Vocabulary
from knowledge_sources.coloured_objects import ColouredObjects, ColouredObjectsParams, sighting_of

CAMERA = CameraSensor(mount=Pose(x_m=0.2, y_m=0.0, heading_rad=0.0), field_rad=radians(60), max_range_m=4.0)
DESCRIPTION = RobotDescription(
    name="r", radius_m=0.3, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=1.0, cameras=(CAMERA,)
)
PARAMS = ColouredObjectsParams()
DRUM_M = 0.29
Thing = tuple[float, float, float]  # x, y, radius


class Story:
    """A robot that looks from place to place at things that stand there."""

    def __init__(self, params: ColouredObjectsParams = PARAMS) -> None:
        self.board = Board(Vocabulary(), robot="r")
        self.board.post(ROBOT, DESCRIPTION, source="r")
        self.source = ColouredObjects(params, name="coloured_objects")
        self.access = Access(self.board, "coloured_objects", (BLOBS, *self.source.reads), self.source.posts)

    def look(self, pose: Pose, *things: Thing, colour: str = "green", share: float = 1.0) -> None:
        """See things from a place, `share` of their width."""
        camera = pose @ CAMERA.mount
        blobs = []
        for x, y, radius in things:
            dx, dy = x - camera.x_m, y - camera.y_m
            bearing, width = wrap_angle(atan2(dy, dx) - camera.heading_rad), 2 * asin(radius / hypot(dx, dy))
            if abs(bearing) + width / 2 < CAMERA.field_rad / 2 and hypot(dx, dy) < CAMERA.max_range_m:
                blobs.append(Blob(bearing_rad=bearing, width_rad=share * width, colour=colour))
        self.scan(pose, *blobs)

    def scan(self, pose: Pose, *blobs: Blob) -> None:
        self.board.now_s += 0.25
        self.board.post(ODOM_FROM_ROBOT, pose, source="odometry_pose")
        entry = self.board.post(BLOBS, BlobScan(blobs=blobs), source="r")
        self.source.activate(entry, self.access)

    def found(self) -> list[Entry[FoundObject]]:
        return self.board.entries(FOUND_OBJECT)

    def confirmed(self) -> list[FoundObject]:
        return [entry.value for entry in self.found() if entry.value.standing == "confirmed"]


def facing(x: float, y: float, thing: Thing) -> Pose:
    return Pose(x_m=x, y_m=y, heading_rad=atan2(thing[1] - y, thing[0] - x))


def drive_by(story: Story, thing: Thing, **seen: float) -> None:
    for step in range(12):
        story.look(facing(0.25 * step, 0.0, thing), thing, **seen)  # type: ignore[arg-type]


def test_a_drum_is_suspected_at_once_and_confirmed_on_the_way_past_it() -> None:
    story, drum = Story(), (2.0, 2.0, DRUM_M)
    story.look(facing(0.0, 0.0, drum), drum)
    assert story.found() == []
    story.look(facing(0.0, 0.0, drum), drum)
    (entry,) = story.found()
    assert (entry.id, entry.value.standing, entry.value.places) == ("drum-1", "suspected", 1)
    assert hypot(entry.value.place.x_m - 2.0, entry.value.place.y_m - 2.0) < 0.05
    drive_by(story, drum)
    (entry,) = story.found()
    found = entry.value
    assert (entry.id, found.standing, found.object, found.colour) == ("drum-1", "confirmed", "drum", "green")
    assert hypot(found.place.x_m - 2.0, found.place.y_m - 2.0) < 0.03
    assert found.radius_m == pytest.approx(DRUM_M, abs=0.02)
    reasons = {e.about: (e.verdict, e.strength) for e in entry.endorsements}
    assert reasons == {"colour": ("for", "strong"), "size": ("for", "fair")}
    assert {support.key for support in entry.supports} >= {"ski/r/observations/signal/blobs"}


def test_looking_on_from_one_place_confirms_nothing() -> None:
    story, drum = Story(), (2.0, 0.5, DRUM_M)
    for _ in range(40):
        story.look(facing(0.0, 0.0, drum), drum)
    assert [entry.value.standing for entry in story.found()] == ["suspected"]


def test_a_bucket_of_the_colour_is_none() -> None:
    story = Story()
    drive_by(story, (1.5, 1.6, 0.14))
    assert story.confirmed() == []


def test_another_colour_is_none() -> None:
    story, drum = Story(), (2.0, 2.0, DRUM_M)
    for step in range(12):
        story.look(facing(0.25 * step, 0.0, drum), drum, colour="red")
    assert story.found() == []


def test_what_hides_a_part_moves_nothing() -> None:
    story, drum = Story(), (2.0, 2.0, DRUM_M)
    drive_by(story, drum)
    (before,) = story.confirmed()
    drive_by(story, drum, share=0.5)
    (after,) = story.found()
    assert (after.value.place, after.value.standing) == (before.place, "confirmed")


def test_one_that_is_hidden_at_first_ends_as_one_drum() -> None:
    story, drum = Story(), (2.0, 2.0, DRUM_M)
    for step in range(3):
        story.look(facing(0.1 * step, -0.5, drum), drum, share=0.6)
    drive_by(story, drum)
    (found,) = story.confirmed()
    assert hypot(found.place.x_m - 2.0, found.place.y_m - 2.0) < 0.1
    for _ in range(130):
        story.scan(Pose(x_m=0.0, y_m=0.0, heading_rad=pi))
    assert len(story.found()) == 1


def test_two_drums_side_by_side_are_two() -> None:
    story, left, right = Story(), (1.2, 2.2, DRUM_M), (2.2, 2.2, DRUM_M)
    for step in range(14):
        story.look(facing(0.25 * step, 0.0, (1.7, 2.2, 0.0)), left, right)
    assert sorted(round(found.place.x_m, 1) for found in story.confirmed()) == [1.2, 2.2]


def test_what_was_made_up_is_taken_back() -> None:
    story = Story()
    pose = Pose(x_m=0.0, y_m=0.0, heading_rad=0.0)
    for _ in range(2):
        story.scan(pose, Blob(bearing_rad=0.1, width_rad=0.2, colour="green"))
    assert len(story.found()) == 1
    for _ in range(121):
        story.scan(pose)
    assert story.found() == []


def test_what_says_nothing_is_left_out() -> None:
    pose = Pose(x_m=0.0, y_m=0.0, heading_rad=0.0)
    good = Blob(bearing_rad=0.1, width_rad=0.2, colour="green")
    assert sighting_of(good, pose, CAMERA, PARAMS) is not None
    assert sighting_of(Blob(bearing_rad=0.1, width_rad=0.2, colour="red"), pose, CAMERA, PARAMS) is None
    at_the_edge = Blob(bearing_rad=radians(26), width_rad=radians(8), colour="green")
    assert sighting_of(at_the_edge, pose, CAMERA, PARAMS) is None
    as_if_far_off = Blob(bearing_rad=0.0, width_rad=2 * asin(DRUM_M / 5.2), colour="green")
    assert sighting_of(as_if_far_off, pose, CAMERA, PARAMS) is None


def test_parameters_have_limits() -> None:
    with pytest.raises(MissionError, match="radius_m = 0"):
        ColouredObjectsParams(radius_m=0.0)
    with pytest.raises(MissionError, match="colour = 'dark green'"):
        ColouredObjectsParams(colour="dark green")
