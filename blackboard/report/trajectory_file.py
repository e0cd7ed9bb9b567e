"""Trajectories in the format of the TUM RGB-D benchmark: `stamp x y z qx qy qz qw`, seconds and metres, one pose a row."""

from pathlib import Path

import numpy as np

from blackboard.report.result import Trajectory


def write_trajectory(trajectory: Trajectory, path: Path) -> None:
    """Write poses (n, 4) of stamp_s, x_m, y_m, heading_rad; the robot stays on the floor, so z, qx and qy are 0."""
    half = trajectory[:, 3] / 2.0
    columns = zip(*trajectory[:, :3].T.tolist(), np.sin(half).tolist(), np.cos(half).tolist(), strict=True)
    rows = [f"{t:.6f} {x:.6f} {y:.6f} 0 0 0 {qz:.9f} {qw:.9f}\n" for t, x, y, qz, qw in columns]
    path.write_text("".join(rows), encoding="ascii")
