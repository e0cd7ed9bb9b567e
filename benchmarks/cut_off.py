"""What a robot did while it was cut off, out of the journal: when it was told to stand, when its wheels stood, when it went on."""

from dataclasses import dataclass
from itertools import pairwise
from math import hypot
from pathlib import Path
from typing import Any

from msgspec import json

from blackboard.journal import JournalLine, read_journal
from blackboard.kinds import DRIVE, ODOMETRY
from blackboard.messages.motion import Drive
from blackboard.messages.sensing import Odometry

STILL_MPS = 0.005
STILL_RADPS = 0.005


@dataclass(frozen=True)
class CutOff:
    """One cut. All in mission seconds after it; None: it never was so before the cable was in again."""

    told_to_stand_s: float | None  # 0 where it stood before
    wheels_stood_s: float | None
    driven_m: float  # while it was cut off
    went_on_s: float | None  # after the cable was in again


def clock_at(journal: Path, wall_s: float) -> float:
    """Return the mission's clock at a time of the wall clock, by what the keeper wrote down when it began."""
    begun: dict[str, Any] = json.decode((journal.parent / "clock.json").read_bytes())
    return float(begun["begin"] + (wall_s - begun["wall_s"]) * begun["pace"])


def moves(journal: Path, robot: str) -> tuple[list[tuple[float, Drive]], list[tuple[float, Odometry]]]:
    """Return what went to the wheels and what they said, by their stamps: what was handed in late is among it."""
    drives, readings = [], []
    for line in read_journal(journal):
        if line.event == "retracted":
            continue
        if line.key == f"ski/{robot}/{DRIVE.path}":
            drives.append((line.stamp_s, _value(line, Drive)))
        elif line.key == f"ski/{robot}/{ODOMETRY.path}":
            readings.append((line.stamp_s, _value(line, Odometry)))
    return sorted(drives, key=lambda d: d[0]), sorted(readings, key=lambda r: r[0])


def cut_off(
    drives: list[tuple[float, Drive]], readings: list[tuple[float, Odometry]], from_s: float, until_s: float
) -> CutOff:
    """Return what the robot did in a cut from one time of the mission's clock to another."""
    told = [(t, d.forward_mps == 0.0 and d.turn_radps == 0.0) for t, d in drives]
    stood = [(t, abs(o.forward_mps) < STILL_MPS and abs(o.turn_radps) < STILL_RADPS) for t, o in readings]
    places = [o.pose for t, o in readings if from_s <= t <= until_s]
    after = next((t - until_s for t, still in told if t > until_s and not still), None)
    return CutOff(
        told_to_stand_s=_still_from(told, from_s, until_s),
        wheels_stood_s=_still_from(stood, from_s, until_s),
        driven_m=sum(hypot(b.x_m - a.x_m, b.y_m - a.y_m) for a, b in pairwise(places)),
        went_on_s=after,
    )


def _still_from(seen: list[tuple[float, bool]], from_s: float, until_s: float) -> float | None:
    """Return how long after `from_s` it was still until the end; None where it was not in the end."""
    since_s: float | None = None
    for time_s, still in seen:
        if time_s > until_s:
            break
        since_s = (since_s if since_s is not None else time_s) if still else None
    return None if since_s is None else max(0.0, since_s - from_s)


def _value(line: JournalLine, of: type[Any]) -> Any:
    return json.decode(bytes(line.value), type=of)
