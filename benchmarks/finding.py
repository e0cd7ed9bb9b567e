"""Finding things: how long until all drums of the warehouse are found, with what is known beforehand and without.

python benchmarks/finding.py [--mission M] [--without RULE_FILE] [--seeds N] [--duration S] [--set KEY=VALUE ...] [--jobs N]

The mission as it is, and without a rule file (a-priori knowledge). One row a seed: when the first half and when all of the drums
stood on the board as confirmed, each within 0.6 m of a true one (the map drifts with the wheels), how many there were at the
end, how many confirmed ones were none, how the mission ended, contacts that the robot caused.
"""

import argparse
import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial
from math import hypot, inf
from statistics import median

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core a run

from blackboard.entry import Entry
from blackboard.kinds import FOUND_OBJECT, MISSION
from blackboard.messages.symbols import FoundObject
from blackboard.mission import Mission, find_mission, load_mission, parse_settings
from blackboard.runner import Run, RunOptions
from sim.world_by_name import load_world

NEAR_M = 0.6  # a confirmed thing is a true one within this distance
SIZE_M = 0.02  # things of the same radius and colour are looked for
MOST_JOBS = 2
Places = Sequence[tuple[float, float]]


@dataclass
class Finds:
    """When which of the true things was confirmed first; what is confirmed now."""

    places: Places
    first_s: dict[int, float] = field(default_factory=dict)

    def note(self, entry: Entry[FoundObject]) -> None:
        """Take note of a post."""
        if entry.event == "retracted" or entry.value.standing != "confirmed":
            return
        number = self.nearest(entry.value)
        if number is not None:
            self.first_s.setdefault(number, entry.stamp_s)

    def nearest(self, found: FoundObject) -> int | None:
        """Return which of the true things this is; None where it is none."""
        away = [hypot(found.place.x_m - x, found.place.y_m - y) for x, y in self.places]
        best = min(range(len(away)), key=lambda i: away[i])
        return best if away[best] <= NEAR_M else None

    def time_s(self, count: int) -> float:
        """Return when so many were found."""
        times = sorted(self.first_s.values())
        return times[count - 1] if len(times) >= count else inf


@dataclass(frozen=True)
class Outcome:
    """What became of one run."""

    things: int
    found: int
    half_s: float
    all_s: float
    wrong: int
    state: str
    time_s: float
    collisions: int


def true_places(mission: Mission, colour: str, radius_m: float) -> Places:
    """Return where the things that are looked for stand."""
    coloured = load_world(mission.robot.params.world).coloured
    return [
        (float(thing.core.x), float(thing.core.y))
        for thing in coloured
        if thing.colour == colour and abs(thing.radius_m - radius_m) < SIZE_M
    ]


def without(mission: Mission, rule_file: str) -> Mission:
    """Return a mission without one of its rule files, given by its name."""
    assert mission.rules is not None
    files = tuple(file for file in mission.rules.params.files if file.stem != rule_file)
    return replace(mission, rules=replace(mission.rules, params=replace(mission.rules.params, files=files)))


def find(mission: Mission, places: Places, duration_s: float, seed: int) -> Outcome:
    """Run a mission once, to its own end or for this long."""
    run = Run(mission, RunOptions(seed=seed, strict=True))
    finds = Finds(places)
    run.board.subscribe(f"ski/{run.board.robot}/{FOUND_OBJECT.path}/*", finds.note)
    run.run(duration_s)
    status = run.board.newest(MISSION)
    confirmed = [e.value for e in run.board.entries(FOUND_OBJECT) if e.value.standing == "confirmed"]
    return Outcome(
        things=len(places),
        found=len(finds.first_s),
        half_s=finds.time_s(len(places) // 2),
        all_s=finds.time_s(len(places)),
        wrong=sum(finds.nearest(value) is None for value in confirmed),
        state="no end" if status is None else status.value.state,
        time_s=float(run.trajectory()[-1, 0]),
        collisions=int(run.robot.summary()["collisions"]),
    )


HEAD = "seed  half found s  all found s  found  wrong  ended          time s  collisions"


def row(seed: int, o: Outcome) -> str:
    """Return one line of the table."""
    return (
        f"{seed:4}{_seconds(o.half_s):>14}{_seconds(o.all_s):>13}{f'{o.found}/{o.things}':>7}{o.wrong:7}  {o.state:12}"
        f"{o.time_s:9.1f}{o.collisions:12}"
    )


def summary(outcomes: Sequence[Outcome]) -> str:
    """Return what the runs tell together; a time that was not reached counts as later than any other."""
    return (
        f"all found in {sum(o.found == o.things for o in outcomes)} of {len(outcomes)}; median time: half "
        f"{_seconds(median(o.half_s for o in outcomes))} s, all {_seconds(median(o.all_s for o in outcomes))} s; wrong: "
        f"{sum(o.wrong for o in outcomes)}; collisions: {sum(o.collisions for o in outcomes)}"
    )


def _seconds(time_s: float) -> str:
    return "-" if time_s == inf else f"{time_s:.0f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mission", default="find-drums")
    parser.add_argument("--without", default="drums-in-corners", help="the rule file with what is known beforehand")
    parser.add_argument("--colour", default="green")
    parser.add_argument("--radius", type=float, default=0.29, metavar="M")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--duration", type=float, default=3600.0, metavar="S", help="given up then")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--jobs", type=int, default=MOST_JOBS, choices=range(1, MOST_JOBS + 1))
    options = parser.parse_args()
    known = load_mission(find_mission(options.mission), parse_settings(options.set))
    places = true_places(known, options.colour, options.radius)
    for mission, how in ((known, "as it is"), (without(known, options.without), f"without {options.without}")):
        print(
            f"{mission.name} {how}, {options.seeds} seeds, {len(places)} things {' '.join(options.set)}\n{HEAD}",
            flush=True,
        )
        outcomes = []
        with ProcessPoolExecutor(max_workers=options.jobs) as pool:
            ran = pool.map(partial(find, mission, places, options.duration), range(options.seeds))
            for seed, outcome in enumerate(ran):
                outcomes.append(outcome)
                print(row(seed, outcome), flush=True)
        print(f"{summary(outcomes)}\n", flush=True)


if __name__ == "__main__":
    main()
