"""Which run a verb asks about: the folder given with --in, else the newest one in runs/."""

import argparse
import math
import sys
from pathlib import Path

from blackboard.errors import BoardError, OutputError
from blackboard.journal import FILE_NAME

RUNS = Path("runs")


def add_run_folder(parser: argparse.ArgumentParser) -> None:
    """Declare --in."""
    parser.add_argument(
        "--in",
        dest="folder",
        type=Path,
        metavar="DIR",
        help="output folder of a run (default: the one in runs/ that was written last)",
    )


def run_folder(options: argparse.Namespace) -> Path:
    """Return the folder to read; raise OutputError where none is named and runs/ holds none. Says which one it took."""
    if options.folder is not None:
        folder = Path(options.folder)
        robots = sorted(path.parent.name for path in folder.glob(f"*/{FILE_NAME}"))
        if len(robots) == 1 and not (folder / FILE_NAME).exists():
            return folder / robots[0]
        if robots and not (folder / FILE_NAME).exists():
            raise OutputError(
                f"{folder} is a run of several robots ({', '.join(robots)}); name one: --in {folder / robots[0]}"
            )
        return folder
    found = [*RUNS.glob(f"*/{FILE_NAME}"), *RUNS.glob(f"*/*/{FILE_NAME}")]
    records = sorted(found, key=lambda path: (path.stat().st_mtime_ns, str(path)))
    if not records:
        raise OutputError(f"there is no run in {RUNS}/; name the output folder of one with --in DIR")
    sys.stderr.write(f"ski: in {records[-1].parent}\n")
    return records[-1].parent


def stamp(text: str) -> float:
    """Return the seconds that --at names; raise BoardError for what is no finite number."""
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not math.isfinite(seconds):
        raise BoardError(f"--at {text}: must be a number of seconds on the mission's clock")
    return seconds
