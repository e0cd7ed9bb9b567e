"""Trap detector: the robot is told to drive and stays where it is.

Triggered by  observations/feature/odom_from_robot    Pose: at most once in an interval
Reads         commands/velocity, hypotheses/feature/map_from_odom, status/robot
Posts         hypotheses/symbol/trap/no_progress-<n>  Trap

It stands still before something, or rocks to and fro. Turning on the spot asks for no way, so it is no trap. Source: Bou-Ghannam
1992, sections 3.4 (oscillations, inability to pass between closely spaced obstacles) and 6.2 ("when some time has passed without
any progress, the planning module would have intervened").
"""

from collections import deque
from dataclasses import dataclass
from itertools import pairwise
from math import hypot
from typing import Any, NamedTuple

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry
from blackboard.kinds import ODOM_FROM_ROBOT, ROBOT, TRAP, VELOCITY
from blackboard.messages.geometry import Point, Pose
from blackboard.messages.symbols import Trap
from blackboard.parameters import require
from knowledge_sources.poses import READS, map_from_robot_at
from knowledge_sources.standing_hypotheses import Episodes, Found, Reason

WHY = "it is told to drive and stays there"


@dataclass(frozen=True, slots=True, kw_only=True)
class NoProgressTrapParams:
    """How long the robot may want to drive without getting anywhere."""

    interval_s: float = 0.5
    window_s: float = 20.0  # the longest that a robot may take to turn its way out of a corner
    reach_radii: float = 2.0  # of the robot: it stayed within a circle so wide
    wanted_radii: float = 6.0  # while it was told to drive so far

    def __post_init__(self) -> None:
        require(0.0 < self.interval_s <= 3600.0, "interval_s", self.interval_s, "(0, 3600] seconds")
        require(self.interval_s < self.window_s <= 36_000.0, "window_s", self.window_s, "interval_s to 36000 seconds")
        for name in ("reach_radii", "wanted_radii"):
            require(0.0 < getattr(self, name) <= 1000.0, name, getattr(self, name), "(0, 1000]")


class Moment(NamedTuple):
    """Where the robot was, and how fast it was told to go forward or backward."""

    stamp_s: float
    x_m: float
    y_m: float
    wanted_mps: float


def no_progress(moments: "deque[Moment]", radius_m: float, params: NoProgressTrapParams) -> Trap | None:
    """Return the trap if the robot stayed within a small circle all the window long while it was told to drive."""
    if len(moments) < 2 or moments[-1].stamp_s - moments[0].stamp_s < params.window_s - 2 * params.interval_s:
        return None
    listed = list(moments)
    wanted_m = sum(a.wanted_mps * (b.stamp_s - a.stamp_s) for a, b in pairwise(listed))
    xs, ys = [m.x_m for m in listed], [m.y_m for m in listed]
    x, y = (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2
    reach_m = max(hypot(m.x_m - x, m.y_m - y) for m in listed)
    if wanted_m < params.wanted_radii * radius_m or reach_m > params.reach_radii * radius_m / 2:
        return None
    return Trap(
        trap="no progress",
        place=Point(x_m=x, y_m=y),
        size_m=2 * reach_m,
        detail=f"told to drive {wanted_m:.1f} m in {params.window_s:g} s, stayed within {2 * reach_m:.2f} m",
    )


class NoProgressTrap(KnowledgeSource[NoProgressTrapParams]):
    """Keeps a hypothesis as long as the robot does not get on."""

    Params = NoProgressTrapParams
    reads = (VELOCITY, ROBOT, *READS)
    posts = (TRAP,)
    rating = 3.0

    def __init__(self, params: NoProgressTrapParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self.triggers = (Trigger(kind=ODOM_FROM_ROBOT, min_interval_s=params.interval_s),)
        self._moments: deque[Moment] = deque()
        self._episodes = Episodes(TRAP, "no_progress")

    def resume(self, state: object, board: Access) -> None:
        super().resume(state, board)
        self._episodes.resume(board)

    def activate(self, trigger: Entry[Pose], board: Access) -> None:
        robot, found = board.newest(ROBOT), map_from_robot_at(board, trigger.stamp_s)
        if robot is None or found is None:
            return
        velocity = board.newest(VELOCITY)
        told = velocity is not None and velocity.value.valid_until_s >= trigger.stamp_s
        wanted_mps = abs(velocity.value.forward_mps) if velocity is not None and told else 0.0
        pose, supports = found
        self._moments.append(Moment(trigger.stamp_s, pose.x_m, pose.y_m, wanted_mps))
        while trigger.stamp_s - self._moments[0].stamp_s > self.params.window_s:
            self._moments.popleft()
        trap = no_progress(self._moments, robot.value.radius_m, self.params)
        stands_on: list[Entry[Any]] = [*supports, *([velocity] if velocity is not None else [])]
        kept = None if trap is None else Found(trap, stands_on, [Reason(WHY)])
        self._episodes.keep(board, kept, "the robot got on, or was told to stop")
