"""What a check has found: one line with its place."""

from dataclasses import dataclass

from rules.language.syntax import Position


@dataclass(frozen=True, slots=True)
class Finding:
    """A fault of a rule file: an error keeps it from being used, a warning does not."""

    text: str
    position: Position | None
    is_error: bool = False

    def __str__(self) -> str:
        place = "" if self.position is None else f"{self.position}: "
        return f"{place}{'error' if self.is_error else 'warning'}: {self.text}"


def in_order(findings: list[Finding]) -> list[Finding]:
    """Return the findings by file (as they come) and place, each once."""
    unique = list(dict.fromkeys(findings))
    files = list(dict.fromkeys("" if f.position is None else f.position.file for f in unique))
    return sorted(unique, key=lambda finding: (files.index(_place(finding)[0]), _place(finding)))


def _place(finding: Finding) -> tuple[str, int, int]:
    at = finding.position
    return ("", 0, 0) if at is None else (at.file, at.line, at.column)
