"""How ways over the grid are sought: parameters of every source that seeks them."""

from dataclasses import dataclass

from blackboard.parameters import require


@dataclass(frozen=True, slots=True, kw_only=True)
class WaysParams:
    """How near a way may come to things, what that costs, and how finely ways are sought."""

    unknown_fraction: float = (
        0.7  # of the radius, within which an unknown cell closes: strips of two cells at 0.3 m do not
    )
    comfort_m: float = 0.4  # from the rim: nearer things push (avoid_obstacles' threshold), so there a way costs more
    near_cost: float = (
        3.0  # a metre that almost touches costs as much as 1 + so many in the open: the detour worth making
    )
    escape_m: float = 0.75  # so far from a place that is too near to something the way out of there may begin
    block_m: float = 0.1  # a quarter of the cost of the grid's 5 cm, and ways are straightened afterwards
    goal_reach_m: float = 0.3  # a way may end so far from a goal that lies too near to something

    def __post_init__(self) -> None:
        require(0.0 <= self.unknown_fraction <= 1.0, "unknown_fraction", self.unknown_fraction, "[0, 1]")
        require(0.0 <= self.comfort_m <= 2.0, "comfort_m", self.comfort_m, "[0, 2] metres")
        require(0.0 <= self.near_cost <= 100.0, "near_cost", self.near_cost, "[0, 100]")
        require(0.0 <= self.escape_m <= 5.0, "escape_m", self.escape_m, "[0, 5] metres")
        require(0.01 <= self.block_m <= 1.0, "block_m", self.block_m, "[0.01, 1] metres")
        require(0.0 <= self.goal_reach_m <= 2.0, "goal_reach_m", self.goal_reach_m, "[0, 2] metres")
