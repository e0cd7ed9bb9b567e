"""Ways along a wall: which of them keep their distance from what was heard."""

from collections.abc import Iterable, Sequence
from math import acos, asin, pi

from behaviours.near_echoes import Near

AHEAD_RAD, BESIDE_RAD, BEHIND_RAD = -pi / 9, pi / 9, 0.9 * pi  # where the pieces of a wall to the left lie
FIRST_RAD, LAST_RAD = 0.55 * pi, -0.55 * pi  # of the ways tried: just behind abeam on either side
ABOUT_RAD = -0.95 * pi  # in a dead end, the last way tried
AWAY_RAD_PER_M = (
    2.0  # how strongly it turns away from a wall that is too near: back to its distance within about a metre
)


def forbidden(nears: Iterable[Near], left_m: float, right_m: float, look_m: float) -> list[tuple[float, float]]:
    """Return the intervals of ways, robot frame, that lead nearer than so to an echo on either side within `look_m`."""
    ways = []
    for distance_m, bearing_rad, _, _, _ in nears:
        low = bearing_rad - _reach_rad(distance_m, left_m, look_m)  # it lies to the left of such ways
        high = bearing_rad + _reach_rad(distance_m, right_m, look_m)
        if low < high:
            ways += [(low + whole_rad, high + whole_rad) for whole_rad in (-2.0 * pi, 0.0, 2.0 * pi)]
    return ways


def _reach_rad(distance_m: float, width_m: float, look_m: float) -> float:
    """Return how far off an echo a way must lie: a disc of `width_m` that goes `look_m` along it does not touch the echo."""
    if distance_m <= width_m:
        return 0.5 * pi
    if distance_m >= width_m + look_m:
        return 0.0
    if distance_m * distance_m - width_m * width_m <= look_m * look_m:
        return asin(width_m / distance_m)
    return acos((distance_m**2 + look_m**2 - width_m**2) / (2.0 * distance_m * look_m))


def first_way(ways: Sequence[tuple[float, float]], first_rad: float, last_rad: float) -> float | None:
    """Return the first way, from the left one to the right one, that no interval forbids."""
    way_rad = first_rad
    for low, high in sorted(ways, key=lambda way: -way[1]):
        if high < way_rad:
            break
        way_rad = min(way_rad, low)
    return way_rad if way_rad >= last_rad else None


def wall_beside(nears: Iterable[Near], within_m: float) -> Near | None:
    """Return the nearest piece of a wall to the left, else of one ahead; what was heard but once is no wall yet."""
    walls = [near for near in nears if near[4] and near[0] <= within_m and AHEAD_RAD <= near[1] <= BEHIND_RAD]
    beside = [near for near in walls if near[1] >= BESIDE_RAD]
    return min(beside or walls, default=None)


def along_wall(
    nears: Sequence[Near], wall: Near, radius_m: float, keep_m: float, side_m: float, look_m: float
) -> float | None:
    """Return the way past a wall to the left, robot frame; in narrow places it keeps less away. None where it is boxed in.

    The way leaves `wall`, the nearest piece of it, to its left.
    """
    first_rad = min(wall[1], FIRST_RAD)
    for last_rad in (LAST_RAD, ABOUT_RAD):
        for room_m in (keep_m, max(side_m, 0.5 * keep_m), side_m):
            left_m = radius_m + room_m
            ways = forbidden(nears, min(left_m, wall[0]), radius_m + side_m, look_m)
            way_rad = first_way(ways, first_rad, last_rad)
            if way_rad is not None:
                away_rad = way_rad - AWAY_RAD_PER_M * max(0.0, left_m - wall[0])
                return way_rad if any(low < away_rad < high for low, high in ways) else away_rad
    return None


def first_side(nears: Iterable[Near], within_m: float) -> int:
    """Return the side of the nearest thing: 1 left, -1 right, 0 where there is none."""
    heard = [near for near in nears if near[4] and near[0] <= within_m]
    if not heard:
        return 0
    return 1 if min(heard)[1] >= 0.0 else -1


def mirrored(nears: Iterable[Near]) -> list[Near]:
    """Return the echoes as they would lie if left were right."""
    return [(distance, -bearing, cone, heard_s, settled) for distance, bearing, cone, heard_s, settled in nears]
