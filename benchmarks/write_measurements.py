"""Runs every benchmark and writes what they print to docs/measurements.md.

python benchmarks/write_measurements.py    # half an hour; nothing else should run meanwhile
"""

import os
import platform
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
PAGE = HERE.parent / "docs" / "measurements.md"

HEAD = """# Measurements

What the benchmarks printed, written by `python benchmarks/write_measurements.py`. Times differ between machines and from run to
run: the ratios, each to a baseline measured in the same run, tell more. Machine: {machine}, Python {python}, one core used.

Recordings are read from `../shared/data` beside the checkout, which is not part of the project; name your own instead.
"""

BENCHMARKS = (
    ("How safe", "Collisions that the robot caused, in simulation.", ("collisions.py",)),
    (
        "How right",
        "Grid and lines against the simulated lab; the plain scheme of the thesis beside ours.",
        ("map_accuracy.py",),
    ),
    ("The main job", "Ten simulated minutes of `explore-lab`, journal written, no pictures.", ("main_job.py",)),
    ("Memory", "Two simulated hours of `explore-lab`.", ("main_job.py", "--memory")),
    ("Recordings", "`ski map` as a process, reading and pictures included.", ("map_recordings.py",)),
    ("A scan into the grid", "", ("grid_speed.py",)),
    ("A post", "On the local link, validated.", ("board_speed.py",)),
)


def main() -> None:
    cores = os.cpu_count()
    machine = f"{platform.machine()}, {cores} cores"
    parts = [HEAD.format(machine=machine, python=platform.python_version())]
    for title, text, command in BENCHMARKS:
        print(f"{' '.join(command)} ...", flush=True)
        done = subprocess.run(
            [sys.executable, HERE / command[0], *command[1:]],
            cwd=HERE.parent,
            env={**os.environ, "PYTHONPATH": str(HERE.parent)},
            capture_output=True,
            text=True,
            check=True,
        )
        intro = f"{text} " if text else ""
        shown = f"python benchmarks/{' '.join(command)}"
        parts.append(f"## {title}\n\n{intro}`{shown}`\n\n```\n{done.stdout.strip()}\n```\n")
    PAGE.write_text("\n".join(parts), encoding="utf-8")
    print(f"wrote {PAGE}")


if __name__ == "__main__":
    main()
