"""Collisions: simulated robots under all behaviours, people walking in every second run.

python benchmarks/collisions.py [--worlds lab trap office] [--robots k2a] [--seeds 20] [--minutes 10]

A table of contacts that the robot caused, contacts that others caused, distance driven, floor visited, and the longest time
spent in one place. Only the reflexes of wander-lab run: no knowledge sources, no pictures.
"""

import argparse
import dataclasses
from dataclasses import dataclass
from math import floor, hypot
from statistics import mean

from rich.console import Console
from rich.table import Table

from blackboard.mission import Mission, find_mission, load_mission
from blackboard.runner import Run, RunOptions

PLACE_M = 0.5  # side of a square of floor that counts as visited, and how far a robot moves to leave a place


@dataclass(frozen=True)
class Drive:
    """What became of one run."""

    caused: int
    by_others: int
    distance_m: float
    visited_m2: float
    longest_stay_s: float


def reflexes_only(world: str, robot: str, people: bool) -> Mission:
    """Return wander-lab without its knowledge sources, with this robot in this world."""
    mission = load_mission(find_mission("wander-lab"), {"robot": {"world": world, "robot": robot, "people": people}})
    return dataclasses.replace(mission, knowledge_sources=())


def drive(mission: Mission, seed: int, duration_s: float) -> Drive:
    """Run a mission and return what became of it."""
    run = Run(mission, RunOptions(seed=seed, strict=True))
    run.run(duration_s)
    track = run.true_trajectory()
    assert track is not None
    visited = set()
    here, since_s, longest_s = track[0], 0.0, 0.0
    for row in track:
        visited.add((floor(row[1] / PLACE_M), floor(row[2] / PLACE_M)))
        if hypot(row[1] - here[1], row[2] - here[2]) > PLACE_M:
            here, since_s = row, row[0]
        longest_s = max(longest_s, row[0] - since_s)
    summary = run.robot.summary()
    return Drive(
        caused=int(summary["collisions"]),
        by_others=int(summary["touched_by_others"]),
        distance_m=float(summary["distance_m"]),
        visited_m2=len(visited) * PLACE_M**2,
        longest_stay_s=longest_s,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", nargs="+", default=["lab", "trap", "office"])
    parser.add_argument("--robots", nargs="+", default=["k2a"])
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--minutes", type=float, default=10.0)
    options = parser.parse_args()
    table = Table(title=f"{options.seeds} seeds x {options.minutes:g} simulated minutes, people in every second run")
    for column in ("world", "robot", "caused", "by others", "m a run", "m2 visited", "longest stay s"):
        table.add_column(column, justify="left" if column in ("world", "robot") else "right")
    caused = 0
    for world in options.worlds:
        for robot in options.robots:
            missions = [reflexes_only(world, robot, people) for people in (False, True)]
            drives = [drive(missions[seed % 2], seed, 60.0 * options.minutes) for seed in range(options.seeds)]
            caused += sum(d.caused for d in drives)
            table.add_row(
                world,
                robot,
                str(sum(d.caused for d in drives)),
                str(sum(d.by_others for d in drives)),
                f"{mean(d.distance_m for d in drives):.0f}",
                f"{mean(d.visited_m2 for d in drives):.1f}",
                f"{max(d.longest_stay_s for d in drives):.0f}",
            )
    Console().print(table)
    raise SystemExit(1 if caused else 0)


if __name__ == "__main__":
    main()
