"""Errors of rule files: one line with file, line and column, and what to do."""

from blackboard.errors import SkiError
from rules.language.syntax import Position


class RuleError(SkiError):
    """A rule file cannot be used, or a rule asked for something that cannot be done."""

    def __init__(self, text: str, position: Position | None = None) -> None:
        super().__init__(text if position is None else f"{position}: {text}")
        self.position = position
