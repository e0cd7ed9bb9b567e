import pytest

from blackboard.assembly import assemble
from blackboard.component import Component
from blackboard.errors import MissionError
from blackboard.keeper.mission_kinds import mission_vocabulary, uses
from blackboard.loading import load_class
from blackboard.mission import load_mission, shipped_missions
from blackboard.toml_file import read_toml
from blackboard.vocabulary import Vocabulary

MUG = """
from blackboard.component import KnowledgeSource
from blackboard.kinds import SONAR_SCAN, slot
from blackboard.messages.base import Message

class Mug(Message, frozen=True, kw_only=True):
    full: bool

MUG = slot("observations/symbol/mug", Mug, "a mug")

class MugSource(KnowledgeSource):
    triggers = (SONAR_SCAN,)
    posts = (MUG,)

    def activate(self, trigger, board):
        pass
"""
MISSION = """
[robot]
use = "sim.simulated:SimulatedRobot"
[[knowledge_source]]
use = "mug.py:MugSource"
"""


def test_kinds_that_a_missions_own_components_bring_are_known(tmp_path):
    (tmp_path / "mug.py").write_text(MUG)
    (tmp_path / "mugs.toml").write_text(MISSION)
    assert list(uses(read_toml(tmp_path / "mugs.toml").data)) == ["sim.simulated:SimulatedRobot", "mug.py:MugSource"]
    vocabulary = mission_vocabulary([str(tmp_path / "mugs.toml"), "explore-lab"])
    assert vocabulary.at("observations/symbol/mug").name == "mug"


def test_shipped_components_bring_no_kinds_of_their_own():
    core = [kind.path for kind in Vocabulary()]
    for path in shipped_missions().values():
        for use in uses(read_toml(path).data):
            type_ = load_class(use, Component, where=str(path), folder=path.parent)
            declared = [kind for what in ("reads", "posts", "provides") for kind in getattr(type_, what, ())]
            assert {kind.path for kind in declared} <= set(core), use
    assert [kind.path for kind in assemble(load_mission(shipped_missions()["explore-lab"])).vocabulary] == core
    assert [kind.path for kind in mission_vocabulary(list(shipped_missions()))] == core


def test_a_mission_that_is_not_there_is_refused():
    with pytest.raises(MissionError, match="there is no mission 'explore-lap'; did you mean 'explore-lab'"):
        mission_vocabulary(["explore-lap"])
