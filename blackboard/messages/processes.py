"""How the processes of a mission fare, as their executors tell."""

from typing import Annotated, Literal

from msgspec import Meta

from blackboard.messages.base import Count, Message, Text


class ProcessStatus(Message, frozen=True, kw_only=True):
    """A process, by its host's name: `waiting` to be started again, `hung` and being killed for it, `failed` and given up, `done`
    with its work, `lost` with its executor. `exit_code` or `exit_signal` and `last_line` (of its log) tell of its last end.
    """

    state: Literal["starting", "running", "hung", "waiting", "stopping", "stopped", "failed", "done", "lost"]
    machine: Annotated[str, Meta(max_length=200)] = ""
    pid: Count = 0
    restarts: Count = 0
    exit_code: Count | None = None
    exit_signal: Count | None = None
    last_line: Text = ""
