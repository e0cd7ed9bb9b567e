"""What stands on disk about processes: only those that run are told of, and nothing is lost by a bad file."""

import os
from pathlib import Path

import pytest

from blackboard.errors import OutputError
from blackboard.processes.identity import Identity, identity_of
from blackboard.processes.state_folder import Record, StateFolder, addresses_in_use, folder_name, state_root

ADDRESS = "tcp/127.0.0.1:7551"


def me() -> Identity:
    found = identity_of(os.getpid())
    assert found is not None
    return found


def test_a_record_is_read_back(tmp_path: Path) -> None:
    state = StateFolder(ADDRESS, tmp_path)
    state.write(Record(name="map", who=me(), mission="explore-lab", log="map.log"))
    assert state.record("map") == Record(name="map", who=me(), mission="explore-lab", log="map.log")
    assert addresses_in_use(tmp_path) == [folder_name(ADDRESS)] == ["tcp-127.0.0.1-7551"]


def test_who_is_gone_is_not_told_of(tmp_path: Path) -> None:
    state = StateFolder(ADDRESS, tmp_path)
    state.write(Record(name="map", who=Identity(os.getpid(), "another start")))
    assert state.records() == []
    assert [record.name for record in state.records(alive=False)] == ["map"]


def test_dropped_and_cleared(tmp_path: Path) -> None:
    state = StateFolder(ADDRESS, tmp_path)
    for name in ("robot", "rules"):
        state.write(Record(name=name, who=me()))
    state.drop("robot")
    state.drop("robot")
    assert [record.name for record in state.records()] == ["rules"]
    state.clear()
    assert addresses_in_use(tmp_path) == []


def test_the_state_of_hosts_is_each_managers_own(tmp_path: Path) -> None:
    state = StateFolder(ADDRESS, tmp_path)
    (state.hosts_of("first") / "map").mkdir(parents=True)
    assert (state.hosts_of("first") / "map").is_dir()
    assert state.hosts_of("second") == state.path / "hosts" / "second"
    assert not (state.path / "hosts" / "first").exists()


def test_a_bad_file_is_passed_over(tmp_path: Path) -> None:
    state = StateFolder(ADDRESS, tmp_path)
    state.write(Record(name="rules", who=me()))
    (state.path / "processes" / "map.json").write_text('{"name": "map"')
    assert [record.name for record in state.records()] == ["rules"]


def test_where_nothing_can_be_written_that_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="set SKI_STATE to a folder"):
        StateFolder(ADDRESS, tmp_path / "file").write(Record(name="map", who=me()))


def test_where_state_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SKI_STATE", "/somewhere")
    assert state_root() == Path("/somewhere")
    monkeypatch.delenv("SKI_STATE")
    monkeypatch.setenv("XDG_STATE_HOME", "/state")
    assert state_root() == Path("/state/ski")
