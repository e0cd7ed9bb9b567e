"""Tracks the robot from scan to scan: each new scan is matched to the surfaces that the last ones saw."""

from dataclasses import dataclass, field

import numpy as np

from knowledge_sources.laser_graph.field import Window, lay_field, search
from knowledge_sources.laser_graph.odometry_model import OdometryModel, fit_odometry
from knowledge_sources.laser_graph.point_to_line import Alignment, align, surface
from knowledge_sources.laser_graph.poses import Floats, between, compose, rotate, transform
from knowledge_sources.laser_graph.scan_points import ScanPoints

RECENT = 10  # scans that make the surface to match to
REFIT = 20  # scans between two estimates of odometry's errors
MEMORY = 200  # pieces of odometry that an estimate rests on
POOR_FIT = 0.3  # below it the search found nothing, and odometry alone holds the pose


@dataclass(eq=False)
class Tracker:
    """Keyframes: poses in the map, the odometry pieces between them (raw, corrected), the scans."""

    poses: list[Floats] = field(default_factory=list)
    pieces: list[Floats] = field(default_factory=list)  # piece i leads from keyframe i to i + 1
    scans: list[ScanPoints] = field(default_factory=list)
    information: list[Floats] = field(default_factory=list)  # of the step to keyframe i + 1, in the frame of keyframe i
    model: OdometryModel = field(default_factory=OdometryModel)
    lost: int = 0

    def add(self, scan: ScanPoints, piece: Floats) -> Floats:
        """Take the next scan, `piece` of odometry (3,) after the one before; return its pose (3,) in the map."""
        if not self.poses:
            self.poses.append(np.zeros(3))
            self.scans.append(scan)
            return self.poses[0]
        step = self.model.correct(piece[None])[0]
        sigma = self.model.sigmas(np.hypot(piece[:1], piece[1:2]), np.abs(piece[2:3]))[0]
        guess = compose(self.poses[-1], step)
        found = self._match(scan, guess, sigma)
        self.pieces.append(piece)
        self.poses.append(found.pose)
        self.scans.append(scan)
        heading = self.poses[-2][2]
        turn = np.array([[np.cos(heading), np.sin(heading), 0], [-np.sin(heading), np.cos(heading), 0], [0, 0, 1]])
        self.information.append(turn @ found.information @ turn.T)
        if len(self.pieces) % REFIT == 0:
            recent = self.poses[-MEMORY - 1 :]
            solved = between(np.array(recent[:-1]), np.array(recent[1:]))
            self.model = fit_odometry(np.array(self.pieces[-len(solved) :]), solved)
        return found.pose

    def _match(self, scan: ScanPoints, guess: Floats, sigma: Floats) -> Alignment:
        turn = np.array([[np.cos(guess[2]), -np.sin(guess[2]), 0], [np.sin(guess[2]), np.cos(guess[2]), 0], [0, 0, 1]])
        prior = turn @ np.diag(1.0 / sigma**2) @ turn.T
        points, normals, flat = placed(self.scans[-RECENT:], np.array(self.poses[-RECENT:]))
        thinned = scan.points[::2]
        if len(thinned) < 10 or len(points) < 10:
            self.lost += 1
            return Alignment(guess, prior, 0.0, np.inf)
        reach = float(np.hypot(scan.points[:, 0], scan.points[:, 1]).max()) + 1.0
        box = (guess[0] - reach, guess[1] - reach, guess[0] + reach, guess[1] + reach)
        window = Window(shift_m=float(min(3 * sigma[:2].max(), 2.0)), turn_rad=float(min(3 * sigma[2], 1.0)))
        start, fit = search(lay_field(points, box), thinned, guess, window)
        if fit < POOR_FIT:
            self.lost += 1
            start = guess
        target = surface(points[flat], normals[flat])
        return align(target, scan.points[scan.flat], scan.normals[scan.flat], start, guess, prior)


def placed(scans: list[ScanPoints], poses: Floats) -> tuple[Floats, Floats, np.ndarray]:
    """Return the points, normals (n, 2) and flatness (n,) of scans taken at poses (m, 3), in the poses' frame."""
    points = [transform(pose, scan.points) for scan, pose in zip(scans, poses, strict=True)]
    normals = [rotate(pose, scan.normals) for scan, pose in zip(scans, poses, strict=True)]
    return np.concatenate(points), np.concatenate(normals), np.concatenate([scan.flat for scan in scans])
