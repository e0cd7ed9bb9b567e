"""Seconds and scores of `ski map --mission map-recording-laser` on Intel: differences from its hand-checked relations, one core.

python benchmarks/laser_mapping.py
"""

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

SHARED = Path(__file__).resolve().parents[2] / "shared"
LOG = SHARED / "data" / "laser" / "intel.log.gz"
RELATIONS = SHARED / "data" / "relations" / "intel.relations"


def main() -> None:
    if not LOG.exists():
        print(f"{LOG} is absent: nothing to measure")
        return
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "map"
        run: list[str | Path] = [
            sys.executable,
            "-m",
            "blackboard.command.main",
            "map",
            LOG,
            "--mission",
            "map-recording-laser",
            "--out",
            out,
        ]
        subprocess.run(run, env=environment, check=True)
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        score: list[str | Path] = [
            sys.executable,
            SHARED / "tools" / "relations.py",
            out / "trajectory.tum",
            RELATIONS,
            "--odometry",
            LOG,
        ]
        subprocess.run(score, check=True)
    print(f"{used.ru_utime + used.ru_stime:.1f} s CPU, reading and pictures included")


if __name__ == "__main__":
    main()
