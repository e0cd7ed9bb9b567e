"""What a mission of several robots came to: a folder for each robot, tables and a picture for all of them."""

import sys
from collections.abc import Mapping
from pathlib import Path

from rich.console import Console

from blackboard.command.execute import complain, ending
from blackboard.command.main import EXIT_INTERRUPTED
from blackboard.command.seen_run import SeenRun
from blackboard.report.output_folder import unwritable
from blackboard.report.result import RunResult
from blackboard.report.table import end_table, table_json
from blackboard.report.team import side_by_side, team_table
from blackboard.report.team_overview import write_team_overview


def tell_team_results(
    title: str,
    runs: Mapping[str, SeenRun],
    results: Mapping[str, RunResult],
    folder: Path,
    *,
    json: bool,
    interrupted: bool,
) -> int:
    """Draw the picture of all robots, show their tables, and what failed; return the exit status."""
    table = team_table(results)
    told = (
        f"{table['robots']}   ·   {table['time_s']:.0f} s   ·   met each other {table.get('met_each_other', 0)} times"
    )
    try:
        write_team_overview(results, title, told, folder / "overview.png")
    except OSError as error:
        raise unwritable(folder / "overview.png", error) from None
    for name, run in runs.items():
        complain(run, f"{name}: ")
    if json:
        robots = ",\n".join(f'"{name}": {table_json(result.table)}' for name, result in results.items())
        sys.stdout.write(f'{{"team": {table_json({**table, "out": str(folder)})},\n"robots": {{{robots}}}}}\n')
    else:
        console = Console()
        console.print(side_by_side({name: result.table for name, result in results.items()}, title))
        console.print(end_table(table, "all together"))
        for name, run in runs.items():
            said = ending(run)
            sys.stdout.write(f"{name}: {said}" if said else "")
        sys.stdout.write(f"Results in {folder}: look at {folder / 'overview.png'}\n")
    if interrupted:
        sys.stderr.write(f"ski: interrupted; what was gathered until then is in {folder}\n")
        return EXIT_INTERRUPTED
    return 0
