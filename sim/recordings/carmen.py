"""CARMEN logs, plain or gzipped, with the old tags (FLASER) and the new ones (ROBOTLASER1).

The file is read twice: once for its sensors and stamps, which are repaired as one sequence since one logger wrote them in
order, and once while it is replayed.
"""

import gzip
import zlib
from collections.abc import Generator, Iterator
from math import pi
from pathlib import Path

import numpy as np

from blackboard.errors import RecordingError
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.sensing import LaserSensor, Odometry, SonarSensor
from sim.recordings.carmen_lines import CarmenLine, parse_line
from sim.recordings.cones import Fan
from sim.recordings.ranges import sort_out, unfit
from sim.recordings.recording import Echoes, Heard, Recording, Sweep
from sim.recordings.stamps import Stamps, repair

FIXED_M, FIXED_RAD = (
    0.02,
    0.02,
)  # a laser that moves more than this on the robot is not mounted but corrected by somebody
SONAR_MAX_RANGE_M = 5.0  # for logs that do not tell (PARAM robot_max_sonar)


def read_words(path: Path) -> Iterator[list[str]]:
    """Yield the words of each line that is neither empty nor a comment; raise RecordingError where the file breaks off."""
    number = 0
    try:
        with path.open("rb") as plain:
            zipped = plain.read(2) == b"\x1f\x8b"
            plain.seek(0)
            for line in gzip.GzipFile(fileobj=plain) if zipped else plain:
                number += 1
                words = line.decode("ascii", "replace").split()
                if words and not words[0].startswith("#"):
                    yield words
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise RecordingError(
            f"{path}: the gzip data breaks off or is damaged after line {number} ({error}); "
            f"copy the file again, or keep what there is with 'zcat {path.name} > whole.log'"
        ) from None
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror or error})") from None


class CarmenLog(Recording):
    """A CARMEN log. Raises RecordingError where it holds no ranges, or breaks off inside its gzip data."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._path = path
        survey = _Survey()
        for words in read_words(path):
            survey.look_at(words)
        self.counts["lines_read"] = survey.lines
        self.counts["lines_skipped"] = survey.skipped
        self._tags = survey.used_tags()
        if not self._tags:
            raise RecordingError(
                f"{path}: not a recording: none of its {survey.lines} lines is one of a CARMEN log or a bag"
            )
        if not self._tags & {"SONAR", *survey.fans}:
            seen = ", ".join(f"{tag} {count}" for tag, count in sorted(survey.tags.items()))
            raise RecordingError(
                f"{path}: no laser or sonar line in {survey.lines} lines (lines by tag: {seen}; {survey.skipped} damaged)"
            )
        self._describe(survey)
        try:
            self._stamps, repaired = repair(survey.stamps_of(self._tags))
        except ValueError as error:
            raise RecordingError(f"{path}: {error}") from None
        self.counts["stamps_repaired"] = repaired
        for type_ in survey.types(self._tags):
            self.saw(type_, float(self._stamps[0]), float(self._stamps[-1]))

    def _describe(self, survey: "_Survey") -> None:
        self._lasers = {tag: number for number, tag in enumerate(sorted(self._tags & set(survey.fans)))}
        self.fans = tuple(survey.fans[tag] for tag in self._lasers)
        self.lasers = tuple(
            LaserSensor(mount=self._mount(tag, survey.mounts[tag]), max_range_m=survey.max_range_m[tag])
            for tag in self._lasers
        )
        self._sonar_mounts = survey.sonar_mounts
        self._sonar_max_m = survey.sonar_max_range_m or SONAR_MAX_RANGE_M
        if survey.sonar_mounts and survey.sonar_max_range_m is None:
            self.notes.append(f"the log does not tell how far its sonars reach: {SONAR_MAX_RANGE_M:g} m assumed")
        self.sonars = tuple(
            SonarSensor(mount=mount, cone_rad=survey.cone_rad, max_range_m=self._sonar_max_m)
            for mount in survey.sonar_mounts
        )

    def _mount(self, tag: str, mounts: list[tuple[float, float, float]]) -> Pose:
        """Return robot_from_laser: what the lines agree on, or no offset where they do not."""
        if not mounts:
            return Pose(x_m=0.0, y_m=0.0, heading_rad=0.0)
        offsets = np.array(mounts)  # (n, 3)
        middle = np.median(offsets, axis=0)
        off = np.abs(offsets - middle)
        off[:, 2] = np.abs(np.remainder(off[:, 2] + pi, 2 * pi) - pi)
        if float(np.mean((off[:, :2].max(axis=1) < FIXED_M) & (off[:, 2] < FIXED_RAD))) < 0.9:
            self.notes.append(f"the laser poses of {tag} are not those of a fixed mount but corrected ones: left aside")
            middle = np.zeros(3)
        if tag == "RLASER" and not middle.any():
            self.notes.append("the rear laser's mount is not told: it is taken to look straight back")
            middle[2] = pi
        x_m, y_m, heading_rad = middle.tolist()
        return Pose(x_m=round(x_m, 6), y_m=round(y_m, 6), heading_rad=wrap_angle(heading_rad))

    def replay(self) -> Generator[Heard, None, None]:
        """Yield odometry, sweeps and echoes in the order of the lines; a laser line gives its odometry first."""
        self.counts["ranges_invalid"] = 0
        stamps = iter(self._stamps.tolist())
        for words in read_words(self._path):
            line = _parsed(words)
            if line is None or line.tag not in self._tags:
                continue
            stamp_s = next(stamps)
            if line.odometry is not None:
                yield Heard(stamp_s, line.odometry)
            if line.ranges is not None:
                value = self._ranges(line, line.ranges)
                if value is not None:
                    self.counts["ranges_invalid"] += unfit(value.ranges)
                    yield Heard(stamp_s, value)

    def _ranges(self, line: CarmenLine, ranges: list[float]) -> Sweep | Echoes | None:
        if line.fan is not None:
            number = self._lasers[line.tag]
            return Sweep(number, line.fan, sort_out(ranges, 0.0, self.lasers[number].max_range_m))
        if len(ranges) != len(self.sonars):
            return None
        return Echoes(tuple(range(len(ranges))), sort_out(ranges, 0.0, self._sonar_max_m))


def _parsed(words: list[str]) -> CarmenLine | None:
    """Return what a line says; None where it is damaged or of a tag that is not used."""
    try:
        return parse_line(words)
    except (ValueError, IndexError):
        return None


class _Survey:
    """What the first reading of a log gathers."""

    def __init__(self) -> None:
        self.lines = 0
        self.skipped = 0
        self.tags: dict[str, int] = {}
        self.fans: dict[str, Fan] = {}
        self.max_range_m: dict[str, float] = {}
        self.mounts: dict[str, list[tuple[float, float, float]]] = {}
        self.sonar_mounts: tuple[Pose, ...] = ()
        self.cone_rad = 0.0
        self.sonar_max_range_m: float | None = None
        self.odometry_tags: set[str] = set()
        self._stamps: list[tuple[str, float]] = []

    def look_at(self, words: list[str]) -> None:
        self.lines += 1
        try:
            line = parse_line(words)
        except (ValueError, IndexError):
            self.skipped += 1
            return
        if line is None:
            self._other(words)
            return
        self.tags[line.tag] = self.tags.get(line.tag, 0) + 1
        self._stamps.append((line.tag, line.stamp_s))
        if line.odometry is not None:
            self.odometry_tags.add(line.tag)
        if line.fan is not None:
            self._laser(line, line.fan)
        elif line.mounts and not self.sonar_mounts:
            self.sonar_mounts, self.cone_rad = line.mounts, line.cone_rad

    def _laser(self, line: CarmenLine, fan: Fan) -> None:
        self.fans.setdefault(line.tag, fan)
        self.max_range_m[line.tag] = max(line.max_range_m, self.max_range_m.get(line.tag, 0.0))
        mounts = self.mounts.setdefault(line.tag, [])
        if line.laser_pose is not None and line.odometry is not None:
            mount = line.odometry.pose.inverse() @ line.laser_pose
            mounts.append((mount.x_m, mount.y_m, mount.heading_rad))

    def _other(self, words: list[str]) -> None:
        """Pass over a tag that is not used (PARAM, SYNC, ...); what looks like no tag at all counts as damaged."""
        if not (len(words) > 1 and len(words[0]) > 2 and words[0][0].isalpha() and words[0].isupper()):
            self.skipped += 1
        elif words[0] == "PARAM" and words[1] == "robot_max_sonar":
            try:
                self.sonar_max_range_m = float(words[2])
            except (ValueError, IndexError):
                self.skipped += 1

    def used_tags(self) -> set[str]:
        """Return the tags to replay: RAWLASERs only where no line tells the same scan together with a pose."""
        posed = any(not tag.startswith("RAWLASER") for tag in self.fans)
        return {tag for tag in self.tags if not (posed and tag.startswith("RAWLASER"))}

    def stamps_of(self, tags: set[str]) -> Stamps:
        return np.array([stamp_s for tag, stamp_s in self._stamps if tag in tags], dtype=np.float64)

    def types(self, tags: set[str]) -> list[type[Odometry | Sweep | Echoes]]:
        """Return the types of value that these tags give."""
        types: list[type[Odometry | Sweep | Echoes]] = []
        if tags & self.odometry_tags:
            types.append(Odometry)
        if tags & set(self.fans):
            types.append(Sweep)
        if "SONAR" in tags:
            types.append(Echoes)
        return types
