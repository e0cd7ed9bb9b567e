"""Makes the output folder ready before a run, so that a long run never ends at a folder that cannot be written."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

from blackboard.errors import OutputError

FILES = (
    "board.jsonl",
    "figures.png",
    "grid.png",
    "lines.geojson",
    "map.gif",
    "map.pgm",
    "map.yaml",
    "overview.png",
    "trajectory.tum",
    "truth.tum",
)  # all that a run writes; nothing else is ever replaced or removed


def prepare_output_folder(folder: Path, force: bool = False) -> None:
    """Create `folder` with its parents, and try that it can be written.

    Raises OutputError if it holds anything (unless `force`), if something that is no folder is in the way, or if it cannot be
    written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        held = sorted(p.name for p in folder.iterdir())
        if held and not force:
            raise OutputError(
                f"output folder {folder} is not empty (it holds {held[0]}{' and more' if held[1:] else ''}); "
                "give --force to replace what an earlier run left there, or another --out"
            )
        for name in FILES:
            if (folder / name).is_dir():
                raise OutputError(f"{folder / name} is a folder where a file must go; move it, or give another --out")
        with tempfile.TemporaryFile(dir=folder):
            pass
    except FileExistsError:
        raise OutputError(f"output folder {folder} is a file; move it, or give another --out") from None
    except NotADirectoryError:
        raise OutputError(f"output folder {folder} lies below a file; give another --out") from None
    except OSError as error:
        raise unwritable(folder, error) from None


def prepare_team_folder(folder: Path, robots: Sequence[str], force: bool = False) -> None:
    """Make the folder of a run of several robots ready likewise, and one in it for each robot."""
    prepare_output_folder(folder, force)
    for name in robots:
        prepare_output_folder(folder / name, force)


def unwritable(path: Path, error: OSError) -> OutputError:
    """Return the error to raise when the system refuses to write `path`."""
    return OutputError(f"{path} cannot be written ({error.strerror or error}); give another --out")
