"""One process for one folder: a keeper for its journals, a host for its outbox and checkpoints."""

import fcntl
import os
from pathlib import Path

from blackboard.errors import OutputError


class FolderLock:
    """Holds a folder until it is released or the process ends, however that comes about."""

    def __init__(self, folder: Path, who: str, option: str) -> None:
        """Take it for `who` (keeper, host), to whom `option` gave it. Raises OutputError where another has it."""
        path = folder / f"{who}.lock"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise OutputError(f"{path}: cannot be written ({error.strerror}); choose another {option}") from None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            holder = os.pread(self._file, 20, 0).decode("ascii", "replace").strip()
            os.close(self._file)
            by = f" (process {holder})" if holder else ""
            raise OutputError(f"{folder}: another {who}{by} uses it; stop that, or choose another {option}") from None
        os.ftruncate(self._file, 0)
        os.pwrite(self._file, str(os.getpid()).encode(), 0)

    def release(self) -> None:
        """Let go of the folder."""
        os.close(self._file)
