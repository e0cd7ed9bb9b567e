"""From a batch of points to lines by the method that a mission names: "tangent" or "axis" (see `line_search`), or "places"."""

from blackboard.messages.world import Line, PointSet
from knowledge_sources.echoes import Echoes, echoes_of, points_on_axis
from knowledge_sources.line_finder_params import LineFinderParams
from knowledge_sources.line_search import Piece, as_line, lines_of_echoes, lines_of_points
from knowledge_sources.place_search import as_places, lines_of_places

SEARCHES = {"tangent": lines_of_echoes, "axis": lines_of_points, "places": lines_of_places}


def find_lines(points: PointSet, largest_gap_m: float, params: LineFinderParams) -> list[Line]:
    """Return the lines of a batch, best supported first; lines break where points are `largest_gap_m` apart."""
    return [as_line(piece) for piece in find_pieces(as_echoes(points, params), largest_gap_m, params)]


def as_echoes(points: PointSet, params: LineFinderParams) -> Echoes:
    """Return a batch's readings as the method takes them."""
    if params.method == "places":
        return as_places(points.points.unpack().astype("float64"), params)
    if params.method == "axis":
        return points_on_axis(points)
    return echoes_of(points, params.max_incidence_rad, params.max_beam_incidence_rad)


def find_pieces(echoes: Echoes, largest_gap_m: float, params: LineFinderParams) -> list[Piece]:
    """Return the pieces of lines among readings."""
    return SEARCHES[params.method](echoes, largest_gap_m, params) if len(echoes) else []
