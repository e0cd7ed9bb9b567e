"""Seconds that `ski map` needs for the recordings in ../shared/data, reading included, pictures included, one core.

python benchmarks/map_recordings.py [RECORDING ...]
"""

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter, process_time

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
DEFAULT = (DATA / "laser" / "intel.log.gz", DATA / "sonar" / "autolab")


def baseline_s() -> float:
    """Return what a plain loop over as many numbers as Intel's ranges costs, to compare machines."""
    started = process_time()
    total = 0.0
    for i in range(910 * 180 * 20):
        total += i * 0.5
    return process_time() - started


def main() -> None:
    recordings = [Path(name) for name in sys.argv[1:]] or [path for path in DEFAULT if path.exists()]
    if not recordings:
        print(f"no recordings: {DATA} is absent; name some")
        return
    base = baseline_s()
    for recording in recordings:
        with tempfile.TemporaryDirectory() as folder:
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            started = perf_counter()
            subprocess.run(
                [sys.executable, "-m", "blackboard.command.main", "map", str(recording), "--out", f"{folder}/map"],
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
                check=True,
                stdout=subprocess.DEVNULL,
            )
            wall = perf_counter() - started
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        print(
            f"{recording.name:20} {wall:6.1f} s   {cpu:6.1f} s CPU   {cpu / base:6.1f} x a plain loop of {base:.2f} s"
        )


if __name__ == "__main__":
    main()
