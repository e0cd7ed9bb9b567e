"""Lines among places: points of which nobody knows where they were sensed from, on a map of any size.

A place is an echo of no range whose bearing is how the wall there faces, as far as the places around it show. The transform
needs a limit to rho and a neighbourhood in which a wall outweighs chance, so steps 1 to 8 of Bou-Ghannam 1992, section 5.2.3,
look through windows; what they find grows along its carrier over the whole map, as far as places follow, and is drawn to them
again. The best supported goes first, and a place belongs to one line.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np

from knowledge_sources.echoes import Array, Echoes, Index, Mask, wrap
from knowledge_sources.line_finder_params import LineFinderParams
from knowledge_sources.line_fit import refit
from knowledge_sources.line_points import order, split_at_breaks
from knowledge_sources.line_search import Piece, lines_of_echoes, straight_pieces
from knowledge_sources.place_buckets import Buckets
from knowledge_sources.place_directions import facing, local_normals

STRIPS = 5.0  # how far beside a line places are counted, in half breadths of it
SQUARE_M = 0.5
AHEAD = 2.0  # how far a round of growing looks to either side, in lengths of what it has
ROUNDS = 20  # of growing; the longest walls take five or six


def as_places(points: Array, params: LineFinderParams) -> Echoes:
    """Return points (n, 2) as places, in an order of their own."""
    points = points[np.lexsort((points[:, 1], points[:, 0]))]
    none = np.zeros(len(points))
    if not len(points):
        return Echoes(none, none, none, none, none, none)
    normal, slenderness = local_normals(points, params.around_m)
    turn = np.where(slenderness <= params.max_slenderness, params.place_turn_rad, pi / 2)
    return Echoes(points[:, 0], points[:, 1], none, facing(normal), none, turn)


def lines_of_places(places: Echoes, largest_gap_m: float, params: LineFinderParams) -> list[Piece]:
    """Return the straight pieces that the places lie on.

    What one round leaves is looked at through windows of half the size, in which a shorter line outweighs chance.
    """
    found: list[Piece] = []
    free = np.ones(len(places), dtype=bool)
    buckets = Buckets(places.x_m, places.y_m, max(SQUARE_M, 2.0 * STRIPS * params.fit_distance_m))
    side_m = params.window_m
    while side_m >= 2.0 * params.min_length_m:
        for seed in seeds(places, np.flatnonzero(free), side_m, largest_gap_m, params):
            if np.count_nonzero(free[seed.members]) < max(params.min_support, len(seed.members) / 2):
                continue
            members, alpha, rho = grown(places, buckets, seed, free, largest_gap_m, params)
            for piece in straight_pieces(places, members, alpha, rho, params):
                if stands_out(places, buckets, piece, params):
                    free[piece.members] = False
                    found.append(piece)
        side_m /= 2.0
    return sorted(found, key=_best_first)


def windows(places: Echoes, side_m: float) -> Iterator[Index]:
    """Yield which places lie in each square window that holds any, row by row.

    The windows begin half of one before the first place, so that windows of half the size have other borders.
    """
    if not len(places):
        return
    column = np.floor((places.x_m - places.x_m.min()) / side_m + 0.5).astype(np.intp)
    row = np.floor((places.y_m - places.y_m.min()) / side_m + 0.5).astype(np.intp)
    window = row * (int(column.max()) + 1) + column
    by_window = np.argsort(window, kind="stable")
    yield from np.split(by_window, np.flatnonzero(np.diff(window[by_window])) + 1)


def seeds(places: Echoes, among: Index, side_m: float, largest_gap_m: float, params: LineFinderParams) -> list[Piece]:
    """Return the lines that each window shows of some of the places, best supported first, unbroken ones only."""
    left = places.take(among)
    gap_m = min(largest_gap_m, params.min_length_m)
    lines = [
        replace(piece, members=among[window[piece.members]])
        for window in windows(left, side_m)
        if len(window) >= params.min_support
        for piece in lines_of_echoes(left.take(window), gap_m, params)
    ]
    return sorted(lines, key=_best_first)


def grown(
    places: Echoes, buckets: Buckets, seed: Piece, free: Mask, largest_gap_m: float, params: LineFinderParams
) -> tuple[Index, float, float]:
    """Return the free places that a piece comes to as it grows along its carrier, and the line (alpha, rho) through them."""
    alpha, rho, start, end = seed.alpha_rad, seed.rho_m, seed.start_m, seed.end_m
    members = seed.members[free[seed.members]]
    for _ in range(ROUNDS):
        reach_m = AHEAD * (end - start) + largest_gap_m
        ahead = buckets.along(*_ends(alpha, rho, start - reach_m, end + reach_m))
        ahead = ahead[free[ahead]]
        along, out = _along_and_out(places, ahead, alpha)
        turn = np.abs(wrap(2.0 * (places.bearing_rad[ahead] - alpha))) / 2.0  # undirected
        near = np.flatnonzero((np.abs(out - rho) <= params.fit_distance_m) & (turn <= places.max_incidence_rad[ahead]))
        pieces = split_at_breaks(along, order(along, near), min(largest_gap_m, params.min_length_m))
        shared = [float(min(along[piece[-1]], end) - max(along[piece[0]], start)) for piece in pieces]
        if max(shared, default=0.0) <= 0.0:
            break
        longer = ahead[joined(along, pieces, int(np.argmax(shared)), largest_gap_m)]
        if len(longer) < params.min_support or np.array_equal(longer, members):
            break
        members = longer
        fit, along, _ = refit(places.take(members), alpha, rho, rounds=2)
        alpha, rho, start, end = fit.alpha_rad, fit.rho_m, float(along.min()), float(along.max())
    return members, alpha, rho


def joined(along_m: Array, pieces: list[Index], number: int, largest_gap_m: float) -> Index:
    """Return a piece, chosen among all along a line in order, with those that carry it on.

    Each of these is no shorter than the gap before it; a gap that the robot could pass ends the line (step 8).
    """

    def carries_on(before: Index, after: Index, new: Index) -> bool:
        gap_m, length_m = float(along_m[after[0]] - along_m[before[-1]]), float(along_m[new[-1]] - along_m[new[0]])
        return gap_m <= min(largest_gap_m, length_m)

    first = last = number
    while first > 0 and carries_on(pieces[first - 1], pieces[first], pieces[first - 1]):
        first -= 1
    while last + 1 < len(pieces) and carries_on(pieces[last], pieces[last + 1], pieces[last + 1]):
        last += 1
    return np.concatenate(pieces[first : last + 1])


def stands_out(places: Echoes, buckets: Buckets, piece: Piece, params: LineFinderParams) -> bool:
    """Say whether places follow close on each other along most of a piece, and are more than chance strews beside it.

    Beside it, on either side in a strip twice as wide as its own; that with fewer counts, for things may stand against a wall.
    """
    own = np.sort(_along_and_out(places, piece.members, piece.alpha_rad)[0])
    closed_m = float(np.minimum(np.diff(own), params.close_m).sum())
    if closed_m < params.min_closed_fraction * float(own[-1] - own[0]):
        return False
    around = buckets.along(*_ends(piece.alpha_rad, piece.rho_m, piece.start_m, piece.end_m))
    along, out = _along_and_out(places, around, piece.alpha_rad)
    aside = (out[(along >= piece.start_m) & (along <= piece.end_m)] - piece.rho_m) / params.fit_distance_m
    beside = min(np.count_nonzero((side > 1.0) & (side <= STRIPS)) for side in (aside, -aside)) / 2.0
    return bool(len(own) > beside + params.chance_sigmas * sqrt(beside))


def _along_and_out(places: Echoes, members: Index, alpha_rad: float) -> tuple[Array, Array]:
    """Return what `on_wall` does, of some places, many times as quickly."""
    c, s = cos(alpha_rad), sin(alpha_rad)
    x, y = places.x_m[members], places.y_m[members]
    return y * c - x * s, x * c + y * s


def _ends(alpha_rad: float, rho_m: float, start_m: float, end_m: float) -> tuple[float, float, float, float]:
    """Return x and y of both ends of a piece of a line."""
    c, s = cos(alpha_rad), sin(alpha_rad)
    return rho_m * c - start_m * s, rho_m * s + start_m * c, rho_m * c - end_m * s, rho_m * s + end_m * c


def _best_first(piece: Piece) -> tuple[float, ...]:
    return (-len(piece.members), piece.alpha_rad, piece.rho_m, piece.start_m)
