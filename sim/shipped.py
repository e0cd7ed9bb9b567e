"""Worlds and robots by name: those that come with the package, and files of one's own."""

from pathlib import Path
from typing import Literal

from blackboard.errors import MissionError, did_you_mean
from blackboard.files import is_file, is_folder

Shelf = Literal["worlds", "robots"]

PACKAGE = Path(__file__).parent


def shipped_names(shelf: Shelf) -> list[str]:
    """Return the names of the worlds or robots that come with the package."""
    return sorted(path.stem for path in (PACKAGE / shelf).glob("*.toml"))


def find_file(name: Path, shelf: Shelf) -> Path:
    """Return the file of a shipped world or robot, given its bare name, or `name` itself if it is a path.

    Raises MissionError where there is none.
    """
    one = shelf.removesuffix("s")
    if len(name.parts) == 1 and not name.suffix:
        path = PACKAGE / shelf / f"{name}.toml"
        if not is_file(path):
            names = shipped_names(shelf)
            near = did_you_mean(str(name), names) if len(names) > 1 else ""
            hint = near if near.startswith("; did") else ""
            raise MissionError(
                f"unknown {one} '{name}'{hint} (shipped: {', '.join(names)}; or give the path of a file)"
            )
        return path
    if not is_file(name):
        what = "is a folder" if is_folder(name) else "does not exist"
        raise MissionError(f"{one} file '{name}' {what}; give a file, or one of {', '.join(shipped_names(shelf))}")
    return name
