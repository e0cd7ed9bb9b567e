"""Runs a mission of several robots from the command line: a folder for each robot, tables and a picture for all of them."""

import argparse
from contextlib import ExitStack
from pathlib import Path

from rich.console import Console

from blackboard.command.execute import new_folder, show_progress
from blackboard.command.spoken import tell_what_is_said
from blackboard.errors import ComponentFailed
from blackboard.journal import FILE_NAME, JournalWriter
from blackboard.mission import Mission
from blackboard.report.output_folder import prepare_team_folder
from blackboard.runner import Progress, RunOptions
from blackboard.team import Team


def execute_team(mission: Mission, options: argparse.Namespace) -> int:
    """Run a mission of several robots, write the results of each and of all, show their tables; return the exit status.

    Ctrl-C writes what was gathered.
    """
    folder = Path(options.out) if options.out is not None else new_folder(mission.name)
    team = Team(mission, RunOptions(seed=options.seed, strict=options.strict))
    prepare_team_folder(folder, list(team.runs), options.force)
    from blackboard.command.gather import FrameCollector, gather  # loads matplotlib: not before all else is sound
    from blackboard.command.gather_milestones import MilestoneCollector
    from blackboard.command.team_results import tell_team_results
    from blackboard.report.write import write_results

    interrupted, failure = False, None
    collectors = {name: FrameCollector(run) for name, run in team.runs.items()} if options.gif else {}
    milestones = {name: MilestoneCollector(run) for name, run in team.runs.items()}

    def note(elapsed_s: float, total_s: float) -> None:
        for collector in collectors.values():
            collector.note(elapsed_s, total_s)

    with ExitStack() as journals:
        for name, run in team.runs.items():
            run.board.journal = journals.enter_context(JournalWriter(folder / name / FILE_NAME))
        try:
            _run_showing_progress(team, options.duration, note)
        except KeyboardInterrupt:
            interrupted = True
            team.finish()
        except ComponentFailed as error:  # under --strict
            failure = error
        finally:
            team.close()
    results = {name: gather(run, f"{mission.name}: {name}") for name, run in team.runs.items()}
    for name, result in results.items():
        frames = collectors[name].frames if collectors else ()
        write_results(result, folder / name, frames, milestones[name].milestones())
    if failure is not None:
        raise failure
    title, runs = mission.name, team.runs
    return tell_team_results(title, runs, results, folder, json=options.json, interrupted=interrupted)


def _run_showing_progress(team: Team, duration_s: float | None, note: Progress) -> None:
    console = Console(stderr=True)
    for name, run in team.runs.items():
        tell_what_is_said(run.board, console, f"{name}: ")

    def start(progress: Progress) -> None:
        team.run(duration_s, progress)

    show_progress(team.mission.name, console, start, note)
