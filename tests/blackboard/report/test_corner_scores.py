"""Scores of corners on a room with a pillar."""

from math import pi

import pytest
import shapely

from blackboard.component import WorldTruth
from blackboard.messages.geometry import Point
from blackboard.messages.symbols import Corner
from blackboard.report.corner_scores import corner_scores, true_corners

PILLAR = shapely.box(2.0, 2.0, 2.5, 2.3)
ROOM = WorldTruth(solid=PILLAR, floor=shapely.box(0.0, 0.0, 5.0, 4.0))


def corner(x: float, y: float, shape: str) -> Corner:
    return Corner(
        place=Point(x_m=x, y_m=y), sigma_x_m=0.02, sigma_y_m=0.02, correlation=0.0, opening_rad=pi / 2, bisector_rad=0.0,
        shape=shape, gap_m=0.0, lines=("a", "b"),  # type: ignore[arg-type]
    )  # fmt: skip


def test_the_room_s_corners_are_concave_the_pillar_s_convex() -> None:
    found = true_corners(ROOM, 0.1)
    assert sorted((c.x_m, c.y_m) for c in found if c.shape == "concave") == [(0, 0), (0, 4), (5, 0), (5, 4)]
    assert sorted((c.x_m, c.y_m) for c in found if c.shape == "convex") == [(2, 2), (2, 2.3), (2.5, 2), (2.5, 2.3)]
    assert len(true_corners(ROOM, 0.4)) == 4  # the pillar is 0.3 m deep
    (origin,) = [c for c in found if (c.x_m, c.y_m) == (0, 0)]
    assert sorted(origin.beside) == [pytest.approx((0.0, 0.2)), pytest.approx((0.2, 0.0))]


def test_right_and_found_are_counted_apart() -> None:
    corners = [
        corner(0.1, 0.0, "concave"),
        corner(5.0, 0.0, "convex"),
        corner(2.0, 2.0, "convex"),
        corner(1, 1, "unknown"),
    ]
    assert corner_scores(corners, ROOM) == {"corners_right_fraction": 0.5, "corners_found_fraction": 0.25}
    assert corner_scores([], ROOM) == {}
    assert corner_scores(corners, None) == {}
    assert corner_scores(corners[:1], WorldTruth(solid=PILLAR, floor=PILLAR)) == {"corners_right_fraction": 0.0}
