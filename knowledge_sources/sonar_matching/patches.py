"""Patches of the map: grids of one size, each in a frame of its own that moves as one piece when the pose is corrected."""

from math import ceil

from blackboard.grid import Grid
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import RobotDescription, SonarScan
from knowledge_sources.eou_params import EouGridParams
from knowledge_sources.sonar_evidence import SonarEvidence, pings
from knowledge_sources.sonar_matching.params import SonarMatcherParams

ROOM_M = 2.0  # beyond patch_m and reach_m: a window's way, and what a match looks beyond an echo


class Patches:
    """Grids by number; scans are folded into them at poses in their frames. One store of laid cones serves all."""

    def __init__(self, params: SonarMatcherParams) -> None:
        self._params = EouGridParams(cell_m=params.cell_m, sonar_range_m=params.reach_m)
        self._half_m = ceil(params.patch_m + params.reach_m + ROOM_M)
        self._evidence = SonarEvidence(self._params)
        self.grids: list[Grid] = []

    def add(self) -> int:
        """Begin another patch; return its number."""
        grid = Grid(self._params.cell_m)
        grid.cover(-self._half_m, -self._half_m, self._half_m, self._half_m)
        self.grids.append(grid)
        return len(self.grids) - 1

    def fold(self, patch: int, scan: SonarScan, robot: RobotDescription, patch_from_robot: Pose) -> None:
        """Fold a scan into a patch; what would lie outside is left out. Raises BoardError for a sonar that the robot lacks."""
        room_m = self._half_m - self._params.band_m - 2 * self._params.cell_m
        said = [
            ping
            for ping in pings(scan, robot, patch_from_robot, self._params)
            if max(abs(ping.x_m), abs(ping.y_m)) + ping.range_m < room_m
        ]
        if said:
            self._evidence.fold(self.grids[patch], said)
