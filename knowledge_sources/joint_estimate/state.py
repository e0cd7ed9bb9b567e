"""The joint state: the robot's pose, what its wheels and sonars are wrong by, its recent past, and all lines, with one covariance.

mean (LINES + 2 a line):
X, Y, HEADING                          map_from_robot
DISTANCE_SCALE, TURN_SCALE, DRIFT      what odometry is to be stretched by, less 1, and its turn for each metre
LATENCY                                how late stamps of sonars are
BATCH                                  the pose when the batch of points began that the next lines will be found in
PAST                                   WINDOW past poses
LINES                                  of each line its direction, and its offset along the normal at its anchor

The normal points to the right of the direction. Sources: Smith, Self and Cheeseman 1990, the stochastic map; Bou-Ghannam 1992,
section 2.5.2 for the Kalman equations.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, hypot, sin

import numpy as np

from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.uncertainty.matrices import Array
from knowledge_sources.joint_estimate.params import JointLinesParams

X, Y, HEADING, DISTANCE_SCALE, TURN_SCALE, DRIFT, LATENCY = range(7)
BATCH = 7  # of the three of the pose where the standing batch of points began
PAST = 10  # of the poses that are remembered, three each
WINDOW = 40  # of them
LINES = PAST + 3 * WINDOW
START_SIGMAS = (1e-3, 1e-3, 1e-3)  # the map is where the robot starts; a covariance must not be singular


@dataclass(frozen=True, slots=True, kw_only=True)
class LineExtent:
    """What of a line is not estimated: the anchor of its offset, how far it reaches to both sides of it, which side is sensed."""

    id: str
    anchor_x_m: float
    anchor_y_m: float
    from_m: float
    to_m: float
    faces_left: bool
    observations: int = 1


class JointState:
    """Mean and covariance, and the lines in their order."""

    def __init__(self, pose: Pose, params: JointLinesParams) -> None:
        self.mean: Array = np.zeros(LINES)
        self.mean[: LATENCY + 1] = [pose.x_m, pose.y_m, pose.heading_rad, 0.0, 0.0, 0.0, params.latency_s]
        errors = (
            params.distance_scale_sigma,
            params.turn_scale_sigma,
            params.drift_sigma_rad_per_m,
            params.latency_sigma_s,
        )
        self.covariance: Array = np.diag(np.square([*START_SIGMAS, *errors, *[0.0] * (LINES - BATCH)]))
        self.lines: list[LineExtent] = []
        self._remembered = 0
        self._params = params
        self.begin_batch()

    @property
    def pose(self) -> Pose:
        x, y, heading = self.mean[:DISTANCE_SCALE].tolist()
        return Pose(x_m=x, y_m=y, heading_rad=wrap_angle(heading))

    @property
    def pose_covariance(self) -> Array:
        """The pose's own part of the covariance, (3, 3)."""
        return self.covariance[:DISTANCE_SCALE, :DISTANCE_SCALE].copy()

    def number(self, id_: str) -> int:
        """Return where among the lines one stands; raise ValueError where it does not."""
        return [extent.id for extent in self.lines].index(id_)

    def line(self, number: int) -> tuple[float, float, Array]:
        """Return a line's direction, offset, and their covariance (2, 2)."""
        at = LINES + 2 * number
        return float(self.mean[at]), float(self.mean[at + 1]), self.covariance[at : at + 2, at : at + 2]

    def begin_batch(self) -> None:
        """Remember the pose, with all that it shares with the rest of the state."""
        self.mean[BATCH:PAST] = self.mean[:DISTANCE_SCALE]
        p = self.covariance
        p[BATCH:PAST] = p[:DISTANCE_SCALE]
        p[:, BATCH:PAST] = p[:, :DISTANCE_SCALE]

    def remember(self) -> int:
        """Keep the pose as one of the past; return where it stands in the mean. It takes the place of the oldest."""
        at = PAST + 3 * (self._remembered % WINDOW)
        self._remembered += 1
        self.mean[at : at + 3] = self.mean[:DISTANCE_SCALE]
        p = self.covariance
        p[at : at + 3] = p[:DISTANCE_SCALE]
        p[:, at : at + 3] = p[:, :DISTANCE_SCALE]
        return at

    def seen(self, x_m: float, y_m: float, theta_rad: float) -> Array:
        """Return J (2, 10): how direction and offset of a line of the batch, with its middle at (x, y), answer to the state.

        Its points were sensed between the batch's beginning and now: its error is the mean of both poses'.
        """
        j = np.zeros((2, PAST))
        nx, ny = sin(theta_rad), -cos(theta_rad)
        for at in (X, BATCH):
            lever = nx * -(y_m - float(self.mean[at + 1])) + ny * (x_m - float(self.mean[at]))
            j[:, at : at + 3] = [[0.0, 0.0, 0.5], [nx / 2.0, ny / 2.0, lever / 2.0]]
        return j

    def drive(self, step: Pose) -> None:
        """Move the pose by what the wheels tell of a step: the pose after it in the robot's frame before it."""
        way, turn = hypot(step.x_m, step.y_m), step.heading_rad
        if way == 0.0 and turn == 0.0:
            return
        mean, w = self.mean, self._params
        scale = 1.0 + float(mean[DISTANCE_SCALE])
        extra = float(mean[TURN_SCALE]) * turn + float(mean[DRIFT]) * way
        along = float(mean[HEADING]) + extra / 2.0  # the chord of an arc turns by half of what the heading turns
        c, s = cos(along), sin(along)
        dx, dy = c * step.x_m - s * step.y_m, s * step.x_m + c * step.y_m
        f = np.eye(BATCH)
        f[X, HEADING], f[Y, HEADING] = -scale * dy, scale * dx
        f[X, DISTANCE_SCALE], f[Y, DISTANCE_SCALE] = dx, dy
        for error, amount in ((TURN_SCALE, turn), (DRIFT, way)):
            f[X, error], f[Y, error], f[HEADING, error] = -scale * dy * amount / 2, scale * dx * amount / 2, amount
        mean[X] += scale * dx
        mean[Y] += scale * dy
        mean[HEADING] += turn + extra
        p = self.covariance
        p[:BATCH] = f @ p[:BATCH]
        p[:, :BATCH] = p[:, :BATCH] @ f.T
        heading = w.heading_noise_rad**2 * way + w.turn_noise_rad**2 * abs(turn)
        if way > 0.0:
            g = np.array([dx / way, dy / way, 0.0])
            p[:3, :3] += np.outer(g, g) * (w.distance_noise_m**2 * way)
        g = np.array([-dy / 2.0, dx / 2.0, 1.0])
        p[:3, :3] += np.outer(g, g) * heading

    def update(self, difference: Array, h: Array, noise: Array) -> Array:
        """Take in measurements: `difference` (m,) measured less predicted, `h` (m, n), covariance `noise` (m, m).

        Return the change (n,) of the mean.
        """
        ph = self.covariance @ h.T
        s = h @ ph + noise
        gain = np.linalg.solve(s, ph.T).T
        change: Array = gain @ difference
        self.mean += change
        p = self.covariance - gain @ ph.T
        self.covariance = (p + p.T) / 2.0
        return change

    def add(self, extent: LineExtent, theta_rad: float, seen: Array, jacobian: Array) -> None:
        """Take a line in; `seen` (2, 2) is the covariance of its own, `jacobian` (2, 10) how the state moves it."""
        p, n = self.covariance, len(self.mean)
        cross = jacobian @ p[:PAST]
        grown = np.zeros((n + 2, n + 2))
        grown[:n, :n] = p
        grown[n:, :n], grown[:n, n:] = cross, cross.T
        grown[n:, n:] = jacobian @ p[:PAST, :PAST] @ jacobian.T + seen
        self.covariance = grown
        self.mean = np.append(self.mean, [theta_rad, 0.0])
        self.lines.append(extent)

    def widen(self, h: Array, difference: float) -> None:
        """Make the state less sure by the change that most likely explains a `difference`, to which it answers by `h` (n,)."""
        ph = self.covariance @ h
        change = ph * (difference / float(h @ ph))
        self.covariance = self.covariance + np.outer(change, change)

    def trust_pose(self, upper: Sequence[float]) -> None:
        """Let the pose be as sure as these six numbers of its covariance say, sharing nothing with the rest."""
        own = np.zeros((3, 3))
        own[np.triu_indices(3)] = upper
        self.covariance[:DISTANCE_SCALE, :DISTANCE_SCALE] = own + np.triu(own, 1).T
        self.begin_batch()

    def widen_pose(self, off: Array) -> None:
        """Make the pose less sure by as much as it may be off, (3,)."""
        self.covariance[:DISTANCE_SCALE, :DISTANCE_SCALE] += np.outer(off, off)

    def loosen(self, number: int, sigma_rad: float, sigma_m: float) -> None:
        """Make a line less sure by these deviations, as seen from where the robot is: what it shares with the pose stays."""
        at = LINES + 2 * number
        self.covariance[at, at] += sigma_rad**2
        self.covariance[at + 1, at + 1] += sigma_m**2

    def drop(self, number: int) -> None:
        """Forget a line."""
        at = [LINES + 2 * number, LINES + 2 * number + 1]
        self.mean = np.delete(self.mean, at)
        self.covariance = np.delete(np.delete(self.covariance, at, axis=0), at, axis=1)
        del self.lines[number]
