"""Checkpoint files: whole, this user's, of this mission, and of nothing but states; whatever else is found is refused."""

import os
import pickle
from collections import deque
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.checkpoint import Checkpoint, Checkpointer, dumped, loaded, mission_identity, read_checkpoint
from blackboard.errors import CheckpointError
from blackboard.kinds import GRID, slot
from blackboard.messages.geometry import Pose
from blackboard.mission import find_mission, load_mission
from blackboard.vocabulary import Vocabulary

VOCABULARY = Vocabulary()
POSE = Pose(x_m=1.0, y_m=-2.0, heading_rad=0.5)


def written(folder: Path, states: dict[str, object], now_s: float = 12.5) -> Path:
    path = folder / "sources.checkpoint"
    assert Checkpointer(path, "explore-1", boot="b1").write(now_s, states) == {}
    return path


def found(path: Path) -> Checkpoint:
    checkpoint = read_checkpoint(path, "explore-1")
    assert checkpoint is not None
    return checkpoint


def test_states_come_back_as_they_were(tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    path = written(tmp_path, {"mapper": {"cells": np.eye(3), "rng": rng, "at": deque([POSE])}, "idle": None})
    checkpoint = found(path)
    assert (checkpoint.now_s, checkpoint.boot) == (12.5, "b1")
    state = checkpoint.state("mapper", VOCABULARY)
    assert isinstance(state, dict)
    assert (state["cells"] == np.eye(3)).all()
    assert state["at"] == deque([POSE])
    assert state["rng"].integers(1 << 30) == rng.integers(1 << 30)
    assert checkpoint.state("idle", VOCABULARY) is None


def test_a_kind_is_the_mission_s_own() -> None:
    ours = slot("status/mug", Pose, "one of a component's own")
    assert loaded(dumped([GRID, ours]), Vocabulary([ours])) == [GRID, ours]


def test_nothing_there_is_no_fault(tmp_path: Path) -> None:
    assert read_checkpoint(tmp_path / "none.checkpoint", "explore-1") is None


def test_the_last_one_counts_and_others_cannot_read_it(tmp_path: Path) -> None:
    path = written(tmp_path, {"a": 1})
    written(tmp_path, {"a": 2}, now_s=13.5)
    assert found(path).state("a", VOCABULARY) == 2
    assert path.stat().st_mode & 0o777 == 0o600
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_it_is_due_every_so_often(tmp_path: Path) -> None:
    checkpointer = Checkpointer(tmp_path / "a.checkpoint", "explore-1", boot="b", every_s=1.0)
    assert checkpointer.is_due(5.0)
    checkpointer.write(5.0, {})
    assert not checkpointer.is_due(5.9)
    assert checkpointer.is_due(6.0)


def test_what_cannot_be_kept_is_said_once_and_spoils_nothing(tmp_path: Path) -> None:
    path = tmp_path / "a.checkpoint"
    checkpointer = Checkpointer(path, "explore-1", boot="b")
    assert list(checkpointer.write(1.0, {"odd": lambda: 0, "plain": 3})) == ["odd"]
    assert checkpointer.write(2.0, {"odd": lambda: 0, "plain": 4}) == {}
    checkpoint = found(path)
    assert checkpoint.state("plain", VOCABULARY) == 4
    with pytest.raises(CheckpointError, match="the state of odd could not be kept"):
        checkpoint.state("odd", VOCABULARY)
    states, lost = checkpoint.states(VOCABULARY)
    assert (states, list(lost)) == ({"plain": 4}, ["odd"])


@given(cut=st.integers(0, 400))
def test_a_torn_file_is_refused(tmp_path_factory: pytest.TempPathFactory, cut: int) -> None:
    path = written(tmp_path_factory.mktemp("torn"), {"a": list(range(50))})
    whole = path.read_bytes()
    path.write_bytes(whole[: min(cut, len(whole) - 1)])
    with pytest.raises(CheckpointError, match=r"torn|not a checkpoint"):
        read_checkpoint(path, "explore-1")


@given(data=st.binary(max_size=200), at=st.integers(0, 400))
def test_a_changed_file_is_refused_or_the_same(tmp_path_factory: pytest.TempPathFactory, data: bytes, at: int) -> None:
    path = written(tmp_path_factory.mktemp("changed"), {"a": list(range(50))})
    whole = path.read_bytes()
    path.write_bytes(whole[:at] + data + whole[at + len(data) :])
    try:
        checkpoint = read_checkpoint(path, "explore-1")
    except CheckpointError:
        return
    assert checkpoint is not None
    assert checkpoint.state("a", VOCABULARY) == list(range(50))


def test_another_mission_s_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, {})
    with pytest.raises(CheckpointError, match=r"of another mission \(explore-1\), this one is explore-2"):
        read_checkpoint(path, "explore-2")


def test_a_mission_is_told_by_its_settings_and_its_seed() -> None:
    path = find_mission("wander-lab")
    one = mission_identity(load_mission(path), 0)
    assert one == mission_identity(load_mission(path), 0)
    other = load_mission(path, {"eou_grid": {"cell_m": 0.1}})
    assert len({one, mission_identity(other, 0), mission_identity(load_mission(path), 1)}) == 3


def test_a_file_that_others_may_write_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, {})
    path.chmod(0o666)
    with pytest.raises(CheckpointError, match="not a file that this user alone may write"):
        read_checkpoint(path, "explore-1")


def test_a_link_or_a_pipe_is_refused(tmp_path: Path) -> None:
    link, pipe = tmp_path / "link.checkpoint", tmp_path / "pipe.checkpoint"
    link.symlink_to(written(tmp_path, {}))
    os.mkfifo(pipe, 0o600)
    for path in (link, pipe):
        with pytest.raises(CheckpointError, match=r"cannot be read|not a file"):
            read_checkpoint(path, "explore-1")


def test_a_folder_that_cannot_be_made_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(CheckpointError, match="cannot be made"):
        Checkpointer(tmp_path / "file" / "a.checkpoint", "explore-1", boot="b")


class Foreign:
    def __reduce__(self) -> tuple[object, tuple[str]]:
        return os.system, ("true",)


def test_a_state_that_would_run_something_is_refused() -> None:
    with pytest.raises(pickle.UnpicklingError, match="no part of a state"):
        loaded(pickle.dumps(Foreign()), VOCABULARY)
    with pytest.raises(pickle.UnpicklingError, match="no part of a state"):
        loaded(b"\x80\x04\x8c\x15blackboard.checkpoint\x8c\tos.getcwd\x93)R.", VOCABULARY)
    for text in (b"cbuiltins\neval\n(V1+1\ntR.", b"cnumpy\nload\n(Vx\ntR."):
        with pytest.raises(pickle.UnpicklingError, match="no part of a state"):
            loaded(text, VOCABULARY)
