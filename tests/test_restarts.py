"""Hosts that are killed in mid-mission, between any two posts, and come back: the mission ends as it would have."""

from typing import Any

import pytest
from hosts_in_step import Kill
from restarts import drive, key_faults, kills_of

from blackboard.entry import Entry, Event
from blackboard.kinds import TARGET
from blackboard.messages.geometry import Point
from blackboard.messages.symbols import Target
from blackboard.mission import find_mission, load_mission

HOSTS = ("robot", "behaviours", "knowledge_sources", "rules")
HERE = Target(place=Point(x_m=0.0, y_m=0.0), stand=Point(x_m=1.0, y_m=0.0), reason="frontier", size_m=1.0)


@pytest.mark.parametrize("forgets", [False, True], ids=["with checkpoints", "with nothing but the board"])
def test_the_mission_goes_on_where_it_was(forgets: bool) -> None:
    """Each host dies twice, between posts, while the others go on."""
    kills = [kill for host in HOSTS for kill in kills_of(host, 2, seed=7, forgets=forgets)]
    outcome = drive(load_mission(find_mission("explore-lab")), seed=1, kills=kills)
    assert outcome.ended
    assert outcome.restarts == len(kills)
    assert outcome.decided_fraction >= 0.95
    assert outcome.collisions == 0
    assert outcome.faults == []


@pytest.mark.parametrize("mission", ["explore-lab-joint", "explore-lab-lines", "explore-lab-symbols"])
def test_the_knowledge_of_other_missions_goes_on_too(mission: str) -> None:
    kills = [Kill(host="knowledge_sources", at_s=at_s, posts=posts) for at_s, posts in ((12.3, 5), (31.0, 17))]
    outcome = drive(load_mission(find_mission(mission)), seed=2, kills=kills, until_s=45.0)
    assert (outcome.restarts, outcome.collisions, outcome.faults) == (2, 0, [])


def entry(id_: str, revision: int, event: Event, stamp_s: float) -> Entry[Any]:
    key = f"ski/robot/{TARGET.path}/{id_}"
    return Entry(key=key, id=id_, revision=revision, event=event, stamp_s=stamp_s, source="s", value=HERE)


def test_faults_of_keys_are_found() -> None:
    first, gone = entry("frontier-1", 1, "posted", 1.0), entry("frontier-1", 2, "retracted", 2.0)
    assert key_faults([first, gone, entry("frontier-2", 1, "posted", 3.0)]) == []
    assert "given again" in key_faults([first, gone, entry("frontier-1", 3, "posted", 3.0)])[0]
    assert "came after" in key_faults([first, entry("frontier-1", 1, "revised", 3.0)])[0]
    assert "came after" in key_faults([first, entry("frontier-1", 2, "revised", 0.5)])[0]
