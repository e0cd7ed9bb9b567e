"""What rules say while a mission runs, on standard error: what they print, a changed file that took over or was refused, errors."""

import sys

from rich.console import Console

from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.kinds import COMMUNICATION_ERROR, FIRING, RULE_ERROR, RULES
from blackboard.messages.control import CommunicationError, Firing, RuleError, RuleFiles


def tell_what_is_said(board: Board, console: Console | None = None, of: str = "") -> None:
    """Write what rules say from now on as it comes, `of` before it, above the progress bar of `console` where there is one."""

    def tell(stamp_s: float, text: str) -> None:
        for line in text.splitlines():
            if console is not None and console.is_terminal:
                console.print(f"{stamp_s:8.1f} s  {of}{line}", markup=False, highlight=False)
            else:
                sys.stderr.write(f"{stamp_s:8.1f} s  {of}{line}\n")

    def said(entry: Entry[Firing]) -> None:
        if entry.value.said:
            tell(entry.stamp_s, entry.value.said)

    def files(entry: Entry[RuleFiles]) -> None:
        if entry.value.refused:
            tell(entry.stamp_s, f"the changed rules were refused, those before stay in force: {entry.value.refused}")
        elif entry.event == "revised":
            names = ", ".join(file.name for file in entry.value.files)
            tell(entry.stamp_s, f"changed rules took over ({names})")

    def error(entry: Entry[RuleError]) -> None:
        if entry.event != "retracted":
            tell(entry.stamp_s, f"rule {entry.value.rule}: {entry.value.text}")

    def late(entry: Entry[CommunicationError]) -> None:
        if entry.event != "retracted":
            tell(
                entry.stamp_s, f"{entry.id} has not acknowledged what it was asked for {entry.value.waited_s:.1f} s ago"
            )

    prefix = f"ski/{board.robot}"
    board.subscribe(f"{prefix}/{FIRING.path}/*", said)
    board.subscribe(f"{prefix}/{RULES.path}", files)
    board.subscribe(f"{prefix}/{RULE_ERROR.path}/*", error)
    board.subscribe(f"{prefix}/{COMMUNICATION_ERROR.path}/*", late)
