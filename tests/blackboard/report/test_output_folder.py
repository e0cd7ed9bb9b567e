import os
from pathlib import Path

import pytest

from blackboard.errors import OutputError
from blackboard.report.output_folder import FILES, prepare_output_folder


def refusal(folder: Path, *, force: bool = False) -> str:
    with pytest.raises(OutputError) as caught:
        prepare_output_folder(folder, force)
    text = str(caught.value)
    assert "\n" not in text
    assert "--out" in text
    return text


def test_a_folder_is_made_with_its_parents(tmp_path):
    prepare_output_folder(tmp_path / "runs" / "one")
    assert list((tmp_path / "runs" / "one").iterdir()) == []


def test_an_empty_folder_is_taken(tmp_path):
    prepare_output_folder(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_holds_something_is_refused(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    text = refusal(tmp_path)
    assert str(tmp_path) in text
    assert "notes.txt" in text
    assert "--force" in text


def test_force_takes_it_and_touches_nothing(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "grid.png").write_text("old")
    prepare_output_folder(tmp_path, force=True)
    assert (tmp_path / "notes.txt").read_text() == "mine"
    assert (tmp_path / "grid.png").read_text() == "old"


@pytest.mark.parametrize("force", [False, True])
def test_a_file_in_the_way_is_refused(tmp_path, force):
    (tmp_path / "out").write_text("mine")
    assert "is a file" in refusal(tmp_path / "out", force=force)
    assert "below a file" in refusal(tmp_path / "out" / "deeper", force=force)
    assert (tmp_path / "out").read_text() == "mine"


def test_a_link_to_nowhere_is_refused(tmp_path):
    (tmp_path / "out").symlink_to(tmp_path / "gone" / "away")
    refusal(tmp_path / "out")


@pytest.mark.parametrize("name", FILES)
def test_a_folder_where_a_file_must_go_is_refused(tmp_path, name):
    (tmp_path / name).mkdir()
    assert name in refusal(tmp_path, force=True)


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is forbidden to root")
def test_a_folder_without_permission_is_refused(tmp_path):
    tmp_path.chmod(0o500)
    try:
        assert "cannot be written" in refusal(tmp_path)
        assert "cannot be written" in refusal(tmp_path / "out")
    finally:
        tmp_path.chmod(0o700)


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="no file system that forbids writing to everyone")
def test_a_file_system_that_cannot_be_written_is_refused():
    assert "cannot be written" in refusal(Path("/proc/self/out"))
