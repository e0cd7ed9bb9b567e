"""`ski map --mission map-recording-laser`: whether each drive closes, its error where there is a truth, CPU seconds on one core.

python benchmarks/laser_mapping.py           # all
python benchmarks/laser_mapping.py "Intel"   # those whose name begins so
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

SHARED = Path(__file__).resolve().parents[2] / "shared"
DATA, TOOLS = SHARED / "data", SHARED / "tools"
INTEL, SEATTLE, AUTOLAB = DATA / "laser" / "intel.log.gz", DATA / "laser" / "seattle.log.gz", DATA / "sonar" / "autolab"
RELATIONS, TRUTH = DATA / "relations" / "intel.relations", DATA / "sonar" / "autolab.truth.tum"


@dataclass(frozen=True)
class Drive:
    """A recording and how it is taken."""

    name: str
    recording: Path
    options: tuple[str, ...] = ()


DRIVES = (
    Drive("Intel, 180 beams", INTEL),
    Drive("Intel, 12 cones", INTEL, ("--cones", "12")),
    Drive("Intel, 12 cones that reach 2 m", INTEL, ("--cones", "12", "--set", "robot.max_range_m=2")),
    Drive("Seattle, 361 beams", SEATTLE),
    Drive("Seattle, 12 cones", SEATTLE, ("--cones", "12")),
    Drive("Seattle, 2 cones", SEATTLE, ("--cones", "2")),
    Drive("autolab, 181 beams, 600 s", AUTOLAB, ("--duration", "600")),
    Drive("autolab, 12 cones, 600 s", AUTOLAB, ("--cones", "12", "--duration", "600")),
)


def main() -> None:
    drives = [drive for drive in DRIVES if not sys.argv[1:] or drive.name.startswith(sys.argv[1])]
    print("drive                            closed  loops  contradicted  CPU s  error")
    for drive in drives:
        if drive.recording.exists():
            print(measured(drive), flush=True)
        else:
            print(f"{drive.name:32s} {drive.recording} is absent")


def measured(drive: Drive) -> str:
    """Map one drive; return its row."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "map"
        run: list[str | Path] = [
            sys.executable,
            "-m",
            "blackboard.command.main",
            "map",
            drive.recording,
            *drive.options,
        ]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        table = _json([*run, "--mission", "map-recording-laser", "--out", out, "--json"])
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        closed = "no" if str(table["map_closed"]).startswith("not") else "yes"
        contradicted = 100.0 * float(table.get("contradicted_fraction", 0.0))
        row = f"{drive.name:32s} {closed:6s} {table['loops_closed']:6d} {contradicted:12.1f}% {used_s:6.1f}  "
        return row + _error(drive.recording, out / "trajectory.tum")


def _error(recording: Path, trajectory: Path) -> str:
    if recording == INTEL:
        score: list[str | Path] = [
            sys.executable,
            TOOLS / "relations.py",
            trajectory,
            RELATIONS,
            "--odometry",
            INTEL,
            "--json",
        ]
        found = _json(score)
        return f"relations {found['trans_mean_m']:.4f} m, clear ones {found['clear_trans_mean_m']:.4f} m"
    if recording == AUTOLAB:
        found = _json([sys.executable, TOOLS / "trajectory_error.py", trajectory, TRUTH, "--json"])
        return f"mean {found['mean_m']:.3f} m, max {found['max_m']:.3f} m, {found['mean_deg']:.1f} degrees"
    return "no truth"


def _json(command: Sequence[str | Path]) -> dict[str, float]:
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        command, env=environment, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    found: dict[str, float] = json.loads(done.stdout)
    return found


if __name__ == "__main__":
    main()
