"""Runs every benchmark and writes what they print to docs/measurements.md.

python benchmarks/write_measurements.py                   # three quarters of an hour; nothing else should run meanwhile
python benchmarks/write_measurements.py "Start" "A post"  # only these sections; the others stay as they are
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
run: the ratios, each to a baseline measured in the same run, tell more. Machine: {machine}, Python {python}, one core a run.

Recordings are read from `../shared/data` beside the checkout, which is not part of the project; name your own instead.
"""

DRAWN = ("--set", "robot.drawn_odometry=true")  # each seed has wheels of its own
HALL = ("--world", "hall", "--robot", "k2a_near", "--seeds", "10", "--duration", "1800", *DRAWN)
OFFICE = ("--world", "office", "--robot", "k2a_worn", "--seeds", "2", "--duration", "3600")
SHORT = ("--world", "office", "--robot", "k2a_worn", "--seeds", "3", "--duration", "600")
NEES = ("--seeds", "50", "--duration", "600", *DRAWN)

BENCHMARKS = (
    ("How safe", "Collisions that the robot caused, in simulation.", ("collisions.py",)),
    (
        "How right",
        "Grid and lines against the simulated lab; the plain scheme of the thesis beside ours.",
        ("map_accuracy.py",),
    ),
    (
        "Pose in a hall, by lines",
        "40 by 15 m, sonars that reach 5 m, 30 minutes, wheels of its own for each seed.",
        ("consistency.py", "--mission", "explore-lab-lines", *HALL),
    ),
    (
        "Pose in a hall, in one estimate",
        "The same drives.",
        ("consistency.py", "--mission", "explore-lab-joint", *HALL),
    ),
    (
        "Pose in the office, by lines",
        "An hour; odometry errs by 2 % of the way and by 2 degrees over 10 m.",
        ("consistency.py", "--mission", "explore-lab-lines", *OFFICE),
    ),
    (
        "Pose in the office, in one estimate",
        "The same.",
        ("consistency.py", "--mission", "explore-lab-joint", *OFFICE),
    ),
    (
        "Pose by sonar matching",
        "Ten minutes in the office.",
        ("consistency.py", "--mission", "explore-lab-sonar", *SHORT),
    ),
    (
        "Honesty of the pose, by lines",
        "50 runs of ten minutes in the lab, wheels of its own for each seed.",
        ("consistency.py", "--mission", "explore-lab-lines", *NEES),
    ),
    (
        "Honesty of the pose, in one estimate",
        "The same.",
        ("consistency.py", "--mission", "explore-lab-joint", *NEES),
    ),
    (
        "Ablation on a recording",
        "What each part of the chain is worth on autolab: the whole of it, and pieces of eight minutes.",
        ("recording_poses.py",),
    ),
    (
        "Lines with the grid and without",
        "What filter-raw is worth.",
        ("lines_with_grid.py",),
    ),
    (
        "Lines in maps of points",
        "`ski lines`, pictures not included.",
        ("lines_of_points.py",),
    ),
    (
        "Exploring the lab to the end",
        "Odometry errs. Beside it the same mission without its rules, for the same time: reflexes only.",
        ("exploring.py", "--world", "lab", "--reflexes"),
    ),
    (
        "Exploring the traps to the end",
        "The same.",
        ("exploring.py", "--world", "trap", "--reflexes", "4"),
    ),
    (
        "Exploring the office to the end",
        "The same.",
        ("exploring.py", "--world", "office", "--reflexes", "4", "--duration", "7200"),
    ),
    (
        "Exploring, disturbed",
        "A chair is put in the robot's way, a person stands in a passage for a minute, a door closes for good.",
        ("exploring.py", "--world", "lab", "--disturbed"),
    ),
    (
        "Exploring floor plans that nobody has seen",
        "Each seed has a floor plan of its own.",
        ("exploring.py", "--world", "random", "--seeds", "10"),
    ),
    (
        "Two robots in one lab",
        "Each explores for itself, and is an obstacle that moves for the other.",
        ("two_robots.py",),
    ),
    (
        "Finding drums",
        "Eight drums in the warehouse, with and without knowing that they usually stand in corners.",
        ("finding.py", "--duration", "1500"),
    ),
    (
        "Corners",
        "",
        ("corners.py",),
    ),
    ("Docking", "On wheels that err, with nothing that corrects the pose.", ("docking.py",)),
    ("The main job", "Ten simulated minutes of `wander-lab`, journal written, no pictures.", ("main_job.py",)),
    ("Memory", "Two simulated hours of `wander-lab`.", ("main_job.py", "--memory")),
    ("Recordings", "`ski map` as a process, reading and pictures included.", ("map_recordings.py",)),
    (
        "Drives with a laser, and with cones",
        "`ski map --mission map-recording-laser`: 12 cones are a laser thinned to the nearest echo in each, with real geometry and "
        "odometry but without specular loss and cross-talk. Raw odometry has 7.39 m on Intel's relations.",
        ("laser_mapping.py",),
    ),
    (
        "The rule engines",
        "One fact changed and all rules fired, the median; experta is our engine on it, clipspy is without ours.",
        ("rule_engine.py",),
    ),
    ("Rules changed under way", "Every five seconds one of the files is changed.", ("reload.py",)),
    ("The rule engines' memory", "", ("rule_engine.py", "--memory")),
    ("The rule engines in lockstep", "Random programs on experta and on CLIPS.", ("lockstep.py", "--programs", "1000")),
    ("Ways over the grid", "", ("routes.py",)),
    ("A scan into the grid", "", ("grid_speed.py",)),
    ("A post", "On the local link, validated.", ("board_speed.py",)),
    (
        "The board keeper",
        "Beside bare zenoh, which checks, journals and repairs nothing; a process for each poster and reader.",
        ("keeper.py",),
    ),
    ("From a post to an activation", "In another process, through a router of its own.", ("link_latency.py",)),
    ("Up and down", "", ("up_and_down.py",)),
    (
        "Across processes",
        "Exploring the lab in one process, in lock-step, and in five, in real time.",
        ("distributed.py",),
    ),
    (
        "Across processes: kill -9",
        "Four mission seconds in one, so a start takes four times as long. The times differ as real-time runs always do.",
        ("kills.py", "--pace", "4"),
    ),
    (
        "Across processes: kill -9 under ski up",
        "The same, started again by the executor daemon.",
        ("kills.py", "--up", "--pace", "4", "--rounds", "1"),
    ),
    ("Across processes: a storm of kill -9", "", ("kill_storm.py", "--pace", "2", "--runs", "1")),
    ("Across processes: SIGSTOP", "", ("freezes.py",)),
    (
        "Two machines, the cable pulled",
        "Network namespaces, TLS with keys. The wheels brake with 0.6 m/s2.",
        ("cuts.py",),
    ),
    ("Two machines, the cable pulled, behaviours beside the robot", "", ("cuts.py", "--together")),
    ("Start", "", ("start_up.py",)),
)


def standing_sections() -> dict[str, str]:
    """Return the sections of the page as it is, by title."""
    if not PAGE.exists():
        return {}
    parts = PAGE.read_text(encoding="utf-8").split("\n## ")[1:]
    return {part.partition("\n")[0]: f"## {part.rstrip()}\n" for part in parts}


def section(title: str, text: str, command: tuple[str, ...]) -> str:
    """Run a benchmark and return its section."""
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
    printed = "\n".join(line.rstrip() for line in done.stdout.strip().splitlines())
    return f"## {title}\n\n{intro}`{shown}`\n\n```\n{printed}\n```\n"


def main() -> None:
    chosen = sys.argv[1:]
    unknown = set(chosen) - {title for title, _, _ in BENCHMARKS}
    if unknown:
        sys.exit(
            f"no section is called {sorted(unknown)[0]!r}; there are {', '.join(title for title, _, _ in BENCHMARKS)}"
        )
    standing = standing_sections() if chosen else {}
    machine = f"{platform.machine()}, {os.cpu_count()} cores"
    parts = [HEAD.format(machine=machine, python=platform.python_version())]
    for title, text, command in BENCHMARKS:
        if not chosen or title in chosen:
            parts.append(section(title, text, command))
        elif title in standing:
            parts.append(standing[title])
    PAGE.write_text("\n".join(parts), encoding="utf-8")
    print(f"wrote {PAGE}")


if __name__ == "__main__":
    main()
