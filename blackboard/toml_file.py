"""TOML files with places: every complaint about one names file and line."""

import re
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from blackboard.errors import MissionError

_HEADER = re.compile(r"\s*(\[\[?)\s*([^\[\]]+?)\s*\]\]?\s*(?:#.*)?$")
_KEY = re.compile(r"\s*([A-Za-z0-9_-]+|\"[^\"]*\")\s*=")


@dataclass(frozen=True)
class Place:
    """A table in a file: `at(key)` says where one of its keys stands, for the start of an error."""

    file: str
    lines: tuple[str, ...]
    table: str  # "" for the top level
    index: int = 0  # which one of an array of tables

    def at(self, key: str | None = None) -> str:
        """Return `file:line: [table]`, as exact as can be found."""
        line = self.line(key) or self.line(None)
        number = f":{line}" if line else ""
        return f"{self.file}{number}: [{self.table}]" if self.table else f"{self.file}{number}"

    def line(self, key: str | None = None) -> int | None:
        """Return the line of a key, or of the table itself; None where it cannot be found."""
        inside, seen = self.table == "", -1
        for number, text in enumerate(self.lines, 1):
            header = _HEADER.match(text)
            if header:
                inside = header.group(2) == self.table
                if inside:
                    seen += 1
                    inside = seen == self.index or header.group(1) == "["
                if inside and key is None:
                    return number
            elif inside and key is not None:
                found = _KEY.match(text)
                if found and found.group(1).strip('"') == key:
                    return number
        return None


@dataclass(frozen=True)
class TomlFile:
    """A TOML file that was read."""

    path: Path
    lines: tuple[str, ...]
    data: dict[str, Any]

    def place(self, table: str = "", index: int = 0) -> Place:
        """Return the place of a table, for errors about it."""
        return Place(str(self.path), self.lines, table, index)


def read_toml(path: Path) -> TomlFile:
    """Read a TOML file; raise MissionError naming file, line and column where it cannot be read."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise MissionError(f"{path}: there is no such file") from None
    except IsADirectoryError:
        raise MissionError(f"{path}: this is a folder; name a .toml file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise MissionError(f"{path}: cannot be read ({error})") from None
    try:
        data = tomllib.loads(text)
    except ValueError as error:  # TOMLDecodeError, and numbers of thousands of digits
        raise MissionError(f"{path}: not valid TOML: {error}") from None
    except RecursionError:
        raise MissionError(f"{path}: not valid TOML: brackets in brackets, too deep to be read") from None
    return TomlFile(path=path, lines=tuple(text.splitlines()), data=data)
