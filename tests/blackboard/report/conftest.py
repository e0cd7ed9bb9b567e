"""Small worlds, grids and lines that can be checked by hand."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
import shapely

from blackboard.component import WorldTruth
from blackboard.entry import Entry
from blackboard.grid import KnownPart
from blackboard.messages.geometry import IDENTITY, Point
from blackboard.messages.sensing import RobotDescription, SonarSensor
from blackboard.messages.world import Line
from blackboard.report.milestones import GridStage, Lead, LineStage, Milestones, Visit
from blackboard.report.result import RunResult

MakeLine = Callable[..., Entry[Line]]
MakeGrid = Callable[..., KnownPart]


@pytest.fixture
def box_truth() -> WorldTruth:
    """A room of 4 x 3 m, walls 0.2 m thick around it, and a cabinet of 1 x 0.6 m in the middle of its lower wall."""
    floor = shapely.box(0.0, 0.0, 4.0, 3.0)
    walls = shapely.difference(shapely.box(-0.2, -0.2, 4.2, 3.2), floor)
    return WorldTruth(solid=shapely.union_all([walls, shapely.box(1.5, 0.0, 2.5, 0.6)]), floor=floor)


@pytest.fixture
def make_line() -> MakeLine:
    def make(x0: float, y0: float, x1: float, y1: float, id: str = "1-0") -> Entry[Line]:
        alpha_rad = np.arctan2(y1 - y0, x1 - x0) + np.pi / 2
        rho_m = x0 * np.cos(alpha_rad) + y0 * np.sin(alpha_rad)
        if rho_m < 0:
            rho_m, alpha_rad = -rho_m, alpha_rad - np.pi
        line = Line(
            start=Point(x_m=x0, y_m=y0),
            end=Point(x_m=x1, y_m=y1),
            alpha_rad=float(alpha_rad),
            rho_m=float(rho_m),
            sigma_rho_m=0.02,
            support=40,
        )
        key = f"ski/k2a/observations/feature/line/{id}"
        return Entry(key=key, id=id, revision=3, event="posted", stamp_s=12.5, source="line_finder", value=line)

    return make


@pytest.fixture
def make_grid() -> MakeGrid:
    def make(cells: object, x_min_m: float = 0.0, y_min_m: float = 0.0, cell_m: float = 0.05) -> KnownPart:
        return KnownPart(np.array(cells, dtype=np.uint8), x_min_m, y_min_m, cell_m)

    return make


@pytest.fixture
def robot() -> RobotDescription:
    return RobotDescription(
        name="k2a",
        radius_m=0.2,
        max_speed_mps=0.5,
        max_turn_radps=1.0,
        max_acceleration_mps2=1.0,
        sonars=(SonarSensor(mount=IDENTITY, cone_rad=0.2, max_range_m=10.0),),
    )


@pytest.fixture
def path() -> npt.NDArray[np.float64]:
    """Three metres along y = 2 in 30 s, looking ahead."""
    stamps = np.linspace(0.0, 30.0, 61)
    return np.stack([stamps, 0.5 + stamps / 10.0, np.full(61, 2.0), np.zeros(61)], axis=1)


@pytest.fixture
def result(
    robot: RobotDescription,
    path: npt.NDArray[np.float64],
    make_line: MakeLine,
    make_grid: MakeGrid,
    box_truth: WorldTruth,
) -> RunResult:
    """A run through the room of `box_truth`: all floor known empty, its lower wall known and found as a line."""
    cells = np.full((80, 100), 128)  # 4 x 5 m from (-0.5, -0.5)
    cells[10:70, 10:90] = 0
    cells[9, 9:91] = 255
    return RunResult(
        mission="wander-lab",
        robot=robot,
        trajectory=path,
        grid=make_grid(cells, -0.5, -0.5),
        lines=[make_line(0.0, 0.0, 1.5, 0.0)],
        true_trajectory=path,
        truth=box_truth,
        table={"time_s": 30.0},
    )


@pytest.fixture
def milestones(result: RunResult) -> Milestones:
    lower, upper = np.array([[0.0, 0.0, 1.5, 0.0]]), np.array([[0.0, 3.0, 4.0, 3.0]])
    return Milestones(
        scans=[GridStage(stamp_s=s, scans=n, grid=result.grid) for s, n in ((0.0, 1), (1.0, 6), (10.0, 51))],
        raw=np.array([[0.0, 0.0], [0.5, 0.0], [2.0, 2.0]]),
        filtered=np.array([[0.0, 0.0], [0.5, 0.0]]),
        first=LineStage(from_s=0.0, stamp_s=10.0, ends=lower, points=500),
        second=LineStage(from_s=10.0, stamp_s=20.0, ends=upper, points=512),
        merged=LineStage(from_s=0.0, stamp_s=21.0, ends=np.vstack([lower, upper])),
        behaviours=["avoid_obstacles", "curiosity", "random_wander"],
        leads=[Lead(stamp_s=0.0, behaviour="curiosity"), Lead(stamp_s=12.0, behaviour="random_wander")],
        visits=[
            Visit(place=Point(x_m=1.0, y_m=1.0), behaviour="target_nav", stamp_s=5.0, outcome="reached"),
            Visit(place=Point(x_m=3.0, y_m=1.0), behaviour="target_nav", stamp_s=9.0, outcome="blocked"),
        ],
    )
