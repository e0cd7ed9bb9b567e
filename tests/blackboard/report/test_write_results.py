import json
from dataclasses import replace

import numpy as np
import pytest

from blackboard.errors import OutputError
from blackboard.messages.geometry import Pose
from blackboard.report.animation import Frame
from blackboard.report.output_folder import FILES, prepare_output_folder
from blackboard.report.write import write_results


@pytest.fixture
def frames(result) -> list[Frame]:
    return [Frame(stamp_s=0.0, pose=Pose(x_m=0.5, y_m=2.0, heading_rad=0.0), trajectory=result.trajectory[:1])]


def test_a_simulated_run_leaves_every_file(result, frames, milestones, tmp_path):
    written = write_results(result, tmp_path, frames, milestones)
    assert written == sorted(p.name for p in tmp_path.iterdir())
    assert written == sorted(set(FILES) - {"board.jsonl"})


def test_a_recording_leaves_no_truth(result, tmp_path):
    write_results(replace(result, truth=None, true_trajectory=None), tmp_path)
    assert not (tmp_path / "truth.tum").exists()
    assert len((tmp_path / "trajectory.tum").read_text().splitlines()) == 61


def test_the_map_is_cut_to_what_is_known(result, tmp_path):
    write_results(result, tmp_path)  # known: 82 x 61 cells from (-0.05, -0.05)
    assert (tmp_path / "map.pgm").read_bytes().startswith(b"P5\n# 0.050 m/pix\n82 61\n255\n")
    assert "origin: [-0.050000, -0.050000, 0.000000]" in (tmp_path / "map.yaml").read_text()


def test_nothing_known_leaves_what_there_is(result, tmp_path, make_grid):
    nothing = replace(result, grid=make_grid(np.full((4, 4), 128)), lines=[], trajectory=np.empty((0, 4)))
    written = write_results(replace(nothing, true_trajectory=None), tmp_path)
    assert written == ["lines.geojson", "overview.png"]
    assert json.loads((tmp_path / "lines.geojson").read_text())["features"] == []


def test_the_same_result_gives_the_same_bytes(result, frames, milestones, tmp_path):
    for name in ("one", "two"):
        prepare_output_folder(tmp_path / name)
        write_results(result, tmp_path / name, frames, milestones)
    for path in (tmp_path / "one").iterdir():
        assert path.read_bytes() == (tmp_path / "two" / path.name).read_bytes()


def test_forcing_replaces_ours_and_keeps_what_is_foreign(result, frames, milestones, tmp_path):
    write_results(result, tmp_path, frames, milestones)
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "board.jsonl").write_text("{}")
    prepare_output_folder(tmp_path, force=True)
    written = write_results(replace(result, truth=None, true_trajectory=None, grid=None), tmp_path)
    left = sorted(p.name for p in tmp_path.iterdir())
    assert left == sorted([*written, "notes.txt", "board.jsonl"])  # the other run's grid, truth and animation are gone
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_a_folder_that_has_gone_is_one_line(result, tmp_path):
    with pytest.raises(OutputError, match="cannot be written") as caught:
        write_results(result, tmp_path / "gone")
    assert "\n" not in str(caught.value)
