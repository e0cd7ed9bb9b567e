"""Files that somebody names."""

from pathlib import Path


def is_file(path: Path) -> bool:
    """Say whether there is a file; a name that no file can have (too long) names none."""
    try:
        return path.is_file()
    except OSError:
        return False


def is_folder(path: Path) -> bool:
    """Say whether there is a folder; a name that no folder can have names none."""
    try:
        return path.is_dir()
    except OSError:
        return False
