"""The rule files of a planning module: found, read, and watched for changes."""

from collections.abc import Iterable, Sequence
from importlib.resources import files
from pathlib import Path

from blackboard.errors import did_you_mean
from blackboard.files import is_file
from blackboard.messages.control import RuleFile
from rules.language.errors import RuleError
from rules.language.reader import read_texts
from rules.language.syntax import Program, Template

Stamp = tuple[int, int]  # time of the last change (ns) and size


def shipped_rule_files() -> dict[str, Path]:
    """Return the rule files that come with the project, by name."""
    return {path.stem: path for path in sorted(Path(str(files("rules"))).glob("*.clp"))}


def find_rule_file(path: Path) -> Path:
    """Return the file that a mission or a user names: a shipped one by its bare name, else a path. Raises RuleError."""
    shipped = shipped_rule_files()
    bare = len(path.parts) == 1
    name = path.name.removesuffix(".clp")
    if is_file(path):
        return path
    if bare and name in shipped:
        return shipped[name]
    hint = did_you_mean(name, shipped) if bare else ""
    raise RuleError(f"there is no rule file '{path}'{hint}")


class RuleFileSet:
    """Files that belong together, in order. Raises RuleError for one that is missing or cannot be read, and for two of one name."""

    def __init__(self, paths: Iterable[Path]) -> None:
        self.paths = tuple(find_rule_file(path) for path in paths)
        first: dict[str, Path] = {}
        for path in self.paths:
            if path.name in first:
                raise RuleError(f"{path}: there is another '{path.name}' ({first[path.name]}); rename one of them")
            first[path.name] = path
        self._stamps: tuple[Stamp | None, ...] = ()

    def changed(self) -> bool:
        """Say whether a file has changed since the last `read`; one that is gone for the moment has not."""
        stamps = self._look()
        return any(now is not None and now != before for now, before in zip(stamps, self._stamps, strict=True))

    def read(self) -> tuple[RuleFile, ...]:
        """Return names and texts, and take note of their state."""
        self._stamps = self._look()
        read = []
        for path in self.paths:
            try:
                read.append(RuleFile(name=path.name, text=path.read_text(encoding="utf-8-sig")))
            except UnicodeDecodeError as error:
                raise RuleError(f"{path}: byte {error.start} is no UTF-8; save the file as UTF-8 text") from None
            except OSError as error:
                raise RuleError(f"{path}: cannot be read ({error.strerror})") from None
        return tuple(read)

    def _look(self) -> tuple[Stamp | None, ...]:
        stamps: list[Stamp | None] = []
        for path in self.paths:
            try:
                state = path.stat()
                stamps.append((state.st_mtime_ns, state.st_size))
            except OSError:
                stamps.append(None)
        return tuple(stamps)


def program_of(texts: Iterable[RuleFile], templates: Sequence[Template]) -> Program:
    """Return the program that the files make up together. Raises RuleErrors."""
    return read_texts({file.name: file.text for file in texts}, templates)
