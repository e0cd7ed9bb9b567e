"""Errors of rule files: one line with file, line and column, and what to do."""

from collections.abc import Sequence

from blackboard.errors import SkiError
from rules.language.syntax import Position


class RuleError(SkiError):
    """A rule file cannot be used, or a rule asked for something that cannot be done."""

    def __init__(self, text: str, position: Position | None = None) -> None:
        super().__init__(text if position is None else f"{position}: {text}")
        self.position = position


class RuleErrors(RuleError):
    """Every fault of some rule files, in the order of the text; as one line it is the first, and how many more there are."""

    def __init__(self, errors: Sequence[RuleError]) -> None:
        unique = {str(error): error for error in errors}
        files = list(dict.fromkeys(_file(error) for error in unique.values()))  # in the order in which they were read
        self.errors = tuple(sorted(unique.values(), key=lambda error: (files.index(_file(error)), *_place(error))))
        more = len(self.errors) - 1
        super().__init__(f"{self.errors[0]}{f' (and {more} more: `ski rules check` lists them)' if more else ''}")
        self.position = self.errors[0].position


def _file(error: RuleError) -> str:
    return "" if error.position is None else error.position.file


def _place(error: RuleError) -> tuple[int, int]:
    return (0, 0) if error.position is None else (error.position.line, error.position.column)
