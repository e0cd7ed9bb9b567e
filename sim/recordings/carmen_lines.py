"""Lines of CARMEN logs, as CARMEN's logger writes them.

Each line is `TAG contents stamp host logger_stamp`. The contents:
  ODOM          x y theta tv rv acceleration
  FLASER RLASER n r1..rn  laser x y theta  robot x y theta
  ROBOTLASER<k> type start field_of_view resolution max_range accuracy remission_mode  n r1..rn  m v1..vm
                laser x y theta  robot x y theta  tv rv forward_safety side_safety turn_axis
  RAWLASER<k>   type start field_of_view resolution max_range accuracy remission_mode  n r1..rn  m v1..vm
  SONAR         cone n r1..rn  (x y theta) of each
"""

from dataclasses import dataclass
from math import isfinite, pi

from blackboard.messages.base import FAR_M
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.sensing import MAX_BEAMS, MAX_SONARS, Odometry
from sim.recordings.cones import Fan

SICK_MAX_RANGE_M = 80.0  # CARMEN's own for lines that do not tell; SICK lasers write 81.83 and more for no return
SICK_STEPS_DEG = {180: 1.0, 181: 1.0, 360: 0.5, 361: 0.5, 400: 0.25, 401: 0.25}
MAX_SPEED = 100.0  # m/s and rad/s: no more can stand on the board
TAIL = 3  # words after the contents: stamp, host, logger's stamp


@dataclass(frozen=True, slots=True)
class CarmenLine:
    """One line: what it says of odometry, of a laser (`fan`, `laser_pose`) or of sonars (`mounts`, `cone_rad`)."""

    tag: str
    stamp_s: float
    odometry: Odometry | None = None
    fan: Fan | None = None
    laser_pose: Pose | None = None
    ranges: list[float] | None = None
    max_range_m: float = SICK_MAX_RANGE_M
    cone_rad: float = 0.0
    mounts: tuple[Pose, ...] = ()


def parse_line(words: list[str]) -> CarmenLine | None:
    """Return what a line says, or None where its tag is not one of those above; raise ValueError where it is damaged."""
    tag = words[0]
    if tag == "ODOM":
        return _odom(words)
    if tag in ("FLASER", "RLASER"):
        return _old_laser(words)
    if tag.startswith("ROBOTLASER") and tag[10:].isdigit():
        return _new_laser(words, robot=True)
    if tag.startswith("RAWLASER") and tag[8:].isdigit():
        return _new_laser(words, robot=False)
    if tag == "SONAR":
        return _sonar(words)
    return None


def _odom(words: list[str]) -> CarmenLine:
    _check_length(words, 7 + TAIL)
    x_m, y_m, heading_rad, forward_mps, turn_radps, _, stamp_s = map(float, words[1:8])
    return CarmenLine("ODOM", stamp_s, odometry=_odometry(x_m, y_m, heading_rad, forward_mps, turn_radps))


def _old_laser(words: list[str]) -> CarmenLine:
    beams = _number(words[1], MAX_BEAMS)
    _check_length(words, 8 + beams + TAIL)
    laser = list(map(float, words[2 + beams : 8 + beams]))
    step_deg = SICK_STEPS_DEG.get(beams, 180.0 / max(beams - 1, 1))
    half_deg = 50.0 if step_deg == 0.25 else 90.0  # SICK lasers see 100 degrees at their finest step
    return CarmenLine(
        tag=words[0],
        stamp_s=float(words[8 + beams]),
        odometry=_odometry(*laser[3:]),
        fan=Fan(-half_deg * pi / 180, step_deg * pi / 180, beams),
        laser_pose=_pose(*laser[:3]),
        ranges=list(map(float, words[2 : 2 + beams])),
    )


def _new_laser(words: list[str], *, robot: bool) -> CarmenLine:
    start_rad, view_rad, step_rad, max_range_m = map(float, words[2:6])
    beams = _number(words[8], MAX_BEAMS)
    remissions = _number(words[9 + beams], MAX_BEAMS, least=0)
    end = 10 + beams + remissions
    _check_length(words, end + (11 if robot else 0) + TAIL)
    even_rad = view_rad / max(beams - 1, 1)
    if not 0.5 * even_rad <= step_rad <= 2.0 * even_rad:  # a resolution that does not fill the field of view
        step_rad = even_rad
    if not (abs(start_rad) <= 2 * pi and 0 < step_rad <= pi):
        raise ValueError("the beams' angles make no sense")
    odometry = laser_pose = None
    if robot:
        poses = list(map(float, words[end : end + 8]))
        laser_pose, odometry = _pose(*poses[:3]), _odometry(*poses[3:8])
        end += 11
    return CarmenLine(
        tag=words[0],
        stamp_s=float(words[end]),
        odometry=odometry,
        fan=Fan(start_rad, step_rad, beams),
        laser_pose=laser_pose,
        ranges=list(map(float, words[9 : 9 + beams])),
        max_range_m=max_range_m if 0 < max_range_m <= SICK_MAX_RANGE_M else SICK_MAX_RANGE_M,
    )


def _sonar(words: list[str]) -> CarmenLine:
    cone_rad, sonars = float(words[1]), _number(words[2], MAX_SONARS)
    _check_length(words, 3 + 4 * sonars + TAIL)
    if not 0 < cone_rad <= 2 * pi:
        raise ValueError("the cone makes no sense")
    places = list(map(float, words[3 + sonars : 3 + 4 * sonars]))
    return CarmenLine(
        tag="SONAR",
        stamp_s=float(words[3 + 4 * sonars]),
        ranges=list(map(float, words[3 : 3 + sonars])),
        cone_rad=cone_rad,
        mounts=tuple(_pose(*places[i : i + 3]) for i in range(0, 3 * sonars, 3)),
    )


def _check_length(words: list[str], expected: int) -> None:
    if len(words) != expected:
        raise ValueError(f"{len(words)} words instead of {expected}")


def _number(word: str, limit: int, least: int = 1) -> int:
    number = int(word)
    if not least <= number <= limit:
        raise ValueError(f"{number} values")
    return number


def _pose(x_m: float, y_m: float, heading_rad: float) -> Pose:
    if not (abs(x_m) <= FAR_M and abs(y_m) <= FAR_M and isfinite(heading_rad)):
        raise ValueError("the pose makes no sense")
    return Pose(x_m=x_m, y_m=y_m, heading_rad=wrap_angle(heading_rad))


def _odometry(
    x_m: float, y_m: float, heading_rad: float, forward_mps: float = 0.0, turn_radps: float = 0.0
) -> Odometry:
    if not (abs(forward_mps) <= MAX_SPEED and abs(turn_radps) <= MAX_SPEED):
        raise ValueError("the speed makes no sense")
    return Odometry(pose=_pose(x_m, y_m, heading_rad), forward_mps=forward_mps, turn_radps=turn_radps)
