"""Where simulated robots start, and what is refused: inside a wall, on somebody's feet, on another robot, in another world."""

from collections.abc import Sequence
from math import hypot, inf
from pathlib import Path

import shapely

from blackboard.errors import MissionError
from blackboard.messages.geometry import Pose, wrap_angle
from sim.people import Person
from sim.world import World, free_place

WORLD_KEYS = ("world", "world_seed", "people", "disturbances")  # parameters that all robots of a world have alike
GAP_M = 0.01  # at least this is left to people and to other robots


def start_pose(world: World, wanted: Pose | None, heading_rad: float | None, radius_m: float, people: bool) -> Pose:
    """Return where a robot of this radius starts, given the place that is wanted and whether people walk in the world.

    Raises MissionError where it does not fit.
    """
    pose = world.start_pose(wanted, radius_m)
    if heading_rad is not None:
        pose = Pose(x_m=pose.x_m, y_m=pose.y_m, heading_rad=wrap_angle(heading_rad))
    for number, person in enumerate(world.people if people else (), 1):
        if _away_m(pose, person) < radius_m + person.radius_m + GAP_M:
            raise MissionError(f"{world.name}: [[person]] {number} starts where the robot starts; move one of them")
    return pose


def check_same_world(mine: object, theirs: object, name: str) -> None:
    """Raise MissionError where a robot's parameters are of another world than those of the robot called `name`."""
    for key in WORLD_KEYS:
        here, there = getattr(mine, key), getattr(theirs, key)
        if here != there:
            raise MissionError(f"{key} = {_shown(here)} is not that of '{name}', {_shown(there)}: robots share a world")


def check_apart(world: World, start: Pose, radius_m: float, others: Sequence[tuple[str, Pose, float]]) -> None:
    """Raise MissionError where a start is too near to those of other robots: name, start, radius of each."""
    for name, pose, other_radius_m in others:
        gap_m = pose.distance_m(start) - radius_m - other_radius_m
        if gap_m < GAP_M:
            away = f"overlaps '{name}'" if gap_m < 0.0 else f"is {gap_m:.3f} m from '{name}'"
            raise MissionError(
                f"start_x_m = {start.x_m:g}, start_y_m = {start.y_m:g}: the robot {away}, which starts at "
                f"({pose.x_m:g}, {pose.y_m:g}); move one of them{_hint(world, radius_m, others)}"
            )


def _hint(world: World, radius_m: float, others: Sequence[tuple[str, Pose, float]]) -> str:
    """Name a place where the robot fits beside the others."""
    discs = [shapely.buffer(shapely.Point(pose.x_m, pose.y_m), other_m) for _, pose, other_m in others]
    left = world.open_floor().difference(shapely.union_all(discs))
    if left.is_empty:
        return ""
    place = free_place(left)
    gap_m = min(hypot(pose.x_m - place.x_m, pose.y_m - place.y_m) - other_m for _, pose, other_m in others)
    walls_m = float(world.shapes.distances_m(place.x_m, place.y_m)[0].min(initial=inf))
    return f", for example to ({place.x_m:.2f}, {place.y_m:.2f})" if min(gap_m, walls_m) >= radius_m + GAP_M else ""


def _away_m(pose: Pose, person: Person) -> float:
    return pose.distance_m(Pose(x_m=person.path[0][0], y_m=person.path[0][1], heading_rad=0.0))


def _shown(value: object) -> str:
    return f"'{value}'" if isinstance(value, Path) else str(value).lower() if isinstance(value, bool) else repr(value)
