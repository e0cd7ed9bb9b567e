"""Two robots explore a world together: do they touch, does either stay in the other's map, what does it cost, what do they gain.

python benchmarks/two_robots.py [--mission M] [--seeds N] [--first S] [--duration S] [--set KEY=VALUE]

One row a robot and seed: how its mission ended and when, contacts that it caused, contacts that others caused, how often the two
came to touch, the share of the reachable floor that its grid decided, the share of the decided cells that is right, and the cells
that are occupied in the open (further than 20 cm from any surface), as the other robot would be if it stayed as a wall; of
these, those where the other robot stands in the end. Beside it the same robot with the same random numbers alone in the
world. Then one row a seed: the floor decided after 100 s by each robot alone and by both maps laid on each other, these at the
end, and the share of the cells decided in both that differ.
"""

import argparse
import os
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core a run

import numpy as np
import shapely

from blackboard.command.gather import gather
from blackboard.grid import OCCUPIED_MIN
from blackboard.members import members
from blackboard.mission import Mission, find_mission, load_mission, parse_settings
from blackboard.report.result import RunResult
from blackboard.report.team import team_table
from blackboard.report.walls import surface
from blackboard.runner import Run, RunOptions
from blackboard.team import Team

EARLY_S = 100.0
OPEN_M = 0.2  # from any surface: nearer to a wall lie echoes of the wall itself, from a pose that was a little off
BODY_SLACK_M = 0.15  # an echo of the other robot lies this near to its rim


@dataclass(frozen=True)
class Outcome:
    """What became of one robot."""

    ended: str
    ended_s: float
    caused: int
    by_others: int
    met: int
    decided_fraction: float
    right_fraction: float
    ghosts: int  # occupied cells in the open
    other: int  # of these, where the other robot stands at the end


def ghosts(result: RunResult, other: RunResult | None) -> tuple[int, int]:
    """Return how many cells are occupied in the open, and how many of these lie where the other robot is."""
    grid = result.grid
    assert grid is not None
    assert result.truth is not None
    rows, columns = np.nonzero(grid.cells >= OCCUPIED_MIN)
    centres = np.stack([columns + 0.5, rows + 0.5], axis=1) * grid.cell_m + (grid.x_min_m, grid.y_min_m)
    astray = centres[shapely.distance(surface(result.truth), shapely.points(centres)) > OPEN_M]
    if other is None or other.true_trajectory is None:
        return len(astray), 0
    away_m = np.hypot(*(astray - other.true_trajectory[-1, 1:3]).T)
    return len(astray), int((away_m <= other.robot.radius_m + BODY_SLACK_M).sum())


def outcome(result: RunResult, other: RunResult | None = None) -> Outcome:
    """Return what of a robot's results is shown here."""
    table = result.table
    astray, at_other = ghosts(result, other)
    return Outcome(
        ended=str(table.get("mission", "no end")),
        ended_s=float(table.get("mission_ended_s", table["time_s"])),
        caused=int(table["collisions"]),
        by_others=int(table["touched_by_others"]),
        met=int(table.get("met_robots", 0)),
        decided_fraction=float(table["reachable_decided_fraction"]),
        right_fraction=float(table["grid_right_fraction"]),
        ghosts=astray,
        other=at_other,
    )


def run_both(mission: Mission, seed: int, duration_s: float) -> tuple[dict[str, RunResult], float]:
    """Return the results of all robots, and the floor that they had decided between them after EARLY_S."""
    team = Team(mission, RunOptions(seed=seed, strict=True))
    early = 0.0
    while not team.over and team.time_s < duration_s:
        team.cycle()
        if not early and team.time_s >= EARLY_S:
            early = decided({name: gather(run, name) for name, run in team.runs.items()})
    team.finish()
    results = {name: gather(run, name) for name, run in team.runs.items()}
    team.close()
    return results, early


def run_alone(mission: Mission, seed: int, duration_s: float) -> tuple[RunResult, float]:
    """Return the results of one robot by itself, and the floor that it had decided after EARLY_S."""
    run = Run(mission, RunOptions(seed=seed, strict=True))
    early = 0.0
    while not run.over and run.board.now_s < duration_s:
        run.cycle()
        if not early and run.board.now_s >= EARLY_S:
            early = decided({mission.robot.name: gather(run, mission.name)})
    run.control.finish()
    result = gather(run, mission.name)
    run.close()
    return result, early


def decided(results: dict[str, RunResult]) -> float:
    """Return the share of the reachable floor that the maps of some robots decided between them."""
    return float(team_table(results)["reachable_decided_fraction"])


HEAD = (
    "seed  robot   ended    time s  caused  by others  met  decided %  right %  ghost cells  at the other |"
    "  alone: time s  caused  decided %  right %  ghost cells"
)


def row(seed: int, name: str, one: Outcome, by_itself: Outcome) -> str:
    """Return one line of the table."""
    return (
        f"{seed:4}  {name:6}  {one.ended:6}{one.ended_s:9.1f}{one.caused:8}{one.by_others:11}{one.met:5}"
        f"{100 * one.decided_fraction:11.1f}{100 * one.right_fraction:9.1f}{one.ghosts:13}{one.other:14} |"
        f"{by_itself.ended_s:15.1f}{by_itself.caused:8}{100 * by_itself.decided_fraction:11.1f}"
        f"{100 * by_itself.right_fraction:9.1f}{by_itself.ghosts:13}"
    )


def summary(runs: Sequence[Outcome], singles: Sequence[Outcome]) -> str:
    """Return what all rows tell together."""

    def told(name: str, them: Sequence[Outcome]) -> str:
        return (
            f"{name}: done {sum(o.ended == 'done' for o in them)} of {len(them)}; collisions "
            f"{sum(o.caused for o in them)}; decided median {100 * median(o.decided_fraction for o in them):.1f} %, least "
            f"{100 * min(o.decided_fraction for o in them):.1f} %; right median "
            f"{100 * median(o.right_fraction for o in them):.1f} %; ghost cells {sum(o.ghosts for o in them)} "
            f"({sum(o.other for o in them)} of them at the other robot); time median "
            f"{median(o.ended_s for o in them):.0f} s"
        )

    return f"{told('together', runs)}; met {sum(o.met for o in runs) // 2}\n{told('alone', singles)}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mission", default="explore-lab-pair")
    parser.add_argument("--seeds", type=int, default=5, help="how many, from --first on")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--duration", type=float, default=3600.0, metavar="S", help="given up then")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    options = parser.parse_args()
    mission = load_mission(find_mission(options.mission), parse_settings(options.set))
    print(f"{options.mission}, {options.seeds} seeds {' '.join(options.set)}\n{HEAD}", flush=True)
    runs: list[Outcome] = []
    singles: list[Outcome] = []
    rows = []
    for seed in range(options.first, options.first + options.seeds):
        results, early = run_both(mission, seed, options.duration)
        table = team_table(results)
        each = []
        for its, (name, result) in zip(members(mission), results.items(), strict=True):
            single, early_alone = run_alone(its, seed, options.duration)
            each.append(f"{100 * early_alone:13.1f}")
            (other,) = (one for it, one in results.items() if it != name)
            runs.append(outcome(result, other))
            singles.append(outcome(single))
            print(row(seed, name, runs[-1], singles[-1]), flush=True)
        end, right, differ = (
            float(table[name]) for name in ("reachable_decided_fraction", "grid_right_fraction", "maps_differ_fraction")
        )
        rows.append(
            f"{seed:4}{''.join(each)}{100 * early:14.1f}{100 * end:15.1f}{100 * right:9.1f}{100 * differ:10.2f}"
        )
    print(f"{summary(runs, singles)}\n\nDecided after {EARLY_S:.0f} s, and both maps laid on each other at the end")
    print("seed  one alone %  the other %  both at once %  at the end %  right %  differ %")
    print("\n".join(rows))


if __name__ == "__main__":
    main()
