"""How well a run knew where the robot was: errors of its path, and whether its own covariance was honest.

NEES, the normalised estimation error squared, is e' P^-1 e for the error e = (x, y, heading) of a pose estimate and the covariance
P posted with it (Bar-Shalom, Li and Kirubarajan 2001, section 5.4). Where the estimate is honest it is chi-square with 3
degrees of freedom: 3 on average, and at most BOUND at 95 % of the instants.

The map begins where the robot does: a simulated robot's first odometry reading is its true pose, so map frame and true frame are
the same, the covariance is about nothing at first, and e is the plain difference to the truth; nothing is fitted or aligned. P
says how unsure the pose is as seen from the start, not as seen from the walls around.

Errors at instants of one run hang together: in the extreme the whole run is a single draw of chi-square. A run counts as
honest where its average NEES is at most BOUND, which about 95 % of honest runs keep in that extreme, and more otherwise. Far
below 3 the covariance is too large, which is no lie and shows in the average.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.report.result import Trajectory
from blackboard.uncertainty.chi_square import chi_square_quantile

Floats = npt.NDArray[np.float64]

BOUND = chi_square_quantile(0.95, 3)


@dataclass(frozen=True, kw_only=True)
class PathError:
    """Of a path against the true one, over its stamps: distances and sizes of angles."""

    mean_m: float
    max_m: float
    heading_mean_rad: float
    heading_max_rad: float


@dataclass(frozen=True, kw_only=True)
class Honesty:
    """Of the pose estimates of one run, or of several: their average NEES, and the fraction with NEES of at most BOUND."""

    instants: int
    nees_mean: float
    inside_fraction: float

    @property
    def honest(self) -> bool:
        """Say whether the average stays below the bound of a single draw."""
        return self.nees_mean <= BOUND


def true_poses(stamps_s: Floats, truth: Trajectory) -> Floats:
    """Return where the robot really was at these stamps, (n, 3), interpolated; the headings are unwrapped."""
    columns = (truth[:, 1], truth[:, 2], np.unwrap(truth[:, 3]))
    return np.column_stack([np.interp(stamps_s, truth[:, 0], column) for column in columns])


def pose_errors(path: Trajectory, truth: Trajectory, *, aligned: bool = False) -> Floats:
    """Return (n, 3) x, y, heading of a path less the truth's, over those of its stamps that the truth covers.

    `aligned`: the path is laid on the truth at its first pose, for recordings whose map frame is not the truth's. None is fitted.
    """
    covered = path[(path[:, 0] >= truth[0, 0]) & (path[:, 0] <= truth[-1, 0])]
    there = true_poses(covered[:, 0], truth)
    here = covered[:, 1:4].copy()
    if aligned and len(here):
        turn = there[0, 2] - here[0, 2]
        c, s = np.cos(turn), np.sin(turn)
        way = here[:, :2] - here[0, :2]
        here[:, :2] = there[0, :2] + way @ np.array([[c, s], [-s, c]])
        here[:, 2] += turn
    errors = here - there
    errors[:, 2] = np.arctan2(np.sin(errors[:, 2]), np.cos(errors[:, 2]))
    return np.asarray(errors)


def fitted_frame(path: Trajectory, truth: Trajectory) -> Pose:
    """Return map_from_world: the turn and shift that lay the true places best on those of the path, by least squares.

    The identity where they have fewer than two stamps in common. (Horn 1987, in the plane.)
    """
    covered = path[(path[:, 0] >= truth[0, 0]) & (path[:, 0] <= truth[-1, 0])]
    if len(covered) < 2:
        return IDENTITY
    here, there = covered[:, 1:3], true_poses(covered[:, 0], truth)[:, :2]
    middle_here, middle_there = here.mean(axis=0), there.mean(axis=0)
    a, b = there - middle_there, here - middle_here
    turn = float(np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum()))
    c, s = np.cos(turn), np.sin(turn)
    x, y = middle_here - (c * middle_there[0] - s * middle_there[1], s * middle_there[0] + c * middle_there[1])
    return Pose(x_m=float(x), y_m=float(y), heading_rad=turn)


def path_error(path: Trajectory, truth: Trajectory, *, aligned: bool = False) -> PathError | None:
    """Return the errors of a path; None where truth and path have no stamp in common."""
    errors = pose_errors(path, truth, aligned=aligned)
    if not len(errors):
        return None
    away, turned = np.hypot(errors[:, 0], errors[:, 1]), np.abs(errors[:, 2])
    return PathError(
        mean_m=float(away.mean()),
        max_m=float(away.max()),
        heading_mean_rad=float(turned.mean()),
        heading_max_rad=float(turned.max()),
    )


def pose_table(path: Trajectory, truth: Trajectory | None) -> dict[str, float]:
    """Return the rows about the pose for the table at the end of a run; none where nobody knows the truth."""
    error = path_error(path, truth) if truth is not None and len(truth) else None
    if error is None:
        return {}
    return {
        "pose_error_mean_m": error.mean_m,
        "pose_error_max_m": error.max_m,
        "heading_error_mean_rad": error.heading_mean_rad,
    }


def nees(errors: Floats, covariances: Floats) -> Floats:
    """Return (n,) e' P^-1 e of errors (n, 3) and covariances (n, 3, 3); infinite where a covariance is none."""
    scores = np.full(len(errors), np.inf)
    sound = np.linalg.eigvalsh(covariances)[:, 0] > 0.0 if len(errors) else np.zeros(0, dtype=bool)
    e, p = errors[sound], covariances[sound]
    scores[sound] = np.einsum("ni,ni->n", e, np.linalg.solve(p, e[:, :, None])[:, :, 0])
    return scores


def honesty(scores: Floats) -> Honesty | None:
    """Return what the NEES of some instants, (n,), tell; None of no instants."""
    if not len(scores):
        return None
    return Honesty(
        instants=len(scores), nees_mean=float(scores.mean()), inside_fraction=float((scores <= BOUND).mean())
    )
