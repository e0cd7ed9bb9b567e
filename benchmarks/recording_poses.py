"""How well each chain of sources holds the pose on a recording with true poses: an ablation, whole and on shifted starts.

python benchmarks/recording_poses.py [--recording R] [--truth T.tum] [--only NAME ...] [--starts S ...] [--piece S] [--jobs N]

One row a chain: position error (mean, max) and heading error (mean) over the whole recording, and for pieces of --piece seconds
that start later the mean position error of each, their mean and the worst. Every piece is a run of its own, which knows nothing of
what came before. Estimate and truth are laid on each other at the first pose, nothing is fitted. Differences of some centimetres
between single runs mean nothing, which is why there are several.

The recording is autolab of ../shared/data unless another is named: 16 sonars whose stamps are 0.10 s late. Its laser is left out.
"""

import argparse
import os
import tempfile
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from math import degrees, inf
from pathlib import Path
from statistics import mean
from time import process_time
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core a run

from blackboard.kinds import CORRECTED_PATH
from blackboard.mission import Mission, find_mission, load_mission, parse_settings, shipped_missions
from blackboard.report.pose_scores import PathError, path_error
from blackboard.report.trajectory_file import read_trajectory
from blackboard.runner import Run, RunOptions

DATA = Path(__file__).resolve().parents[2] / "shared" / "data" / "sonar"


@dataclass(frozen=True)
class Chain:
    """A mission, what is set in it, and sources that it lacks."""

    name: str
    mission: str
    settings: tuple[str, ...] = ()
    added: tuple[str, ...] = ()

    def load(self, robot: Mapping[str, Any]) -> Mission:
        """Return the mission with this recording as its robot."""
        path, settings = find_mission(self.mission), {**parse_settings(self.settings), "robot": robot}
        if not self.added:
            return load_mission(path, settings)
        with tempfile.TemporaryDirectory() as folder:
            more = Path(folder) / path.name
            tables = (f'\n[[knowledge_source]]\nuse = "{use}"\n' for use in self.added)
            more.write_text(path.read_text("utf-8") + "".join(tables), "utf-8")
            return load_mission(more, settings)


CHAINS = (
    Chain("odometry only", "map-recording"),
    Chain(
        "+ match/merge, re-reference; lines of raw echoes",
        "map-recording-lines",
        ("filter_raw.use_grid=false", "line_finder.method=axis"),
    ),
    Chain("+ filter-raw", "map-recording-lines", ("line_finder.method=axis",)),
    Chain("+ tangent lines, filter-raw off", "map-recording-lines", ("filter_raw.use_grid=false",)),
    Chain("+ tangent lines, filter-raw on", "map-recording-lines"),
    Chain(  # as hypotheses: the pose has both parts of the shift from a corner's two lines already
        "+ corners", "map-recording-lines", added=("knowledge_sources.corners:Corners",)
    ),
    Chain("grid matcher", "map-recording-sonar"),
    Chain("pose and lines in one estimate", "map-recording-joint", ("joint_lines.latency_s=0",)),  # the rest of it
)


@dataclass(frozen=True)
class Piece:
    """A chain on a part of the recording, or on all of it."""

    chain: Chain
    skip_s: float = 0.0
    length_s: float = inf


def score(recording: Path, truth: Path, robot: Mapping[str, Any], piece: Piece) -> tuple[PathError, float]:
    """Run a chain on its piece; return the error of its path and the seconds that it took."""
    started = process_time()
    over = {**robot, "leave_out": "laser", "path": str(recording.absolute()), "skip_s": piece.skip_s}
    run = Run(piece.chain.load(over), RunOptions(strict=True))
    run.run(piece.length_s)
    run.robot.close()
    corrected = run.board.newest(CORRECTED_PATH)
    path = run.trajectory() if corrected is None else corrected.value.poses.unpack()
    error = path_error(path, read_trajectory(truth), aligned=True)
    if error is None:
        raise SystemExit(f"{truth} has no pose in the time of {recording}")
    return error, process_time() - started


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--recording", type=Path, default=DATA / "autolab")
    parser.add_argument("--truth", type=Path, default=DATA / "autolab.truth.tum")
    parser.add_argument("--latency", type=float, default=0.1, metavar="S", help="by which the sonars' stamps are late")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="chains by the beginning of their names")
    parser.add_argument("--add", nargs="+", action="append", default=[], metavar="MISSION [KEY=VALUE ...]")
    parser.add_argument("--starts", type=float, nargs="*", default=[0.0, 300.0, 600.0, 900.0, 1200.0], metavar="S")
    parser.add_argument("--piece", type=float, default=480.0, metavar="S")
    parser.add_argument("--no-whole", action="store_true", help="only the pieces")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    if not (options.recording.exists() and options.truth.exists()):
        print(f"{options.recording} or {options.truth} is absent: nothing to measure")
        return
    shipped = [chain for chain in CHAINS if chain.mission in shipped_missions()]
    chains = [c for c in shipped if options.only is None or c.name.startswith(tuple(options.only))]
    chains += [Chain(" ".join(words), words[0], tuple(words[1:])) for words in options.add]
    pieces = [
        piece
        for chain in chains
        for piece in (
            *(() if options.no_whole else (Piece(chain),)),
            *(Piece(chain, start_s, options.piece) for start_s in options.starts),
        )
    ]
    robot = {"sonar_latency_s": options.latency}
    print(f"{options.recording.name}, sonar stamps {options.latency:g} s late; position errors in m")
    starts = "".join(f"{f'from {start_s:g}':>11}" for start_s in options.starts)
    print(f"{'':50}{'mean':>8}{'max':>8}{'deg':>6} |{starts}{'mean':>8}{'worst':>8}{'s CPU':>8}")
    with ProcessPoolExecutor(max_workers=options.jobs) as pool:
        scored = pool.map(partial(score, options.recording, options.truth, robot), pieces)
        for chain in chains:
            mine = [next(scored) for piece in pieces if piece.chain is chain]
            seconds = sum(seconds for _, seconds in mine)
            whole = None if options.no_whole else mine.pop(0)[0]
            print(row(chain.name, whole, [error for error, _ in mine], seconds), flush=True)


def row(name: str, whole: PathError | None, pieces: list[PathError], seconds: float) -> str:
    """Return one line of the table."""
    shown = f"{'-':>8}{'-':>8}{'-':>6}"
    if whole is not None:
        shown = f"{whole.mean_m:8.3f}{whole.max_m:8.3f}{degrees(whole.heading_mean_rad):6.2f}"
    means = [error.mean_m for error in pieces]
    together = f"{mean(means):8.3f}{max(means):8.3f}" if means else ""
    return f"{name:50}{shown} |{''.join(f'{m:11.3f}' for m in means)}{together}{seconds:8.0f}"


if __name__ == "__main__":
    main()
