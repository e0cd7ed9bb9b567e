"""What was heard near the robot during the last seconds, moved along by odometry.

Between the cones of a sonar ring lie blind gaps, and a smooth wall at a slant swallows echoes, so the newest scan alone
may not show what the robot is about to touch. Each user keeps a memory of its own: the safety layer leans on no behaviour.

Reads  status/robot                     RobotDescription
       observations/signal/odometry     Odometry
       observations/signal/sonar_scan   SonarScan
       observations/signal/laser_scan   LaserScan
       observations/signal/bumper       Bumper
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, cos, floor, inf, pi, sin, sqrt
from typing import Any, NamedTuple, TypeVar

from behaviours.echo_sightings import Look, Sighting, contacts, laser_looks, sightings, sonar_looks
from blackboard.access import Access
from blackboard.entry import Entry, Support
from blackboard.kinds import BUMPER, LASER_SCAN, ODOMETRY, ROBOT, SONAR_SCAN, Kind
from blackboard.messages.base import Message
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.sensing import Odometry
from blackboard.parameters import require

READS: tuple[Kind[Any], ...] = (ROBOT, ODOMETRY, SONAR_SCAN, LASER_SCAN, BUMPER)
LONGEST_STEP_S = 1.0  # an odometry reading is carried no further than this
SPARED_M = 0.3  # what was heard this near to a sensor is not doubted: a thing beside the cone is soon touched
DOUBT_LIMIT = 2  # so many readings through an echo clear it
TURNS = 3  # every third sensor's reading is looked at, in turn: what has gone is cleared soon enough, at a third of the cost
TIDY_S = 0.5  # how often old and far echoes are left out

BESIDE = (
    (0, 0),
    (-1, 0),
    (1, 0),
    (0, -1),
    (0, 1),
    (-1, -1),
    (-1, 1),
    (1, -1),
    (1, 1),
)  # a cell and its eight neighbours
MOST_UNREAD = 16  # readings of one kind that are looked at in one cycle

M = TypeVar("M", bound=Message)
Cell = tuple[int, int]
Near = tuple[float, float, float, float, bool]
"""One remembered echo as it lies from where the robot is now, robot frame: distance from the robot's centre (m), bearing and half
the width of its cone (rad), when it was heard (s), and whether it is settled. Plain, since many are made each cycle."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NearEchoesParams:
    """How far and how long echoes are remembered."""

    reach_m: float = 1.2  # from the rim: about where a thing on the path leaves the swinging forward cone of 12 degrees
    keep_s: float = 20.0  # long enough to creep through the gap beside that cone, and to turn about beside a thing
    keep_new_s: float = 4.0  # for what was heard just once or twice: a person walking by, cross-talk
    cell_m: float = 0.1  # echoes in one cell count as one
    settled_after_s: float = 0.35  # heard in a cell or beside it so long ago: what walks at 0.5 m/s has left by then
    look_through_m: float = 0.3  # a reading must go so far beyond an echo to speak against it
    gap_s: float = 2.0  # after no reading for so long (nobody asked, or the sensors were silent) the memory begins anew

    def __post_init__(self) -> None:
        require(1.0 <= self.reach_m <= 10.0, "reach_m", self.reach_m, "[1, 10]")
        require(2.0 <= self.keep_s <= 60.0, "keep_s", self.keep_s, "[2, 60]")
        require(1.0 <= self.keep_new_s <= self.keep_s, "keep_new_s", self.keep_new_s, "[1, keep_s]")
        require(0.02 <= self.cell_m <= 0.3, "cell_m", self.cell_m, "[0.02, 0.3]")
        require(0.2 <= self.settled_after_s <= 2.0, "settled_after_s", self.settled_after_s, "[0.2, 2]")
        require(0.1 <= self.look_through_m <= 2.0, "look_through_m", self.look_through_m, "[0.1, 2]")
        require(0.5 <= self.gap_s <= 60.0, "gap_s", self.gap_s, "[0.5, 60]")


class Echo(NamedTuple):
    """One remembered echo: odometry frame."""

    x_m: float
    y_m: float
    heard_s: float
    since_s: float  # when something was first heard in this cell
    settled: bool  # it was heard about here before: it stands still
    half_cone_rad: float
    doubt: int  # how many readings since have gone through it


@dataclass(frozen=True, slots=True, kw_only=True)
class NearEchoes:
    """The memory: echoes by cell of the odometry frame, and the revisions up to which readings have entered it."""

    echoes: dict[Cell, Echo]
    sonars_s: dict[int, float]  # when each sonar was last heard from
    tidied_s: float = -inf  # when old and far echoes were last left out
    read_s: float = inf  # the newest reading in it
    sonar_revision: int = -1
    laser_revision: int = -1
    bumper_revision: int = -1


def no_echoes() -> NearEchoes:
    """Return a memory that holds nothing."""
    return NearEchoes(echoes={}, sonars_s={})


def pose_at(odometry: Odometry, odometry_s: float, stamp_s: float) -> Pose:
    """Return odom_from_robot at `stamp_s`, a little before or after the odometry reading, by its speeds."""
    dt_s = max(-LONGEST_STEP_S, min(LONGEST_STEP_S, stamp_s - odometry_s))
    if dt_s == 0.0:
        return odometry.pose
    turn_rad = odometry.turn_radps * dt_s
    course_rad = odometry.pose.heading_rad + 0.5 * turn_rad
    step_m = odometry.forward_mps * dt_s
    return Pose(
        x_m=odometry.pose.x_m + step_m * cos(course_rad),
        y_m=odometry.pose.y_m + step_m * sin(course_rad),
        heading_rad=wrap_angle(odometry.pose.heading_rad + turn_rad),
    )


def forget(
    echoes: dict[Cell, Echo], pose: Pose, stamp_s: float, within_m: float, params: NearEchoesParams
) -> dict[Cell, Echo]:
    """Return a new dict without the echoes that are too old or further than `within_m` from the pose."""
    limit_m2 = within_m * within_m
    kept = {}
    for cell, echo in echoes.items():
        x, y, heard_s, _, settled, _, _ = echo
        keep_s = params.keep_s if settled else params.keep_new_s
        if stamp_s - heard_s <= keep_s and (x - pose.x_m) ** 2 + (y - pose.y_m) ** 2 <= limit_m2:
            kept[cell] = echo
    return kept


def look_through(echoes: dict[Cell, Echo], looks: list[Look], pose: Pose, params: NearEchoesParams) -> None:
    """Let each look that ended in an echo cast doubt on what it went through along its axis; silence proves nothing."""
    c, s, cell_m = cos(pose.heading_rad), sin(pose.heading_rad), params.cell_m
    skipped = int(SPARED_M / cell_m)
    for look in looks:
        steps = int(min(look.range_m - params.look_through_m, params.reach_m) / cell_m) + 1
        if not look.echo or steps <= skipped:
            continue
        heading_rad = pose.heading_rad + look.heading_rad
        dx, dy = cell_m * cos(heading_rad), cell_m * sin(heading_rad)
        x = pose.x_m + c * look.x_m - s * look.y_m + skipped * dx
        y = pose.y_m + s * look.x_m + c * look.y_m + skipped * dy
        for _ in range(skipped, steps):
            cell = (floor(x / cell_m), floor(y / cell_m))
            echo = echoes.get(cell)
            if echo is not None:
                if echo.doubt + 1 >= DOUBT_LIMIT:
                    del echoes[cell]
                else:
                    echoes[cell] = echo._replace(doubt=echo.doubt + 1)
            x, y = x + dx, y + dy


def enter(
    echoes: dict[Cell, Echo], found: list[Sighting], pose: Pose, stamp_s: float, params: NearEchoesParams
) -> None:
    """Enter new sightings; one is settled if something was heard in its cell or beside it long enough ago."""
    c, s, cell_m = cos(pose.heading_rad), sin(pose.heading_rad), params.cell_m
    before_s = stamp_s - params.settled_after_s
    new: dict[Cell, Echo] = {}
    for x, y, half_cone_rad in found:
        px, py = pose.x_m + c * x - s * y, pose.y_m + s * x + c * y
        i, j = floor(px / cell_m), floor(py / cell_m)
        here = echoes.get((i, j))
        settled = False
        for di, dj in BESIDE:
            known = echoes.get((i + di, j + dj))
            if known is not None and known.since_s <= before_s:
                settled = True
                break
        since_s = here.since_s if here is not None else stamp_s
        new[(i, j)] = Echo(px, py, stamp_s, since_s, settled, half_cone_rad, 0)
    echoes.update(new)


def around(memory: NearEchoes, pose: Pose, within_m: float) -> list[Near]:
    """Return the remembered echoes as they lie from `pose` (odom_from_robot), up to `within_m` from the robot's centre."""
    x0, y0, offset_rad = pose.x_m, pose.y_m, pi - pose.heading_rad
    limit_m2, whole_rad = within_m * within_m, 2.0 * pi
    nears = []
    for x, y, heard_s, _, settled, half_cone_rad, _ in memory.echoes.values():
        dx, dy = x - x0, y - y0
        distance_m2 = dx * dx + dy * dy
        if distance_m2 <= limit_m2:
            bearing_rad = (atan2(dy, dx) + offset_rad) % whole_rad - pi
            nears.append((sqrt(distance_m2), bearing_rad, half_cone_rad, heard_s, settled))
    return nears


def refresh(memory: NearEchoes, board: Access, params: NearEchoesParams) -> NearEchoes:
    """Return the memory with the readings that are new on the board; the same object where there are none."""
    robot_entry, odometry_entry = board.newest(ROBOT), board.newest(ODOMETRY)
    sonars = unread(board, SONAR_SCAN, memory.sonar_revision)
    lasers = unread(board, LASER_SCAN, memory.laser_revision)
    bumpers = unread(board, BUMPER, memory.bumper_revision)
    if robot_entry is None or odometry_entry is None or not (sonars or lasers or bumpers):
        return memory
    robot, odometry, odometry_s = robot_entry.value, odometry_entry.value, odometry_entry.stamp_s
    within_m = robot.radius_m + params.reach_m
    news: list[tuple[Entry[Any], list[Look], list[Sighting]]] = []
    sonars_s = dict(memory.sonars_s)
    for sonar in sonars:
        sonars_s.update(dict.fromkeys(sonar.value.sensors, sonar.stamp_s))
        looks = sonar_looks(sonar.value, robot)
        news.append((sonar, looks, sightings(looks, within_m)))
    for laser in lasers:
        looks = laser_looks(laser.value, robot)
        news.append((laser, looks, sightings(looks, within_m)))
    news += [(bumper, [], contacts(bumper.value, robot)) for bumper in bumpers]
    news = [
        item for item in news if item[0].stamp_s >= odometry_s - LONGEST_STEP_S
    ]  # nobody knows where others were taken
    read_s = max((item[0].stamp_s for item in news), default=memory.read_s)
    stale = read_s - memory.read_s > params.gap_s
    echoes, tidied_s = {} if stale else dict(memory.echoes), memory.tidied_s
    if board.now_s - tidied_s >= TIDY_S:
        echoes, tidied_s = forget(echoes, odometry.pose, board.now_s, within_m, params), board.now_s
    for entry, looks, found in news:
        pose = pose_at(odometry, odometry_s, entry.stamp_s)
        look_through(echoes, looks[entry.revision % TURNS :: TURNS], pose, params)
        enter(echoes, found, pose, entry.stamp_s, params)
    return NearEchoes(
        echoes=echoes,
        sonars_s=sonars_s,
        tidied_s=tidied_s,
        read_s=read_s,
        sonar_revision=sonars[-1].revision if sonars else memory.sonar_revision,
        laser_revision=lasers[-1].revision if lasers else memory.laser_revision,
        bumper_revision=bumpers[-1].revision if bumpers else memory.bumper_revision,
    )


def around_now(memory: NearEchoes, board: Access, reach_m: float) -> list[Near]:
    """Return what lies around the robot at the mission's time now, up to `reach_m` from its rim."""
    robot, odometry = board.newest(ROBOT), board.newest(ODOMETRY)
    if robot is None or odometry is None:
        return []
    pose = pose_at(odometry.value, odometry.stamp_s, board.now_s)
    return around(memory, pose, robot.value.radius_m + reach_m)


def unread(board: Access, kind: Kind[M], after_revision: int) -> Sequence[Entry[M]]:
    """Return the entries of a slot that came after a revision, oldest first: sonars may post several in a cycle."""
    newest = board.newest(kind)
    if newest is None or newest.revision <= after_revision:
        return ()
    if after_revision < 0 or newest.revision == after_revision + 1:
        return (newest,)
    first = max(after_revision + 1, newest.revision - MOST_UNREAD)
    return board.revisions(Support(newest.key, first, newest.revision)) or (newest,)
