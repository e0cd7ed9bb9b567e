"""Restarts: each host of a mission is killed between two posts, at many times, and comes back; does the mission go on where it was?

python benchmarks/restarts.py [--mission explore-lab] [--seeds 3] [--kills 6] [--forget] [--seconds S]

A table by host: of how many runs with so many kills each the mission ended by its own word, how much of the area was decided, how
long it took, collisions, and what went wrong with keys: a number given twice, a stamp or a revision that ran back. With --forget
the checkpoints are lost too, and only the board is left. Deterministic: hosts run in lock-step in one process.
"""

import argparse
import random
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean
from typing import Any

from hosts_in_step import InStep, Kill
from rich.console import Console
from rich.table import Table

from blackboard.entry import Entry
from blackboard.grid import Grid
from blackboard.kinds import GRID
from blackboard.messages.geometry import Pose
from blackboard.mission import Mission, find_mission, load_mission
from blackboard.placement import placement
from blackboard.report.scores import area_decided

NUMBERED = ("target", "trap", "model_line", "new_area_visited", "pose_conflict", "resolution_task", "line", "change")


@dataclass(frozen=True)
class Outcome:
    """What became of one run."""

    ended: bool
    took_s: float
    decided_fraction: float
    collisions: int
    restarts: int
    faults: list[str]


def drive(mission: Mission, seed: int, kills: Sequence[Kill], until_s: float | None = None) -> Outcome:
    """Run a mission with these kills."""
    with tempfile.TemporaryDirectory() as folder:
        hosts = InStep(mission, seed, Path(folder))
        ended = hosts.run(kills, until_s)
        robot = hosts.robot
        tiles = [
            e.value for e in hosts.standing.values() if e.key.startswith(f"ski/{robot.description.name}/{GRID.path}/")
        ]
        grid, truth, pose = Grid.from_tiles(tiles), robot.truth(), robot.true_pose()
        decided = None
        if grid is not None and truth is not None and isinstance(pose, Pose):
            decided = area_decided(grid, truth, pose, robot.description.radius_m)
        return Outcome(
            ended=ended,
            took_s=hosts.now_s,
            decided_fraction=decided or 0.0,
            collisions=int(robot.summary()["collisions"]),
            restarts=hosts.restarts,
            faults=[*key_faults(hosts.log), *component_faults(hosts.log)],
        )


def key_faults(log: Iterable[Entry[Any]]) -> list[str]:
    """Return what is wrong with the keys of a run: revisions and stamps that do not go on, numbers given twice."""
    newest: dict[str, Entry[Any]] = {}
    faults = []
    for entry in log:
        before = newest.get(entry.key)
        newest[entry.key] = entry
        if before is None:
            continue
        if entry.revision <= before.revision or entry.stamp_s < before.stamp_s:
            faults.append(f"{entry.key}: revision {entry.revision} at {entry.stamp_s} came after {before.revision}")
        numbered = entry.key.split("/")[-2] in NUMBERED
        if numbered and before.event == "retracted" and entry.source == before.source:
            faults.append(f"{entry.key}: given again at {entry.stamp_s}, after it was retracted at {before.stamp_s}")
    return faults


def component_faults(log: Iterable[Entry[Any]]) -> list[str]:
    """Return which components failed or began anew, and rules that went wrong."""
    return [
        f"{entry.key}: {getattr(entry.value, 'error', '') or getattr(entry.value, 'text', '')}"
        for entry in log
        if "/status/component/" in entry.key or "/control/rule_error/" in entry.key
    ]


def kills_of(host: str, count: int, seed: int, *, forgets: bool = False) -> list[Kill]:
    """Return kills spread over a mission, at odd times and between any two posts."""
    draw = random.Random(f"{host} {seed}")
    return [
        Kill(
            host=host,
            at_s=round(10.0 + 230.0 * (number + draw.random()) / count, 1),
            posts=draw.randrange(40),
            away_s=draw.choice((0.2, 1.0, 4.0)),
            forgets=forgets,
        )
        for number in range(count)
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--mission", default="explore-lab")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--kills", type=int, default=6, help="in each run")
    parser.add_argument("--forget", action="store_true", help="checkpoints are lost too")
    parser.add_argument("--seconds", type=float, default=None, help="for missions that do not end by their own word")
    options = parser.parse_args()
    mission = load_mission(find_mission(options.mission))
    table = Table("host", "runs", "ended", "decided, least", "time s, mean", "collisions", "restarts", "faults")
    faults = []
    for host in [plan.name for plan in placement(mission)]:
        outcomes = [
            drive(mission, seed, kills_of(host, options.kills, seed, forgets=options.forget), options.seconds)
            for seed in range(1, options.seeds + 1)
        ]
        faults += [fault for outcome in outcomes for fault in outcome.faults]
        table.add_row(
            host,
            str(len(outcomes)),
            str(sum(o.ended for o in outcomes)),
            f"{min(o.decided_fraction for o in outcomes):.3f}",
            f"{mean(o.took_s for o in outcomes):.0f}",
            str(sum(o.collisions for o in outcomes)),
            str(sum(o.restarts for o in outcomes)),
            str(sum(len(o.faults) for o in outcomes)),
        )
    console = Console()
    console.print(table)
    for fault in faults[:20]:
        console.print(fault, highlight=False)


if __name__ == "__main__":
    main()
