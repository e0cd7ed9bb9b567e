"""Where the robot was at a stamp, out of the poses on the board.

Reads  observations/feature/odom_from_robot    Pose
       hypotheses/feature/map_from_odom        Pose
"""

from blackboard.access import Access
from blackboard.entry import Entry
from blackboard.kinds import MAP_FROM_ODOM, ODOM_FROM_ROBOT
from blackboard.messages.geometry import IDENTITY, Pose, interpolate, wrap_angle

READS = (ODOM_FROM_ROBOT, MAP_FROM_ODOM)
LONGEST_GAP_S = 2.0  # between two poses that are interpolated: a robot may do anything in a longer one
LONGEST_REACH_S = 0.3  # beyond the newest pose, at its speed: a few periods of common odometry
SHORTEST_BASE_S = 0.05  # between two poses that give a speed: repaired stamps may lie a microsecond apart


def map_from_robot_at(board: Access, stamp_s: float) -> tuple[Pose, tuple[Entry[Pose], ...]] | None:
    """Return map_from_robot at `stamp_s` and the entries that it stands on; None where no pose is near enough in time.

    Between two poses it is interpolated; after the newest it goes on at its speed for LONGEST_REACH_S.
    """
    odometry = odom_from_robot_at(board, stamp_s)
    if odometry is None:
        return None
    odom_from_robot, supports = odometry
    correction = board.newest(MAP_FROM_ODOM)
    if correction is None:
        return IDENTITY @ odom_from_robot, supports
    return correction.value @ odom_from_robot, (*supports, correction)


def odom_from_robot_at(board: Access, stamp_s: float) -> tuple[Pose, tuple[Entry[Pose], ...]] | None:
    """Return odom_from_robot at `stamp_s` and the entries that it stands on, as `map_from_robot_at` does."""
    before, after = board.around(ODOM_FROM_ROBOT, stamp_s)
    if before is not None and before.stamp_s == stamp_s:
        return before.value, (before,)
    if before is not None and after is not None:
        if after.stamp_s - before.stamp_s <= LONGEST_GAP_S:
            fraction = (stamp_s - before.stamp_s) / (after.stamp_s - before.stamp_s)
            return interpolate(before.value, after.value, fraction), (before, after)
        nearest = before if stamp_s - before.stamp_s <= after.stamp_s - stamp_s else after
        return (nearest.value, (nearest,)) if abs(nearest.stamp_s - stamp_s) <= LONGEST_REACH_S else None
    if after is not None:  # before the first pose
        return (after.value, (after,)) if after.stamp_s - stamp_s <= LONGEST_REACH_S else None
    if before is None or stamp_s - before.stamp_s > LONGEST_REACH_S:
        return None
    earlier, _ = board.around(ODOM_FROM_ROBOT, before.stamp_s - SHORTEST_BASE_S)
    if earlier is None or before.stamp_s - earlier.stamp_s > LONGEST_GAP_S:
        return before.value, (before,)
    fraction = (stamp_s - earlier.stamp_s) / (before.stamp_s - earlier.stamp_s)
    return interpolate(earlier.value, before.value, fraction), (earlier, before)


def moved_on(last: Pose | None, pose: Pose, step_m: float, turn_rad: float) -> bool:
    """Say whether a pose lies a step or a turn away from the last one that counted; the first counts."""
    return (
        last is None
        or pose.distance_m(last) >= step_m
        or abs(wrap_angle(pose.heading_rad - last.heading_rad)) >= turn_rad
    )
