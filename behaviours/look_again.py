"""Goes where a resolution task wants the robot to stand, over floor that is known to be empty, and faces what is in doubt.

Reads  motivations/resolution_task             ResolutionTask
       hypotheses/feature/grid                 GridTile
       hypotheses/feature/map_from_odom        Pose
       observations/feature/odom_from_robot    Pose
       status/robot                            RobotDescription

Bou-Ghannam 1992, section 2.6: a behaviour scans the object from a variety of view points. It plans no ways: it
goes only where the straight way is empty on the map; otherwise it is silent, until wandering brings the robot to where it is.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import atan2, cos, hypot, sin

from behaviours.whereabouts import POSE_READS, map_from_robot
from blackboard.access import Access
from blackboard.component import Behaviour
from blackboard.entry import Entry
from blackboard.grid import Grid, way_is_empty
from blackboard.kinds import GRID, RESOLUTION_TASK, ROBOT
from blackboard.messages.conflicts import ResolutionTask
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.motion import Response
from blackboard.parameters import require

SLOW_M = 0.5  # within that of its goal the robot goes slower
FACED_RAD = 0.1
MOST_DOUBLINGS = 10
TURN_GAIN_PER_S = 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class LookAgainParams:
    """How it goes, how long it looks, and how long it keeps away from what it could not reach or has looked at."""

    strength: float = 0.7  # of the vector: below what avoid-obstacles answers with near an obstacle
    turn_radps: float = 0.6
    near_m: float = 0.15  # so near to the stand it has arrived
    margin_m: float = 0.05  # to either side of the robot, of the way that must be empty
    look_s: float = 4.0
    check_s: float = 1.0  # how often the way is looked at on the map
    patience_s: float = 40.0  # for one way: several times what crossing a room takes
    rest_s: float = (
        30.0  # before the same task is tried again; twice as long each time: one look more may help, ten will not
    )

    def __post_init__(self) -> None:
        require(0.1 <= self.strength <= 1.0, "strength", self.strength, "[0.1, 1]")
        require(0.05 <= self.turn_radps <= 3.0, "turn_radps", self.turn_radps, "[0.05, 3]")
        for name in ("near_m", "margin_m"):
            require(0.0 <= getattr(self, name) <= 1.0, name, getattr(self, name), "[0, 1] metres")
        for name in ("look_s", "check_s", "patience_s", "rest_s"):
            require(0.0 <= getattr(self, name) <= 3600.0, name, getattr(self, name), "[0, 3600] seconds")


def approach(pose: Pose, x_m: float, y_m: float, params: LookAgainParams) -> Response:
    """Return the vector towards a place, shorter near it."""
    dx, dy = x_m - pose.x_m, y_m - pose.y_m
    distance = hypot(dx, dy)
    length = params.strength * min(1.0, max(distance / SLOW_M, 0.3))
    bearing = atan2(dy, dx) - pose.heading_rad
    return Response(forward=length * cos(bearing), left=length * sin(bearing))


def face(pose: Pose, x_m: float, y_m: float, params: LookAgainParams) -> tuple[bool, Response]:
    """Return whether the robot faces a place, and the turn towards it."""
    bearing = wrap_angle(atan2(y_m - pose.y_m, x_m - pose.x_m) - pose.heading_rad)
    turn = max(-params.turn_radps, min(params.turn_radps, TURN_GAIN_PER_S * bearing))
    return abs(bearing) <= FACED_RAD, Response(turn_radps=turn)


def chosen(
    tasks: Iterable[Entry[ResolutionTask]], pose: Pose, grid: Grid, half_width_m: float
) -> Entry[ResolutionTask] | None:
    """Return the task with the nearest stand to which the straight way is empty; of equal ones the first."""
    near: list[tuple[float, int, Entry[ResolutionTask], tuple[float, float]]] = []
    for task in tasks:
        stand = task.value.stand
        if stand is not None:
            near.append((hypot(stand.x_m - pose.x_m, stand.y_m - pose.y_m), len(near), task, (stand.x_m, stand.y_m)))
    for _, _, task, goal in sorted(near, key=lambda item: item[:2]):
        if way_is_empty(grid, (pose.x_m, pose.y_m), goal, half_width_m):
            return task
    return None


class LookAgain(Behaviour[LookAgainParams]):
    """Brings the robot to where a doubt can be resolved."""

    Params = LookAgainParams
    reads = (RESOLUTION_TASK, GRID, *POSE_READS, ROBOT)

    def __init__(self, params: LookAgainParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._task: str | None = None
        self._until_s = 0.0  # when it gives up the way, or has looked long enough
        self._arrived = self._faced = False
        self._checked_s = float("-inf")
        self._rest: dict[str, float] = {}  # by task: not before then
        self._tries: dict[str, int] = {}

    def select(self, parameters: tuple[float | str, ...]) -> None:
        self._task = None
        self._arrived = self._faced = False
        self._checked_s = float("-inf")

    def respond(self, board: Access) -> Response | None:
        pose = map_from_robot(board)
        if pose is None:
            return None
        now_s, task = board.now_s, self._standing(board)
        if task is not None and now_s >= self._until_s:
            self._leave(task)
            task = None
        if not self._arrived and now_s - self._checked_s >= self.params.check_s:
            self._checked_s = now_s
            task = self._choose(task, pose, board)
        if task is None or task.value.stand is None:
            return None
        board.newest(RESOLUTION_TASK, task.id)  # what it answers to
        stand, place = task.value.stand, task.value.place or task.value.stand
        if not self._arrived:
            if hypot(stand.x_m - pose.x_m, stand.y_m - pose.y_m) > self.params.near_m:
                return approach(pose, stand.x_m, stand.y_m, self.params)
            self._arrived, self._until_s = True, now_s + self.params.patience_s
        facing, turn = face(pose, place.x_m, place.y_m, self.params)
        if facing and not self._faced:
            self._faced, self._until_s = True, now_s + self.params.look_s
        return turn

    def _standing(self, board: Access) -> Entry[ResolutionTask] | None:
        if self._task is None:
            return None
        task = next((t for t in board.entries(RESOLUTION_TASK) if t.id == self._task), None)
        if task is not None and task.value.outcome == "open":
            return task
        self._task = None
        self._arrived = self._faced = False
        return None

    def _leave(self, task: Entry[ResolutionTask]) -> None:
        tries = self._tries[str(task.id)] = self._tries.get(str(task.id), 0) + 1
        self._rest[str(task.id)] = self._until_s + self.params.rest_s * 2 ** min(tries - 1, MOST_DOUBLINGS)
        self._task = None
        self._arrived = self._faced = False

    def _choose(self, task: Entry[ResolutionTask] | None, pose: Pose, board: Access) -> Entry[ResolutionTask] | None:
        """Return the task to go for from here, or go on with: the way is looked at anew."""
        now_s = board.now_s
        tasks = [t for t in board.entries(RESOLUTION_TASK) if t.value.outcome == "open"]
        self._rest = {str(t.id): self._rest[str(t.id)] for t in tasks if str(t.id) in self._rest}
        self._tries = {name: self._tries[name] for name in self._rest}
        due = [t for t in tasks if t.value.not_before_s <= now_s and self._rest.get(str(t.id), now_s) <= now_s]
        robot = board.newest(ROBOT)
        grid = Grid.from_tiles(e.value for e in board.entries(GRID)) if due and robot is not None else None
        if grid is None or robot is None:
            self._task = None
            return None
        half_width_m = robot.value.radius_m + self.params.margin_m
        if task is not None:
            if chosen([task], pose, grid, half_width_m) is not None:
                return task
            self._until_s = now_s
            self._leave(task)
            due = [t for t in due if t.id != task.id]
        found = chosen(due, pose, grid, half_width_m)
        self._task = None if found is None else found.id
        self._until_s = now_s + self.params.patience_s
        return found
