"""Every story that is shipped is as told, on either engine, and every rule that is shipped has a story in which it fires."""

from pathlib import Path

import pytest

from blackboard.vocabulary import Vocabulary
from rules.command.test import shipped_stories
from rules.language.reader import read_program
from rules.language.templates import planning_templates
from rules.rule_files import shipped_rule_files
from rules.storytelling.telling import Outcome, tell


@pytest.fixture(scope="module")
def outcomes() -> dict[Path, Outcome]:
    return {path: tell(path, "experta") for path in shipped_stories()}


@pytest.mark.parametrize("engine", ["experta", "clips"])
@pytest.mark.parametrize("path", shipped_stories(), ids=lambda path: path.stem)
def test_as_told(path: Path, engine: str, outcomes: dict[Path, Outcome]) -> None:
    if engine == "clips":
        pytest.importorskip("clips")
    outcome = outcomes[path] if engine == "experta" else tell(path, "clips")
    assert outcome.failures == ()
    assert len(outcome.played) == len(outcome.story.steps)


def test_every_rule_fires_in_a_story(outcomes: dict[Path, Outcome]) -> None:
    fired = {rule for outcome in outcomes.values() for _, seen in outcome.played for rule in seen.fired}
    program = read_program(shipped_rule_files().values(), planning_templates(Vocabulary()))
    untold = [rule.name for rule in program.rules if rule.name not in fired]
    assert untold == [], "write a story in rules/stories/ in which they fire"
