"""Docking: charge-battery and docking from a world's start, on wheels that err and nothing that corrects them.

python benchmarks/docking.py [--worlds lab office] [--robots k2a pioneer] [--seeds 20]

A table of how many robots were charged, in how many tries and how long, and of collisions. Nothing else of explore-lab-battery
runs, so that the pose is that of the wheels; each start is a few metres away.
"""

import argparse
import dataclasses
from dataclasses import dataclass
from math import pi
from statistics import mean, median

from rich.console import Console
from rich.table import Table

from blackboard.kinds import BEHAVIOUR, MOTIVATION
from blackboard.messages.motion import BehaviourStatus, Motivation
from blackboard.mission import Mission, find_mission, load_mission
from blackboard.runner import Run, RunOptions

STATIONS = {"lab": (4.3, 0.0, -pi / 2), "office": (0.0, 1.0, pi)}  # as the worlds' files say
LONGEST_S = 400.0  # all tries take less


@dataclass(frozen=True)
class Docked:
    """What became of one run."""

    charged: bool
    tries: int
    took_s: float
    collisions: int


def behaviours_only(world: str, robot: str) -> Mission:
    """Return explore-lab-battery without its rules and with nothing but odometry for a pose."""
    settings = {"robot": {"world": world, "robot": robot, "start_charge_fraction": 0.5}}
    mission = load_mission(find_mission("explore-lab-battery"), settings)
    odometry = tuple(spec for spec in mission.knowledge_sources if spec.name == "odometry_pose")
    return dataclasses.replace(mission, knowledge_sources=odometry, rules=None)


def status(run: Run, behaviour: str) -> BehaviourStatus:
    """Return where a behaviour stands."""
    entry = run.board.newest(BEHAVIOUR, behaviour)
    assert entry is not None
    return entry.value


def go(run: Run, behaviour: str, station: tuple[float, float, float]) -> BehaviourStatus:
    """Select a behaviour and wait for its outcome; return how it stands then."""
    run.board.post(MOTIVATION, Motivation(on=True, number=1, parameters=station), id=behaviour, source="benchmark")
    run.cycle()
    while run.board.now_s < LONGEST_S and status(run, behaviour).outcome == "underway":
        run.cycle()
    return status(run, behaviour)


def dock(mission: Mission, station: tuple[float, float, float], seed: int) -> Docked:
    """Go before the station and dock."""
    run = Run(mission, RunOptions(seed=seed, strict=True))
    tries: list[str] = []

    def note(detail: str) -> None:
        if ", try " in detail and detail.rpartition(", ")[2] not in tries:
            tries.append(detail.rpartition(", ")[2])

    run.board.subscribe(run.board.key(BEHAVIOUR, "docking"), lambda entry: note(entry.value.detail))
    go(run, "charge_battery", station)
    reached = go(run, "docking", station).outcome == "reached"
    return Docked(reached, len(tries), run.board.now_s, int(run.robot.summary()["collisions"]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", nargs="+", default=list(STATIONS), choices=list(STATIONS))
    parser.add_argument("--robots", nargs="+", default=["k2a", "pioneer"])
    parser.add_argument("--seeds", type=int, default=20)
    options = parser.parse_args()
    table = Table(title=f"Docking, {options.seeds} seeds each, odometry alone")
    for column in ("world", "robot", "charged", "tries", "median s", "longest s", "touched"):
        table.add_column(column, justify="left" if column in ("world", "robot") else "right")
    for world in options.worlds:
        for robot in options.robots:
            mission = behaviours_only(world, robot)
            runs = [dock(mission, STATIONS[world], seed) for seed in range(options.seeds)]
            table.add_row(
                world,
                robot,
                f"{sum(r.charged for r in runs)} of {len(runs)}",
                f"{mean(r.tries for r in runs):.1f}",
                f"{median(r.took_s for r in runs):.0f}",
                f"{max(r.took_s for r in runs):.0f}",
                str(sum(r.collisions for r in runs)),
            )
    Console().print(table)


if __name__ == "__main__":
    main()
