"""Files that only their owner may read: written whole or not at all."""

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from blackboard.errors import KeysError


def make_folder(path: Path, *, empty: bool = False) -> None:
    """Make a folder for its owner only, where there is none; raise KeysError where it cannot be, or ought to be `empty`."""
    try:
        path.mkdir(mode=0o700, parents=True, exist_ok=True)
        if empty and any(path.iterdir()):
            raise KeysError(f"{path} is not empty; name another folder")
    except OSError as error:
        raise KeysError(f"{path} cannot be made or looked into ({error.strerror}); name another folder") from None


def write_files(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write files by name into a folder, mode 0600; raise KeysError where that fails."""
    make_folder(folder)
    try:
        for name, content in files.items():
            descriptor, written = tempfile.mkstemp(dir=folder, prefix=f".{name}.")  # mkstemp makes it 0600
            try:
                with os.fdopen(descriptor, "wb") as file:
                    file.write(content)
                    file.flush()
                    os.fsync(file.fileno())
                Path(written).replace(folder / name)
            except BaseException:
                Path(written).unlink(missing_ok=True)
                raise
    except OSError as error:
        raise KeysError(f"{folder} cannot be written ({error.strerror})") from None


def read_file(path: Path) -> bytes:
    """Return what a key file holds; raise KeysError where it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise KeysError(f"{path} cannot be read ({error.strerror}); it is made by `ski keys init`") from None
