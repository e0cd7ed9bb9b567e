"""Story files that cannot be told: one line, with the place and what to do."""

import re
from pathlib import Path

import pytest

from blackboard.command.main import main
from blackboard.errors import SkiError
from rules.storytelling.story_file import Said, read_story
from rules.storytelling.telling import tell


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", r"story\.toml: a story needs at least one \[\[step\]\]"),
        ("[[step]]\nexpects = 'x'\n", r"story\.toml:2: \[step\]: unknown key 'expects'; did you mean 'expect'\?"),
        ("titel = 'x'\n[[step]]\n", r"story\.toml:1: unknown key 'titel'; did you mean 'title'\?"),
        ("[[step]]\n[[step]]\nassert = 3\n", r"story\.toml:3: \[step\]: assert must be a text, or a list of texts"),
        ("[[step]]\nat_s = 5\n[[step]]\nat_s = 4\n", r"story\.toml:3: at_s = 4 lies before the step before it \(5 s\)"),
        ("[[step]]\nat_s = true\n", r"story\.toml:2: \[step\]: at_s = True must be a number of seconds, 0 or more"),
        ("[[step]]\nassert = [\n'(a)',\n'(b',\n]\n", r"story\.toml:4: .*bracket"),
        ("[[step]]\nexpect = '(goal (tarket a))'\n", r"story\.toml:2: .*tarket.*did you mean 'target'"),
        ("[[step]]\nexpect = '(not (goal))'\n", r"story\.toml:2: write one pattern of a fact: \(not \(goal\)\)"),
        ("[[step]]\nassert = '(travel (id a))'\n", r"story\.toml:2: .* is an entry of the board; put it under `entries`"),
        ("[[step]]\nentries = '(goal (target a))'\n", r"story\.toml:2: .* is no entry of the board; put it under `assert`"),
        ("[[step]]\nentries = '(travel (state reachable))'\n", r"story\.toml:2: 'travel' needs \(id \.\.\.\)"),
        ("[[step]]\nentries = '(travel (id a) (state far))'\n", r"story\.toml:2: 'travel': .*far"),
        ("[[step]]\nfires_not = 'first-wonder'\n", r":2: there is no rule 'first-wonder'; did you mean 'first-wander'\?"),
        ("[[step]]\nexpect_not = '(moed go)'\n", r"story\.toml:2: nothing speaks of \(moed \.\.\.\); did you mean 'mode'\?"),
        ("[[step]]\nretract = '(mode go)'\n", r"story\.toml:2: no fact matches this"),
        ("[[step]]\ngone = '(travel (id a))'\n", r"story\.toml:2: gone: no entry matches this"),
        ("[[step]]\nmodify = '(goal (target a))'\n", r"story\.toml:2: modify: write a pattern and then the slots"),
        ("silent = 'sleeping'\n[[step]]\n", r"story\.toml: silent: the mission 'explore-lab' has no behaviour 'sleeping'"),
        ("mission = 'explore-lap'\n[[step]]\n", r"there is no mission 'explore-lap'; did you mean 'explore-lab'\?"),
        ("[[step]]\nat_s = \n", r"story\.toml: not valid TOML"),
    ],
)  # fmt: skip
def test_what_cannot_be_told(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "story.toml"
    path.write_text(text)
    with pytest.raises(SkiError) as caught:
        tell(path)
    assert re.search(told, str(caught.value)), caught.value


def test_lines_of_texts_and_a_bad_rule_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a-story.toml"
    path.write_text('files = ["rules.clp"]\n[[step]]\nexpect = [\n  "(a \\"x\\")",\n  \'(b)\', "(c)",\n]\n')
    story = read_story(path)
    assert story.steps[0].expect == (Said('(a "x")', 4), Said("(b)", 5), Said("(c)", 5))
    assert (story.title, story.steps[0].say, story.steps[0].line) == ("a story", "step 1", 2)
    (tmp_path / "rules.clp").write_text("(defrule r (mode go)\n")
    assert main(["rules", "test", str(path)]) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"ski: {path}: rules.clp:1:1: ")
