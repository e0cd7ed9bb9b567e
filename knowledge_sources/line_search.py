"""From a batch of range readings to lines, by either method (a third, for points of a whole map, is `place_search`).

Method "axis" is Bou-Ghannam 1992, section 5.2.3: steps 1 to 8, which are the functions of `hough`, `line_clusters` and
`line_points` in that order, and no more. Method "tangent" takes an echo for what it is, heard somewhere in a cone (Tardos et al.
2002), refits each line and asks for evidence; the thesis's points lie where the cones' axes end, which for most echoes is no wall.
"""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from blackboard.messages.geometry import Point, wrap_angle
from blackboard.messages.world import Line
from knowledge_sources.echoes import (
    Array,
    Echoes,
    Index,
    expected_ranges,
    met,
    near_lines,
    on_wall,
)
from knowledge_sources.hough import HoughSpace, accumulate, cell_lines, chance_threshold, heaviest_nearby, heavy_cells
from knowledge_sources.line_clusters import cluster_lines, mean_line
from knowledge_sources.line_evidence import independent_places, stretches
from knowledge_sources.line_finder_params import LineFinderParams
from knowledge_sources.line_fit import bend, refit, refit_all
from knowledge_sources.line_points import group, order, split_at_breaks

PEAK_ALPHA_CELLS, PEAK_RHO_CELLS = 3, 1  # a wall's own votes outside its cell reach about so far
SURE_SHARE = 0.5  # up to this share of the largest incidence every wall answers, smooth or rough
SAME_LINE = 0.5  # of its echoes belong to a better supported line: that line once more, or a cut across it


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A piece of a line, before it becomes a message."""

    alpha_rad: float
    rho_m: float  # signed, from the map's origin
    start_m: float  # along the line
    end_m: float
    members: Index  # of the echoes
    largest_m: float  # distance of a member from it


def lines_of_points(points: Echoes, largest_gap_m: float, params: LineFinderParams) -> list[Piece]:
    """Return the lines as the thesis has them: a point belongs to every line that it is near to."""
    found = []
    alpha, rho = clustered_lines(points, params)
    for a, r in zip(alpha.tolist(), rho.tolist(), strict=True):
        along, out = on_wall(points, a)
        for members in split_at_breaks(along, order(along, group(out - r, params.line_distance_m)), largest_gap_m):
            start, end = float(along[members[0]]), float(along[members[-1]])
            if len(members) >= params.min_support and end - start >= params.min_length_m:
                found.append(Piece(a, r, start, end, members, float(np.abs(out[members] - r).max())))
    return found


def lines_of_echoes(echoes: Echoes, largest_gap_m: float, params: LineFinderParams) -> list[Piece]:
    """Return the walls that the echoes prove.

    An echo supports one line only, the first that is proved with it: it has one source, and else every strong wall
    would return once more from each cell beside its own.
    """
    found: list[Piece] = []
    free = np.arange(len(echoes))
    for _ in range(params.passes):
        rest = echoes.take(free)
        taken = np.zeros(len(free), dtype=bool)
        for a, r, members in sharp_lines(rest, *clustered_lines(rest, params), params):
            near = members[~taken[members]]
            if len(near) < params.min_support:
                continue
            along, _ = on_wall(rest.take(near), a)
            for run in split_at_breaks(along, order(along, np.arange(len(near))), largest_gap_m):
                for piece in straight_pieces(rest, near[run], a, r, params):
                    if is_borne_out(piece, echoes, params):
                        taken[piece.members] = True
                        found.append(piece)
        free = free[~taken]
        if not taken.any() or len(free) < params.min_support:
            break
    return found


def sharp_lines(
    echoes: Echoes, alpha_rad: Array, rho_m: Array, params: LineFinderParams
) -> list[tuple[float, float, Index]]:
    """Return the lines as walls seen from one side, drawn to their echoes, each with these; best supported first.

    A wall faces its sensors, so each line is tried from both sides. Lines that come to the same echoes are one.
    """
    alpha, rho = np.concatenate([alpha_rad, alpha_rad + pi]), np.concatenate([rho_m, -rho_m])
    line, echo = near_lines(echoes, alpha, rho, params.line_distance_m)
    heard = echoes.take(echo)
    for width_m in (params.line_distance_m, params.fit_distance_m, params.fit_distance_m):
        beyond, along = met(heard, alpha[line], rho[line])
        alpha, rho = refit_all(line, beyond, along, alpha, rho, width_m)
    # A line that has turned is near to others than it began with.
    line, echo = near_lines(echoes, alpha, rho, params.fit_distance_m)
    members = np.split(echo, np.searchsorted(line, np.arange(1, len(alpha))))
    sizes = np.array([len(own) for own in members])
    chosen: list[int] = []
    owned = np.zeros((len(alpha), len(echoes)), dtype=bool)
    for k in np.argsort(-sizes, kind="stable").tolist():
        if sizes[k] < params.min_support:
            break
        if (np.count_nonzero(owned[: len(chosen), members[k]], axis=1) <= SAME_LINE * sizes[k]).all():
            owned[len(chosen), members[k]] = True
            chosen.append(k)
    return [(float(alpha[k]), float(rho[k]), members[k]) for k in chosen]


def clustered_lines(echoes: Echoes, params: LineFinderParams) -> tuple[Array, Array]:
    """Return alpha and rho, about the map's origin, of the lines that many echoes vote for (steps 1 to 5), heaviest
    first.

    The middle of the sensors' places is the transform's origin: rho has no sign and a limit, so it must be near the
    robot.
    """
    space = HoughSpace(
        origin_x_m=float(echoes.x_m.mean()),
        origin_y_m=float(echoes.y_m.mean()),
        alpha_cells=2 * round(pi / params.alpha_step_rad),
        rho_step_m=params.rho_step_m,
        rho_cells=round(params.reach_m / params.rho_step_m),
    )
    votes = accumulate(echoes, space)
    i, j = heavy_cells(votes, chance_threshold(votes, params.min_votes, params.chance_sigmas))
    resolution_m = np.inf
    if params.method != "axis":
        peaks = heaviest_nearby(votes, i, j, PEAK_ALPHA_CELLS, PEAK_RHO_CELLS)
        i, j, resolution_m = i[peaks], j[peaks], params.cluster_resolution_m
    alpha, rho = cell_lines(space, i, j)
    weights = votes[i, j].astype(np.float64)
    lever_m = space.rho_step_m / space.alpha_step_rad
    centres, nearest = cluster_lines(alpha, rho, lever_m, params.cluster_fraction, resolution_m)
    own = [nearest == k for k in range(len(centres))]
    means = [
        mean_line(alpha[own[k]], rho[own[k]], weights[own[k]], float(alpha[c]), float(rho[c]))
        for k, c in enumerate(centres)
    ]
    heaviest_first = sorted(range(len(centres)), key=lambda k: -float(weights[own[k]].max()))
    mean = np.array([means[k] for k in heaviest_first]).reshape(-1, 2)
    shift = space.origin_x_m * np.cos(mean[:, 0]) + space.origin_y_m * np.sin(mean[:, 0])
    return mean[:, 0], mean[:, 1] + shift


def straight_pieces(
    echoes: Echoes, members: Index, alpha_rad: float, rho_m: float, params: LineFinderParams
) -> list[Piece]:
    """Return the piece of wall that these echoes prove, or its parts where it bends; none that is unsure or too short."""
    if len(members) < params.min_support:
        return []
    own = echoes.take(members)
    fit, along, out = refit(own, alpha_rad, rho_m, rounds=2)
    by_place = order(along, np.arange(len(members)))
    at, better = bend(along[by_place], out[by_place], params.min_support // 2)
    if better > params.max_bend and fit.spread_m > params.min_bent_spread_m:
        halves = members[by_place[:at]], members[by_place[at:]]
        return [p for half in halves for p in straight_pieces(echoes, half, fit.alpha_rad, fit.rho_m, params)]
    if fit.spread_m > params.max_spread_m or fit.tilt_rad > params.max_tilt_rad:
        return []
    first, last = stretches(own, fit, params.tolerance_sigmas * fit.spread_m)
    explained = first <= last
    first, last = first[explained], last[explained]
    places = len(independent_places(first, last))
    if places < params.min_places or fit.tilt_rad > places * params.max_tilt_per_place_rad:
        return []
    # No wall need reach further than to the first stretch's end and to the last one's beginning.
    start, end = float(last.min()), float(first.max())
    if end - start < params.min_length_m:
        return []
    return [Piece(fit.alpha_rad, fit.rho_m, start, end, members, float(np.abs(out - fit.rho_m).max()))]


def is_borne_out(piece: Piece, echoes: Echoes, params: LineFinderParams) -> bool:
    """Say whether hardly any echo came from beyond the piece that should have come from it."""
    start, end = np.array([piece.start_m]), np.array([piece.end_m])
    expected = expected_ranges(echoes, piece.alpha_rad, piece.rho_m, start, end, SURE_SHARE)
    against = int(np.count_nonzero(echoes.range_m > expected + params.contradiction_margin_m))
    return against <= params.max_contradicted_fraction * len(piece.members)


def as_line(piece: Piece) -> Line:
    """Return the message: rho not negative, and the end with the smaller x first, or the smaller y where the line is steep."""
    cosine, sine = cos(piece.alpha_rad), sin(piece.alpha_rad)
    start, end = (
        Point(x_m=piece.rho_m * cosine - at * sine, y_m=piece.rho_m * sine + at * cosine)
        for at in (piece.start_m, piece.end_m)
    )
    steep = abs(cosine) > abs(sine)
    if (end.y_m < start.y_m) if steep else (end.x_m < start.x_m):
        start, end = end, start
    flipped = piece.rho_m < 0.0
    return Line(
        start=start,
        end=end,
        alpha_rad=wrap_angle(piece.alpha_rad + (pi if flipped else 0.0)),
        rho_m=abs(piece.rho_m),
        sigma_rho_m=piece.largest_m,
        support=len(piece.members),
    )
