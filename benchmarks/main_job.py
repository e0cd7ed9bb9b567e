"""The main job's cost: seconds for ten simulated minutes of wander-lab, and memory after two simulated hours.

python benchmarks/main_job.py [--memory]

The machine's own pace is measured in the same run: a plain numpy baseline that casts the same number of rays, so that
the ratio can be compared between machines.
"""

import argparse
import os
import resource
import tempfile
from collections.abc import Mapping
from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core

import numpy as np

from blackboard.journal import JournalWriter
from blackboard.kinds import ACTIVATION_TIME
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run, RunOptions

SCANS = 3001  # ten minutes at 5 Hz


def baseline_s() -> float:
    """Return what the ray casting of as many 12-sonar scans costs in plain numpy: 84 rays against 60 segments."""
    rng = np.random.default_rng(1)
    starts, ends = rng.uniform(0, 8, (60, 2)), rng.uniform(0, 8, (60, 2))
    along = ends - starts
    angles = rng.uniform(-np.pi, np.pi, 84)
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    started = process_time()
    for i in range(SCANS):
        origin = starts - np.array([4.0 + 0.001 * i, 2.0])
        cross = rays[:, None, 0] * along[None, :, 1] - rays[:, None, 1] * along[None, :, 0]
        reach = (origin[:, 0] * along[:, 1] - origin[:, 1] * along[:, 0]) / cross
        part = (origin[None, :, 0] * rays[:, None, 1] - origin[None, :, 1] * rays[:, None, 0]) / cross
        np.where((part >= 0) & (part <= 1) & (reach > 0), reach, np.inf).min(axis=1)
    return process_time() - started


def run(duration_s: float, seed: int, settings: Mapping[str, Mapping[str, Any]] | None = None) -> tuple[float, Run]:
    """Run wander-lab with its journal and without pictures; return CPU seconds and the run."""
    mission = load_mission(find_mission("wander-lab"), settings)
    with tempfile.TemporaryDirectory() as folder, JournalWriter(Path(folder) / "board.jsonl") as journal:
        started = process_time()
        done = Run(mission, RunOptions(seed=seed))
        done.board.journal = journal
        done.run(duration_s)
        return process_time() - started, done


def memory_mb() -> float:
    """Return the largest resident memory that this process has had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--memory", action="store_true", help="two simulated hours, and the memory they need")
    parser.add_argument("--seeds", type=int, default=3)
    options = parser.parse_args()
    if options.memory:
        before = memory_mb()
        started = perf_counter()
        _, done = run(7200.0, 0)
        print(
            f"two simulated hours: {perf_counter() - started:.0f} s, {memory_mb():.0f} MB at most ({before:.0f} MB at start)"
        )
        print(f"{done.board.posts} posts, {len(done.board.history)} revisions remembered")
        return
    base = median(baseline_s() for _ in range(3))
    times = []
    for seed in range(options.seeds):
        seconds, done = run(600.0, seed)
        times.append(seconds)
        print(
            f"seed {seed}: {seconds:6.2f} s CPU   {done.board.posts} posts   {seconds / base:5.1f} x the baseline's {base:.2f} s"
        )
        for entry in done.board.entries(ACTIVATION_TIME):
            value = entry.value
            longest_ms = value.longest_s * 1e3
            print(f"    {entry.id:16} {value.activations:6} times {value.total_s:6.2f} s, longest {longest_ms:6.1f} ms")
    print(
        f"median {median(times):.2f} s CPU, {600 / median(times):.0f} x real time, {median(times) / base:.1f} x the baseline"
    )


if __name__ == "__main__":
    main()
