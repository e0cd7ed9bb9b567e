"""How far a round robot can go in a direction before it touches something that was heard."""

from collections.abc import Iterable
from math import cos, inf, pi, sin, sqrt

from behaviours.near_echoes import Near

PASSING_RAD = 0.45 * pi  # what is nearer than the width wanted may be passed if it lies further off the way than this


def free_travel_m(distance_m: float, off_rad: float, half_width_m: float) -> float:
    """Return how far a disc goes straight on until its rim is at a point.

    The point lies `distance_m` from the disc's centre and `off_rad` >= 0 off its way. Infinity where the disc passes. A point
    inside the disc blocks every direction that leads nearer to it, and none past or away from it.
    """
    if distance_m <= half_width_m:
        return 0.0 if off_rad < PASSING_RAD else inf
    if off_rad >= 0.5 * pi:
        return inf
    beside_m = distance_m * sin(off_rad)
    if beside_m >= half_width_m:
        return inf
    return distance_m * cos(off_rad) - sqrt(half_width_m * half_width_m - beside_m * beside_m)


def off_course(bearing_rad: float, direction_rad: float) -> float:
    """Return the angle between two directions, in [0, pi]."""
    off_rad = abs(bearing_rad - direction_rad) % (2.0 * pi)
    return 2.0 * pi - off_rad if off_rad > pi else off_rad


def clear_way_m(nears: Iterable[Near], direction_rad: float, half_width_m: float, at_most_m: float) -> float:
    """Return how far a corridor of this half width is free in a direction (robot frame), at most `at_most_m`."""
    clear_m = at_most_m
    for distance_m, bearing_rad, _, _, _ in nears:
        if distance_m - half_width_m < clear_m:
            off_rad = off_course(bearing_rad, direction_rad)
            if off_rad < 0.5 * pi:
                clear_m = min(clear_m, free_travel_m(distance_m, off_rad, half_width_m))
    return clear_m
