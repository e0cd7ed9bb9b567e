"""Story files: TOML, one story each, every text with the line that it stands on.

mission = "explore-lab"    whose rules decide, and whose behaviours and knowledge sources there are
files = ["explore.clp"]    other rule files than the mission's; seen from the story's folder
silent = ["curiosity"]     behaviours that never acknowledge what they are asked for

Then one [[step]] after the other. What happens in it, in this order:

at_s        the clock moves on to this time
gone        patterns: entries of the board that match are taken off it
entries     entries of the board, posted or revised: the slots that matter; an entry that stands keeps its others
retract     patterns: facts that match go from working memory
modify      a pattern and then slots: the one fact that matches gets them
assert      facts, straight into working memory

and what must be so once the rules have had their turn:

expect, expect_not    patterns of facts that must stand, or must not
motivations           "path_following on 3.2 1.1", "curiosity on", "curiosity off": as they stand on the board
does, does_not        what rules did in this step, in the words of `ski why`; * stands for anything
fires, fires_not      rules that fired in this step
prints                what rules printed in this step has this in it
errors                errors of rules in this step; any other error fails the story
"""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from blackboard.errors import did_you_mean
from blackboard.files import is_file
from blackboard.toml_file import Place, TomlFile, read_toml
from rules.language.errors import RuleError

STORY_KEYS = ("title", "mission", "files", "silent", "step")
DEFAULT_MISSION = "explore-lab"


@dataclass(frozen=True, slots=True)
class Said:
    """A text of a story, and its line."""

    text: str
    line: int


Row = tuple[Said, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One step of a story; the module's docstring says what each field means."""

    say: str
    line: int
    at_s: float | None = None
    gone: Row = ()
    entries: Row = ()
    retract: Row = ()
    modify: Row = ()
    asserted: Row = ()
    expect: Row = ()
    expect_not: Row = ()
    motivations: Row = ()
    does: Row = ()
    does_not: Row = ()
    fires: Row = ()
    fires_not: Row = ()
    prints: Row = ()
    errors: Row = ()

    @property
    def expectations(self) -> int:
        """How many things must be so after it."""
        kinds = (self.expect, self.expect_not, self.motivations, self.does, self.does_not)
        return sum(map(len, (*kinds, self.fires, self.fires_not, self.prints, self.errors)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Story:
    """A story file, read; nothing in it has been understood yet."""

    path: Path
    title: str
    mission: str
    files: tuple[Path, ...]
    silent: tuple[str, ...]
    steps: tuple[Step, ...]


ROWS = {"assert" if field.name == "asserted" else field.name: field.name for field in fields(Step)}
STEP_KEYS = (*ROWS,)


def read_story(path: Path) -> Story:
    """Read a story. Raises MissionError for what is no TOML, RuleError with file and line for anything unknown or missing."""
    file = read_toml(path)
    place = file.place()
    _refuse_unknown(file.data, STORY_KEYS, place)
    found = file.data.get("step")
    if not isinstance(found, list) or not found:
        raise RuleError(f"{path}: a story needs at least one [[step]]")
    title = file.data.get("title", path.stem.replace("-", " "))
    mission = file.data.get("mission", DEFAULT_MISSION)
    for key, value in (("title", title), ("mission", mission)):
        if not isinstance(value, str):
            raise RuleError(f"{place.at(key)}: {key} = {value!r} must be a text in quotation marks")
    steps = tuple(_step(file, index, raw) for index, raw in enumerate(found))
    _refuse_backwards(path, steps)
    return Story(
        path=path,
        title=title,
        mission=mission,
        files=tuple(_rule_file(path, said.text) for said in _texts(file, place, "files", file.data)),
        silent=tuple(said.text.replace("-", "_") for said in _texts(file, place, "silent", file.data)),
        steps=steps,
    )


def _step(file: TomlFile, index: int, raw: Any) -> Step:
    place = file.place("step", index)
    if not isinstance(raw, dict):
        raise RuleError(f"{place.at()}: write [[step]]")
    _refuse_unknown(raw, STEP_KEYS, place)
    say, at_s = raw.get("say", f"step {index + 1}"), raw.get("at_s")
    if not isinstance(say, str):
        raise RuleError(f"{place.at('say')}: say = {say!r} must be a text in quotation marks")
    number = isinstance(at_s, int | float) and not isinstance(at_s, bool) and math.isfinite(at_s)
    if at_s is not None and (not number or at_s < 0):
        raise RuleError(f"{place.at('at_s')}: at_s = {at_s!r} must be a number of seconds, 0 or more")
    rows = {name: _texts(file, place, key, raw) for key, name in ROWS.items() if key not in ("say", "line", "at_s")}
    time_s = None if at_s is None else float(at_s)
    return Step(say=say, line=place.line() or 1, at_s=time_s, **rows)


def _refuse_backwards(path: Path, steps: tuple[Step, ...]) -> None:
    now_s = 0.0
    for step in steps:
        if step.at_s is not None and step.at_s < now_s:
            raise RuleError(f"{path}:{step.line}: at_s = {step.at_s:g} lies before the step before it ({now_s:g} s)")
        now_s = step.at_s if step.at_s is not None else now_s


def _refuse_unknown(table: Mapping[str, Any], known: tuple[str, ...], place: Place) -> None:
    for key in table:
        if key not in known or key == "line":
            raise RuleError(
                f"{place.at(key)}: unknown key '{key}'{did_you_mean(key, [k for k in known if k != 'line'])}"
            )


def _rule_file(story: Path, name: str) -> Path:
    """Return a rule file as the story names it: a path from its folder, or the name of a shipped one."""
    beside = story.parent / name
    return beside if is_file(beside) else Path(name)


def _texts(file: TomlFile, place: Place, key: str, table: Mapping[str, Any]) -> Row:
    """Return the texts of a key, one or a list of them, each with the line that it is found on."""
    value = table.get(key, [])
    texts = [value] if isinstance(value, str) else value
    if not isinstance(texts, list) or not all(isinstance(text, str) for text in texts):
        raise RuleError(f'{place.at(key)}: {key} must be a text, or a list of texts: ["...", "..."]')
    line, said = place.line(key) or 1, list[Said]()
    for text in texts:
        written = {text.strip().split("\n")[0], json.dumps(text, ensure_ascii=False)[1:-1]}
        rest = enumerate(file.lines[line - 1 :], line)
        line = next((number for number, words in rest if any(one in words for one in written)), line)
        said.append(Said(text, line))
    return tuple(said)
