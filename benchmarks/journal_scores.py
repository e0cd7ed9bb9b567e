"""What a keeper's journal tells of a run: how the mission ended, how good the map is, what the robot touched."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from msgspec import json

from blackboard.assembly import assemble
from blackboard.command.gather import gather
from blackboard.command.replay import ReplayedRun
from blackboard.entry import Entry
from blackboard.kinds import COMPONENT, MISSION, ROBOT_SUMMARY
from blackboard.mission import Mission


@dataclass(frozen=True)
class Outcome:
    """What became of a run."""

    state: str  # done, given up, underway; "never begun" where nobody said
    time_s: float  # of its end, on the mission's clock
    decided_fraction: float
    aligned_fraction: float  # with the world laid on the map
    error_max_m: float
    collisions: int
    failed: tuple[str, ...]  # components that raised


def outcome_of(journal: Path, mission: Mission, seed: int = 0) -> Outcome:
    """Return what a journal tells; the world is built anew from mission and seed to compare with."""
    assembly = assemble(mission, seed)
    run = ReplayedRun(assembly)
    collisions = [0]  # each boot of the robot tells its own, the highest counts

    def note(entry: Entry[Any]) -> None:
        collisions.append(int(json.decode(entry.value.figures).get("collisions", 0)))

    run.board.subscribe(run.board.key(ROBOT_SUMMARY), note)
    run.read(journal)
    table = gather(run, mission.name).table
    assembly.robot.close()
    status = run.board.newest(MISSION)
    return Outcome(
        state=status.value.state if status is not None else "never begun",
        time_s=status.stamp_s if status is not None else 0.0,
        decided_fraction=float(table.get("reachable_decided_fraction", 0.0)),
        aligned_fraction=float(table.get("reachable_decided_aligned_fraction", 0.0)),
        error_max_m=float(table.get("pose_error_max_m", 0.0)),
        collisions=max(collisions),
        failed=tuple(e.id or "" for e in run.board.entries(COMPONENT) if e.value.state == "failed"),
    )
