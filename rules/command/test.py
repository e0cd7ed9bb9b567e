"""`ski rules test [FILE.toml ...]`: tell stories about rules to an engine, and say where what stands is not what must."""

import argparse
import json
import sys
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path

from blackboard.errors import SkiError
from rules.engines.factory import ENGINES
from rules.language.errors import RuleError
from rules.storytelling.telling import Outcome, story_error, tell

EXIT_FAILED = 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("stories", nargs="*", type=Path, metavar="FILE", help="stories; the shipped ones unless given")
    parser.add_argument("--engine", choices=ENGINES, help="default: the one that the story's mission names")
    parser.add_argument("--verbose", action="store_true", help="also tell what rules did in each step")
    parser.add_argument("--json", action="store_true", help="print the outcomes as JSON")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    outcomes = []
    for path in options.stories or shipped_stories():
        try:
            outcomes.append(tell(path, options.engine))
        except SkiError as error:
            raise RuleError(story_error(path, error)) from None
    failed = sum(bool(outcome.failures) for outcome in outcomes)
    if options.json:
        sys.stdout.write(json.dumps([_as_dict(outcome) for outcome in outcomes], indent=2) + "\n")
        return EXIT_FAILED if failed else 0
    for outcome in outcomes:
        sys.stdout.writelines(f"{line}\n" for line in _told(outcome, verbose=options.verbose))
    number = len(outcomes)
    sys.stdout.write(f"{number - failed} of {number} stories are as told\n")
    return EXIT_FAILED if failed else 0


def shipped_stories() -> list[Path]:
    """Return the stories that come with the project."""
    return sorted((Path(str(files("rules"))) / "stories").glob("*.toml"))


def _told(outcome: Outcome, *, verbose: bool) -> Iterator[str]:
    story = outcome.story
    kept = sum(step.expectations for step in story.steps)
    if not outcome.failures:
        yield f"{story.path.name}: {story.title}: {len(story.steps)} steps, {kept} expectations"
    if verbose:
        for step, seen in outcome.played:
            at = "" if step.at_s is None else f" at {step.at_s:g} s"
            yield f"  {step.say}{at}"
            for firing in seen.firings:
                did = f": {'; '.join(firing.did)}" if firing.did else ""
                yield f"    {firing.rule}{did}"
    if outcome.failures:
        step, seen = outcome.played[-1]
        number = len(outcome.played)
        yield f"{story.path}:{step.line}: {story.title}: step {number}, {step.say}"
        for failure in outcome.failures:
            yield f"  line {failure.line}: expected  {failure.expected}"
            for i, found in enumerate(failure.found):
                yield f"  {' ' * len(f'line {failure.line}:')} {'found   ' if i == 0 else '        '}  {found}"
        yield f"  rules that fired in this step: {', '.join(dict.fromkeys(seen.fired)) or 'none'}"


def _as_dict(outcome: Outcome) -> dict[str, object]:
    return {
        "story": str(outcome.story.path),
        "title": outcome.story.title,
        "as_told": not outcome.failures,
        "steps": [{"say": step.say, "fired": seen.fired, "did": seen.did} for step, seen in outcome.played],
        "failures": [
            {"line": failure.line, "expected": failure.expected, "found": list(failure.found)}
            for failure in outcome.failures
        ],
    }
