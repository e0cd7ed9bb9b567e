"""Trajectories in the format of the TUM RGB-D benchmark: `stamp x y z qx qy qz qw`, seconds and metres, one pose a row."""

from pathlib import Path

import numpy as np

from blackboard.errors import RecordingError
from blackboard.report.result import Trajectory


def write_trajectory(trajectory: Trajectory, path: Path) -> None:
    """Write poses (n, 4) of stamp_s, x_m, y_m, heading_rad; the robot stays on the floor, so z, qx and qy are 0."""
    half = trajectory[:, 3] / 2.0
    columns = zip(*trajectory[:, :3].T.tolist(), np.sin(half).tolist(), np.cos(half).tolist(), strict=True)
    rows = [f"{t:.6f} {x:.6f} {y:.6f} 0 0 0 {qz:.9f} {qw:.9f}\n" for t, x, y, qz, qw in columns]
    path.write_text("".join(rows), encoding="ascii")


def read_trajectory(path: Path) -> Trajectory:
    """Return the poses of such a file by their stamps, (n, 4), as seen from above; raise RecordingError where it is none."""
    try:
        rows = np.array(
            [line.split() for line in path.read_text("utf-8").splitlines() if line[:1] not in ("", "#")], float
        )
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror})") from None
    except ValueError:
        rows = np.empty((1, 0))
    if len(rows) and rows.shape[1] != 8:
        raise RecordingError(f"{path}: not a trajectory; each line must be 'stamp x y z qx qy qz qw'")
    rows = rows.reshape(-1, 8)
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    x, y, z, w = rows[:, 4:].T
    headings = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y**2 + z**2))
    return np.column_stack([rows[:, :3], headings])
