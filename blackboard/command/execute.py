"""Runs a mission from the command line: folder, journal, progress, results. Shared by `ski run` and `ski map`."""

import argparse
import os
import sys
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from blackboard.command.main import EXIT_INTERRUPTED
from blackboard.errors import ComponentFailed, MissionError
from blackboard.grid import Grid
from blackboard.journal import FILE_NAME, JournalWriter
from blackboard.kinds import COMPONENT, GRID, LINE
from blackboard.mission import Mission
from blackboard.report.output_folder import prepare_output_folder
from blackboard.report.result import RunResult, driven_m
from blackboard.report.scores import score_table
from blackboard.report.table import show_table, table_json
from blackboard.report.write import write_results
from blackboard.runner import Run, RunOptions


def add_run_options(parser: argparse.ArgumentParser) -> None:
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
    parser.add_argument("--strict", action="store_true", help="stop at the first component that raises")
    parser.add_argument("--json", action="store_true", help="print the table at the end as JSON")


def execute(mission: Mission, options: argparse.Namespace) -> int:
    """Run a mission, write its results, show its table; return the exit status. Ctrl-C writes what was gathered."""
    folder = Path(options.out) if options.out is not None else _new_folder(mission.name)
    run = Run(mission, RunOptions(seed=options.seed, strict=options.strict))
    prepare_output_folder(folder, options.force)
    interrupted, failure = False, None
    with JournalWriter(folder / FILE_NAME) as journal:
        run.board.journal = journal
        try:
            _run_showing_progress(run, options.duration)
        except KeyboardInterrupt:
            interrupted = True
            run.control.finish()
        except ComponentFailed as error:  # under --strict
            failure = error
    result = gather(run)
    write_results(result, folder)
    if failure is not None:
        raise failure
    for entry in run.board.entries(COMPONENT):
        if entry.value.state == "failed":
            on = f" on {entry.value.trigger_key}" if entry.value.trigger_key else ""
            sys.stderr.write(f"ski: {entry.id} failed{on} and was left out from then on: {entry.value.error}\n")
    if options.json:
        sys.stdout.write(table_json({**result.table, "out": str(folder)}) + "\n")
    else:
        show_table(result.table, mission.name)
        sys.stdout.write(f"Results in {folder}: look at {folder / 'overview.png'}\n")
    if interrupted:
        sys.stderr.write(f"ski: interrupted; what was gathered until then is in {folder}\n")
        return EXIT_INTERRUPTED
    return 0


def gather(run: Run) -> RunResult:
    """Return what a run knows at its end, with the table of its figures."""
    trajectory = run.trajectory()
    span_s = float(trajectory[-1, 0] - trajectory[0, 0]) if len(trajectory) else 0.0
    result = RunResult(
        mission=run.mission.name,
        robot=run.robot.description,
        trajectory=trajectory,
        grid=Grid.from_tiles(entry.value for entry in run.board.entries(GRID)),
        lines=run.board.entries(LINE),
        true_trajectory=run.true_trajectory(),
        truth=run.robot.truth(),
    )
    table: dict[str, float | int | str] = {"robot": result.robot.name, "time_s": span_s, "path_m": driven_m(trajectory)}
    table |= run.robot.summary()
    table |= {"lines": len(result.lines), "posts": run.board.posts}
    table |= score_table(result)
    return replace(result, table=table)


def _run_showing_progress(run: Run, duration_s: float | None) -> None:
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as shown:
        task = shown.add_task(run.mission.name)
        run.run(duration_s, lambda elapsed_s, total_s: shown.update(task, completed=elapsed_s, total=total_s))


def _new_folder(name: str) -> Path:
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
