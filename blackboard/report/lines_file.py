"""The lines as `lines.geojson`: one LineString each, in metres of the map frame.

Source: RFC 7946; coordinates are local, which section 4 leaves to prior arrangement, so a foreign member (section 6.1) says so.
"""

import json
from collections.abc import Sequence
from math import degrees, hypot
from pathlib import Path
from typing import Any

from blackboard.entry import Entry
from blackboard.messages.world import Line

COORDINATES = {
    "frame": "map",
    "units": "m",
    "note": "local metres, x and y of the map frame: not longitude and latitude",
}


def line_feature(entry: Entry[Line]) -> dict[str, Any]:
    """Return the GeoJSON Feature of one line."""
    line = entry.value
    ends = [[round(p.x_m, 6), round(p.y_m, 6)] for p in (line.start, line.end)]
    length_m = hypot(line.end.x_m - line.start.x_m, line.end.y_m - line.start.y_m)
    return {
        "type": "Feature",
        "id": entry.id,
        "geometry": {"type": "LineString", "coordinates": ends},
        "properties": {
            "id": entry.id,
            "length_m": round(length_m, 6),
            "support": line.support,
            "sigma_rho_m": round(line.sigma_rho_m, 6),
            "alpha_deg": round(degrees(line.alpha_rad), 6),
            "rho_m": round(line.rho_m, 6),
            "stamp_s": round(entry.stamp_s, 6),
        },
    }


def write_lines(lines: Sequence[Entry[Line]], path: Path) -> None:
    """Write all lines as a FeatureCollection, one feature a row."""
    features = ",\n".join(json.dumps(line_feature(entry), allow_nan=False) for entry in lines)
    head = f'{{"type": "FeatureCollection",\n"coordinates_in": {json.dumps(COORDINATES)},\n"features": ['
    path.write_text(head + (f"\n{features}\n" if lines else "") + "]}\n", encoding="utf-8")
