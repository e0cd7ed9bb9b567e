"""Tells a story to an engine: plays its steps, and says where what stands is not what must."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Literal

from blackboard.errors import SkiError
from blackboard.files import is_file
from blackboard.messages.motion import Motivation
from blackboard.mission import find_mission, load_mission
from rules.checks.parts import parts_of
from rules.explaining.why_not import brief
from rules.language.errors import RuleError
from rules.language.syntax import Pattern
from rules.language.templates import planning_templates
from rules.planning import PlanningParams
from rules.rule_files import find_rule_file
from rules.storytelling.fragments import Fragments, read_fragments
from rules.storytelling.stage import CLOCK_S, Seen, Stage
from rules.storytelling.story_file import Said, Step, Story, read_story

NEAREST_SHOWN = 3
ERRORS_SHOWN = 5


@dataclass(frozen=True, slots=True)
class Failure:
    """What is not as a story tells it: the line, the expectation, and what was found instead."""

    line: int
    expected: str
    found: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a story went: the steps that were played, each with what rules did, and the failures of the last of them."""

    story: Story
    played: tuple[tuple[Step, Seen], ...]
    failures: tuple[Failure, ...] = ()


def tell(path: Path, engine: Literal["experta", "clips"] | None = None) -> Outcome:
    """Tell a story file to an engine, that of its mission unless one is named. Raises a SkiError where it cannot be told."""
    story = read_story(path)
    mission = load_mission(_mission(story))
    params = mission.rules.params if mission.rules is not None else None
    files: Sequence[Path] = story.files or (params.files if isinstance(params, PlanningParams) else ())
    if not files:
        raise RuleError(f"{path}: the mission '{story.mission}' has no rules; name rule files: files = [...]")
    chosen = engine or (params.engine if isinstance(params, PlanningParams) else "experta")
    found = tuple(find_rule_file(file) for file in files)
    parts = parts_of(mission)
    for name in story.silent:
        if name not in parts.behaviours:
            raise RuleError(f"{path}: silent: the mission '{story.mission}' has no behaviour '{name}'")
    base = params if isinstance(params, PlanningParams) else PlanningParams(files=found)
    settings = replace(base, files=found, engine=chosen, clock_s=CLOCK_S, reload_s=0.0)
    texts = {file.name: file.read_text(encoding="utf-8") for file in found}
    fragments = read_fragments(story, texts, planning_templates(parts.vocabulary))
    stage = Stage(story, settings, parts, fragments)
    try:
        return _play(story, stage, fragments)
    finally:
        stage.close()


def _mission(story: Story) -> Path:
    beside = story.path.parent / story.mission
    return beside if is_file(beside) else find_mission(story.mission)


def _play(story: Story, stage: Stage, fragments: Fragments) -> Outcome:
    played: list[tuple[Step, Seen]] = []
    for step in story.steps:
        seen = stage.play(step)
        played.append((step, seen))
        failures = tuple(_failures(step, seen, stage, fragments))
        if failures:
            return Outcome(story, tuple(played), failures)
    return Outcome(story, tuple(played))


def _failures(step: Step, seen: Seen, stage: Stage, fragments: Fragments) -> Iterator[Failure]:
    for said in step.expect:
        pattern = fragments.patterns[said]
        if not stage.matching(pattern):
            yield Failure(said.line, f"a fact {said.text}", tuple(_nearest(pattern, stage)))
    for said in step.expect_not:
        found = [brief(stage.facts[index]) for index in stage.matching(fragments.patterns[said])]
        if found:
            yield Failure(said.line, f"no fact {said.text}", tuple(found))
    for said in step.motivations:
        yield from _motivation(said, stage)
    yield from _deeds(step, seen)
    for said in step.fires:
        if said.text not in seen.fired:
            yield Failure(said.line, f"rule {said.text} fires", _fired(seen))
    for said in step.fires_not:
        if said.text in seen.fired:
            yield Failure(said.line, f"rule {said.text} does not fire", _fired(seen))
    for said in step.prints:
        if said.text not in seen.said:
            yield Failure(said.line, f"printed: {said.text}", (seen.said.strip() or "nothing was printed",))
    yield from _errors(step, seen)


def _nearest(pattern: Pattern, stage: Stage) -> Iterator[str]:
    alike = [fact for fact in stage.facts.values() if fact.relation == pattern.relation]
    if not alike:
        yield f"no fact ({pattern.relation} ...) at all"
        return
    told = [(stage.matcher.differences(pattern, fact, {}), fact) for fact in alike]
    for differences, fact in sorted(told, key=lambda pair: len(pair[0]))[:NEAREST_SHOWN]:
        yield f"{brief(fact, pattern.slots)}: {', '.join(map(str, differences))}"


def _motivation(said: Said, stage: Stage) -> Iterator[Failure]:
    name, *wanted = said.text.split()
    behaviour = name.replace("-", "_")
    asked = stage.motivation(behaviour)
    if asked is None:
        yield Failure(said.line, f"motivation {said.text}", (f"{behaviour} was never asked for anything",))
    elif not _is_as_wanted(asked, wanted):
        yield Failure(said.line, f"motivation {said.text}", (f"{behaviour} {_shown(asked)}",))


def _is_as_wanted(asked: Motivation, wanted: Sequence[str]) -> bool:
    """Say whether a motivation is `on`, `on` with parameters, or `off`; without parameters any will do."""
    if not wanted or asked.on is not (wanted[0] == "on"):
        return False
    if len(wanted) == 1:
        return True
    given = asked.parameters
    return len(given) == len(wanted) - 1 and all(_same(a, b) for a, b in zip(given, wanted[1:], strict=True))


def _same(given: float | str, wanted: str) -> bool:
    if isinstance(given, str):
        return given == wanted
    try:
        return abs(given - float(wanted)) < 1e-6
    except ValueError:
        return False


def _shown(asked: Motivation) -> str:
    given = " ".join(f"{one:g}" if isinstance(one, float) else one for one in asked.parameters)
    return f"{'on' if asked.on else 'off'} {given}".strip()


def _deeds(step: Step, seen: Seen) -> Iterator[Failure]:
    did = tuple(seen.did) or ("rules did nothing on the board",)
    for said in step.does:
        if not any(fnmatchcase(deed, said.text) for deed in seen.did):
            yield Failure(said.line, f"rules do: {said.text}", did)
    for said in step.does_not:
        if any(fnmatchcase(deed, said.text) for deed in seen.did):
            yield Failure(said.line, f"rules do not: {said.text}", did)


def _errors(step: Step, seen: Seen) -> Iterator[Failure]:
    told = list(dict.fromkeys(f"{error.rule}: {error.text}" for error in seen.errors))
    for said in step.errors:
        if not any(fnmatchcase(text, said.text) for text in told):
            yield Failure(said.line, f"an error {said.text}", tuple(told) or ("there was no error",))
    stray = [text for text in told if not any(fnmatchcase(text, said.text) for said in step.errors)]
    if stray:
        more = [f"and {len(stray) - ERRORS_SHOWN} more"] if len(stray) > ERRORS_SHOWN else []
        yield Failure(step.line, "no error of a rule", (*stray[:ERRORS_SHOWN], *more))


def _fired(seen: Seen) -> tuple[str, ...]:
    return (f"fired: {', '.join(dict.fromkeys(seen.fired))}",) if seen.fired else ("no rule fired",)


def story_error(path: Path, error: SkiError) -> str:
    """Return an error of a story with the story's name before it, where it does not stand there yet."""
    return str(error) if str(path) in str(error) else f"{path}: {error}"
