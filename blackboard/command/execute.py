"""Runs a mission from the command line: folder, journal, progress, results. Shared by `ski run` and `ski map`."""

import argparse
import os
import sys
from collections.abc import Callable
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as ProgressBar

from blackboard.command.main import EXIT_INTERRUPTED
from blackboard.command.seen_run import SeenRun
from blackboard.command.spoken import tell_what_is_said
from blackboard.errors import ComponentFailed, MissionError
from blackboard.journal import FILE_NAME, JournalWriter
from blackboard.kinds import COMPONENT, CORRECTED_PATH, MISSION
from blackboard.mission import Mission
from blackboard.report.output_folder import prepare_output_folder
from blackboard.report.result import RunResult
from blackboard.report.table import show_table, table_json
from blackboard.runner import Progress, Run, RunOptions


def add_run_options(parser: argparse.ArgumentParser, *, strict: bool = True) -> None:
    """Declare the arguments of a verb that runs something. `SKI_OUT` and `SKI_DURATION` are defaults."""
    parser.add_argument(
        "--duration",
        type=_duration,
        default=os.environ.get("SKI_DURATION"),
        metavar="S",
        help="seconds on the mission's clock",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=os.environ.get("SKI_OUT"),
        metavar="DIR",
        help="output folder (default: a new one in runs/)",
    )
    parser.add_argument("--force", action="store_true", help="replace what an earlier run left in the output folder")
    if strict:
        parser.add_argument("--strict", action="store_true", help="stop at the first component that raises")
    parser.add_argument("--gif", action="store_true", help="also write map.gif: the map growing, as a moving picture")
    parser.add_argument("--json", action="store_true", help="print the table at the end as JSON")


def execute(mission: Mission, options: argparse.Namespace, title: str | None = None) -> int:
    """Run a mission, write its results, show its table; return the exit status. Ctrl-C writes what was gathered."""
    folder = Path(options.out) if options.out is not None else new_folder(mission.name)
    run = Run(mission, RunOptions(seed=options.seed, strict=options.strict))
    prepare_output_folder(folder, options.force)
    from blackboard.command.gather import FrameCollector, gather  # loads matplotlib: not before all else is sound
    from blackboard.command.gather_milestones import MilestoneCollector
    from blackboard.report.write import write_results

    interrupted, failure = False, None
    collector = FrameCollector(run) if options.gif else None
    milestones = MilestoneCollector(run)
    with JournalWriter(folder / FILE_NAME) as journal:
        run.board.journal = journal
        try:
            _run_showing_progress(run, options.duration, collector.note if collector is not None else None)
        except KeyboardInterrupt:
            interrupted = True
            run.control.finish()
        except ComponentFailed as error:  # under --strict
            failure = error
        finally:
            run.close()
    result = gather(run, title or mission.name)
    write_results(result, folder, collector.frames if collector is not None else (), milestones.milestones())
    if failure is not None:
        raise failure
    return tell_results(run, result, folder, json=options.json, interrupted=interrupted)


def tell_results(run: SeenRun, result: RunResult, folder: Path, *, json: bool, interrupted: bool) -> int:
    """Show the table, and what failed; return the exit status."""
    complain(run)
    if json:
        sys.stdout.write(table_json({**result.table, "out": str(folder)}) + "\n")
    else:
        show_table(result.table, result.mission)
        sys.stdout.write(ending(run))
        sys.stdout.write(f"Results in {folder}: look at {folder / 'overview.png'}\n")
    if interrupted:
        sys.stderr.write(f"ski: interrupted; what was gathered until then is in {folder}\n")
        return EXIT_INTERRUPTED
    return 0


def complain(run: SeenRun, of: str = "") -> None:
    """Say on standard error what failed in a run; `of` goes before it."""
    for entry in run.board.entries(COMPONENT):
        if entry.value.state == "failed":
            on = f" on {entry.value.trigger_key}" if entry.value.trigger_key else ""
            sys.stderr.write(f"ski: {of}{entry.id} failed{on} and was left out from then on: {entry.value.error}\n")
    corrected = run.board.newest(CORRECTED_PATH)
    if corrected is not None and not corrected.value.closed:
        path = corrected.value
        sys.stderr.write(
            f"ski: {of}the map did not close, do not trust its shape: {path.closures} of {path.candidates} places met again fit, "
            f"and {100.0 * path.contradicted_fraction:.0f} % of what was seen again contradicts another pass\n"
        )


def ending(run: SeenRun) -> str:
    """Return the line that says that a mission ended by its own word; empty where it did not."""
    status = run.board.newest(MISSION)
    if status is None or status.value.state == "underway":
        return ""
    detail = f": {status.value.detail}" if status.value.detail else ""
    return f"{run.mission.name} is {status.value.state} after {status.stamp_s - run.robot.start_s:.1f} s{detail}\n"


def _run_showing_progress(run: Run, duration_s: float | None, note: Progress | None) -> None:
    console = Console(stderr=True)
    tell_what_is_said(run.board, console)

    def start(progress: Progress) -> None:
        run.run(duration_s, progress)

    show_progress(run.mission.name, console, start, note)


def show_progress(
    title: str, console: Console, start: Callable[[Progress], None], note: Progress | None = None
) -> None:
    """Call `start` with what it is to tell of its progress to: a bar on a terminal, and `note`."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeElapsedColumn(),
    )
    with ProgressBar(*columns, console=console, transient=True, disable=not console.is_terminal) as shown:
        task = shown.add_task(title)

        def progress(elapsed_s: float, total_s: float) -> None:
            shown.update(task, completed=elapsed_s, total=total_s)
            if note is not None:
                note(elapsed_s, total_s)

        start(progress)


def new_folder(name: str) -> Path:
    """Return a folder in runs/ that is not there yet."""
    number = 1
    while (folder := Path("runs") / f"{name}-{number}").exists():
        number += 1
    return folder


def _duration(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        raise MissionError(f"--duration {text}: must be a number of seconds") from None
    if not 0 < seconds <= 1e7:
        raise MissionError(f"--duration {text}: must be in (0, 1e7] seconds")
    return seconds
