"""Several robots of one mission in one world, in lock-step: to each its own board, components and random numbers.

Each cycle every robot goes through its own, in the mission's order, all at the same time of the mission's clock: what one
commands moves it from then on, and the others find it there in their next readings.
"""

from math import ceil

from blackboard.members import members, share_world
from blackboard.mission import Mission
from blackboard.runner import Progress, Run, RunOptions


class Team:
    """A run for each robot of a mission. Raises MissionError where they do not fit together."""

    def __init__(self, mission: Mission, options: RunOptions | None = None) -> None:
        self.mission = mission
        missions = members(mission)
        self.runs = {its.robot.name: Run(its, options) for its in missions}
        share_world(missions, [run.robot for run in self.runs.values()])

    def run(self, duration_s: float | None = None, progress: Progress | None = None) -> None:
        """Run for `duration_s` (the mission's unless given) or until every robot is at its end; then let the sources finish."""
        params = self.mission.params
        total_s = params.duration_s if duration_s is None else duration_s
        for cycle in range(ceil(total_s / params.step_s - 1e-9) + 1):
            self.cycle()
            if progress is not None and cycle % 50 == 0:
                progress(cycle * params.step_s, total_s)
            if self.over:
                break
        self.finish()
        if progress is not None:
            progress(total_s, total_s)

    def cycle(self) -> None:
        """Run one control cycle of each."""
        for run in self.runs.values():
            run.cycle()

    @property
    def time_s(self) -> float:
        """The mission's clock, the same for all."""
        return next(iter(self.runs.values())).board.now_s

    @property
    def over(self) -> bool:
        """Say whether all have come to their end by their own word. Until then those at their end stay in the world."""
        return all(run.over for run in self.runs.values())

    def finish(self) -> None:
        """Let all sources post what they hold back."""
        for run in self.runs.values():
            run.control.finish()

    def close(self) -> None:
        """Let go of what the robots and planners hold."""
        for run in self.runs.values():
            run.close()
