"""The examples in docs/processes.md work as they stand there."""

import re
from pathlib import Path

from blackboard.assembly import assemble
from blackboard.command.main import VERBS
from blackboard.mission import load_mission, shipped_missions
from blackboard.placement import HostParams, placement

PAGE = (Path(__file__).parents[3] / "docs" / "processes.md").read_text()


def block(language: str) -> str:
    found = re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)
    assert len(found) == 1
    return str(found[0])


def test_the_tables_are_those_of_a_mission(tmp_path: Path) -> None:
    file = tmp_path / "m.toml"
    file.write_text(shipped_missions()["explore-lab"].read_text() + "\n" + block("toml"))
    plans = {plan.name: plan for plan in placement(load_mission(file))}
    assert list(plans) == ["body", "map", "knowledge_sources", "rules"]
    assert (plans["map"].sources, plans["map"].params.on) == (("eou_grid", "line_finder"), "desk")
    said = plans["body"].params
    assert (said.restarts, said.within_s, said.stop_s) == (
        HostParams().restarts,
        HostParams().within_s,
        HostParams().stop_s,
    )


def test_the_rule_is_one_that_a_mission_can_have(tmp_path: Path) -> None:
    (tmp_path / "gone.clp").write_text(block("clips"))
    text = shipped_missions()["explore-lab-hosts"].read_text()
    assert '"control"]' in text
    (tmp_path / "m.toml").write_text(text.replace('"control"]', '"control", "gone.clp"]'))
    assembly = assemble(load_mission(tmp_path / "m.toml"))
    assert assembly.planner is not None
    assembly.planner.start(assembly.parts())
    assembly.planner.close()


def test_every_verb_is_one() -> None:
    assert set(re.findall(r"`?ski ([a-z]+)", PAGE)) <= set(VERBS)
