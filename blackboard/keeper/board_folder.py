"""The folder that a keeper journals in: one folder below it for each robot."""

import time
from pathlib import Path

from blackboard.errors import OutputError
from blackboard.journal import FILE_NAME
from blackboard.key_expressions import is_chunk

DEFAULT = Path("runs/board")
EARLIER = "earlier"  # boards that were set aside


def robots_in(folder: Path) -> list[str]:
    """Return the robots whose boards stand in a folder."""
    return sorted(path.parent.name for path in folder.glob(f"*/{FILE_NAME}") if is_chunk(path.parent.name))


def set_aside(folder: Path) -> Path | None:
    """Move the boards in a folder, and their clocks, to a folder of their own below it; return that, None where there are none."""
    there = [path for path in folder.glob("*") if path.is_dir() and path.name != EARLIER] if folder.is_dir() else []
    if not there:
        return None
    place = folder / EARLIER / time.strftime("%Y%m%d-%H%M%S")
    try:
        place.mkdir(parents=True)
        for path in there:
            path.rename(place / path.name)
    except OSError as error:
        raise OutputError(f"{place}: the earlier boards cannot be moved there ({error.strerror})") from None
    return place
