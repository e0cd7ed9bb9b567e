"""The results of a mission that ran as processes, made from its keeper's journal when all of them have ended."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

from blackboard.assembly import Assembly
from blackboard.command.execute import tell_results
from blackboard.command.replay import ReplayedRun
from blackboard.errors import OutputError
from blackboard.journal import FILE_NAME


def write_up_results(
    assembly: Assembly, journal: Path, folder: Path, options: argparse.Namespace, *, interrupted: bool
) -> int:
    """Write and show what a mission came to; return the exit status."""
    from blackboard.command.gather import FrameCollector, gather  # loads matplotlib: not while the robot drives
    from blackboard.command.gather_milestones import MilestoneCollector
    from blackboard.report.write import write_results

    run = ReplayedRun(assembly)
    collector = FrameCollector(run) if options.gif else None
    milestones = MilestoneCollector(run)
    run.read(journal, collector.note if collector is not None else None)
    result = gather(run, assembly.mission.name)
    write_results(result, folder, collector.frames if collector is not None else (), milestones.milestones())
    return tell_results(run, result, folder, json=options.json, interrupted=interrupted)


def write_up_team_results(
    assemblies: Sequence[Assembly],
    journals: Mapping[str, Path],
    folder: Path,
    options: argparse.Namespace,
    *,
    interrupted: bool,
) -> int:
    """Write and show what a mission of several robots came to, from the journal of each; return the exit status."""
    from blackboard.command.gather import FrameCollector, gather
    from blackboard.command.gather_milestones import MilestoneCollector
    from blackboard.command.team_results import tell_team_results
    from blackboard.report.write import write_results

    runs, results = {}, {}
    title = assemblies[0].mission.name
    for assembly in assemblies:
        name = assembly.robot.description.name
        run = runs[name] = ReplayedRun(assembly)
        collector = FrameCollector(run) if options.gif else None
        milestones = MilestoneCollector(run)
        run.read(journals[name], collector.note if collector is not None else None)
        results[name] = gather(run, f"{title}: {name}")
        frames = collector.frames if collector is not None else ()
        write_results(results[name], folder / name, frames, milestones.milestones())
    return tell_team_results(title, runs, results, folder, json=options.json, interrupted=interrupted)


def take_journal(board: Path, robot: str, folder: Path) -> Path:
    """Move the journal out of a folder that its keeper has left, to where `ski why --in` looks for it; return its place.

    Raises OutputError where there is none.
    """
    place = folder / FILE_NAME
    try:
        (board / robot / FILE_NAME).replace(place)
    except OSError as error:
        raise OutputError(
            f"{board / robot / FILE_NAME}: there is no journal, so there are no results ({error.strerror})"
        ) from None
    return place
