"""What stands on disk about the processes of one address: who they are, so that `ski down` finds them with everybody else dead.

`<state>/<address>/processes/<name>.json`: number and start of each process; `logs/<name>.log`: what it wrote;
`hosts/<manager>/<name>/`: outboxes and checkpoints of the hosts.
"""

import contextlib
import os
import shutil
from pathlib import Path

import msgspec

from blackboard.errors import OutputError
from blackboard.processes.identity import Identity, is_alive

MANAGER, AGENT = "manager", "agent"


class Record(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A process as its starter wrote it down."""

    name: str
    who: Identity
    mission: str = ""
    log: str = ""


def state_root() -> Path:
    """Return where all state is kept: $SKI_STATE, else the user's state folder."""
    named = os.environ.get("SKI_STATE")
    if named:
        return Path(named)
    base = os.environ.get("XDG_STATE_HOME")
    return (Path(base) if base else Path.home() / ".local" / "state") / "ski"


def addresses_in_use(root: Path) -> list[str]:
    """Return the addresses for which something is written down, by name of their folder."""
    return sorted(folder.parent.name for folder in root.glob("*/processes") if any(folder.glob("*.json")))


class StateFolder:
    """The folder of one address."""

    def __init__(self, address: str, root: Path | None = None) -> None:
        self.path = (root or state_root()) / folder_name(address)
        self.logs = self.path / "logs"
        self._processes = self.path / "processes"

    def write(self, record: Record) -> None:
        """Write a process down, all of it or nothing."""
        try:
            self._processes.mkdir(parents=True, exist_ok=True)
            new = self._processes / f".{record.name}.{os.getpid()}"
            new.write_bytes(msgspec.json.encode(record))
            new.replace(self._processes / f"{record.name}.json")
        except OSError as error:
            raise OutputError(
                f"{self._processes}: cannot be written ({error.strerror}); set SKI_STATE to a folder"
            ) from None

    def drop(self, name: str) -> None:
        """Strike a process out."""
        with contextlib.suppress(OSError):
            (self._processes / f"{name}.json").unlink(missing_ok=True)

    def records(self, *, alive: bool = True) -> list[Record]:
        """Return what is written down, of processes that still run unless told otherwise; what cannot be read is passed over."""
        found = []
        for path in sorted(self._processes.glob("*.json")):
            with contextlib.suppress(OSError, msgspec.DecodeError, UnicodeDecodeError, RecursionError):
                record = msgspec.json.decode(path.read_bytes(), type=Record)
                if not alive or is_alive(record.who):
                    found.append(record)
        return found

    def record(self, name: str) -> Record | None:
        """Return one process that still runs."""
        return next((record for record in self.records() if record.name == name), None)

    def hosts_of(self, manager: str) -> Path:
        """Return the folder of what must outlive a kill of one manager's hosts; that of earlier managers is no use any more."""
        own = self.path / "hosts" / manager
        for folder in self.path.glob("hosts/*"):
            if folder != own:
                shutil.rmtree(folder, ignore_errors=True)
        return own

    def forget_hosts(self) -> None:
        """Take away what was to outlive a kill of hosts: their mission is over."""
        shutil.rmtree(self.path / "hosts", ignore_errors=True)

    def clear(self) -> None:
        """Strike everything out; logs stay."""
        shutil.rmtree(self._processes, ignore_errors=True)
        self.forget_hosts()


def folder_name(address: str) -> str:
    """Return an address as the name of a folder."""
    return "".join(c if c.isalnum() or c in "._-" else "-" for c in address)
