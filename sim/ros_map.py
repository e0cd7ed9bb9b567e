"""Worlds from a ROS map: `map.yaml` and its image, as map_server and nav2 write them.

Only free cells are floor: what is occupied or unknown is solid, and so is the world beyond the image.
"""

import re
import warnings
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

import numpy as np
import numpy.typing as npt
import shapely
from PIL import Image, UnidentifiedImageError
from shapely.affinity import affine_transform

from blackboard.errors import MissionError
from blackboard.files import is_file
from sim.contour import outline_free
from sim.world import FAR_M, World, make_world

MAX_PIXELS = 36_000_000
MAX_YAML_BYTES = 100_000
KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")


@dataclass(frozen=True)
class MapHeader:
    """What `map.yaml` says. `origin` is the pose of the image's lower left corner: x m, y m, heading radians."""

    image: Path
    resolution_m: float
    origin: tuple[float, float, float]
    negate: bool
    occupied_thresh: float
    free_thresh: float


def load_ros_map(path: Path) -> World:
    """Return the world of a ROS map; raise MissionError where the file or its image is wrong."""
    header = read_header(path)
    free = free_cells(read_image(header.image, path), header)
    if not free.any():
        raise MissionError(f"{path}: the image has no free cell; check negate, free_thresh and occupied_thresh")
    rows, columns = free.shape
    cell, (x, y, heading) = header.resolution_m, header.origin
    c, s = cell * np.cos(heading), cell * np.sin(heading)
    to_map = [c, s, s, -c, x - s * rows, y + c * rows]  # the image's y runs down from its upper edge
    floor = affine_transform(shapely.box(0, 0, columns, rows), to_map)
    if np.abs(floor.bounds).max() > FAR_M:
        raise MissionError(f"{path}: the map reaches beyond {FAR_M:g} m from its origin; check resolution and origin")
    return make_world(
        str(path),
        floor=floor,
        free=affine_transform(outline_free(free), to_map),
        rough_things=shapely.Polygon(),
        circles=np.zeros((0, 3)),
        circle_rough=np.zeros(0, dtype=bool),
    )


def read_header(path: Path) -> MapHeader:
    """Return what `map.yaml` says: flat `key: value` lines, lists in brackets or as dashes."""
    try:
        if path.stat().st_size > MAX_YAML_BYTES:
            raise MissionError(
                f"{path}: {path.stat().st_size} bytes are over the limit of {MAX_YAML_BYTES} for a map's yaml"
            )
        lines = path.read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError:
        raise MissionError(f"{path}: not a text file in UTF-8") from None
    except OSError as error:
        raise MissionError(f"{path}: cannot be read: {error.strerror}") from None
    values: dict[str, tuple[str, int]] = {}
    last = ""
    for number, raw in enumerate(lines, 1):
        line = re.sub(r"(^|\s)#.*$", "", raw).rstrip()
        if not line.strip() or line.strip() in ("---", "..."):
            continue
        dash, pair = re.fullmatch(r"\s*-\s+(\S+)", line), re.fullmatch(r"(\w+)\s*:\s*(.*)", line)
        if dash and last:
            values[last] = (f"{values[last][0]},{dash[1]}".lstrip(","), values[last][1])
        elif pair:
            last = pair[1]
            values[last] = (pair[2].strip().strip("'\""), number)
        else:
            raise MissionError(f"{path}: line {number}: '{line.strip()[:60]}' is not of the form 'key: value'")
    for key in KEYS:
        if key not in values:
            raise MissionError(f"{path}: '{key}' is missing; a ROS map needs {', '.join(KEYS)}")
    mode = values.get("mode", ("trinary", 0))[0]
    if mode not in ("trinary", "scale"):
        raise MissionError(f"{path}: line {values['mode'][1]}: mode = '{mode}' must be trinary or scale")
    origin = _numbers(values, "origin", path, 3)
    header = MapHeader(
        image=path.parent / values["image"][0],
        resolution_m=_numbers(values, "resolution", path, 1)[0],
        origin=(origin[0], origin[1], origin[2]),
        negate=_flag(values, path),
        occupied_thresh=_numbers(values, "occupied_thresh", path, 1)[0],
        free_thresh=_numbers(values, "free_thresh", path, 1)[0],
    )
    if not 0.001 <= header.resolution_m <= 10.0:
        where = f"{path}: line {values['resolution'][1]}"
        raise MissionError(f"{where}: resolution = {header.resolution_m:g} is outside [0.001, 10] m")
    if not 0.0 <= header.free_thresh < header.occupied_thresh <= 1.0:
        thresholds = f"free_thresh = {header.free_thresh:g} and occupied_thresh = {header.occupied_thresh:g}"
        raise MissionError(f"{path}: {thresholds}: the first must lie below the second, both in [0, 1]")
    return header


def read_image(image: Path, path: Path) -> npt.NDArray[np.float64]:
    """Return the image's brightness in [0, 1], (rows, columns)."""
    where = f"{path}: image '{image.name}'"
    if not is_file(image):
        raise MissionError(f"{where} does not exist in '{image.parent}'; put it there or correct the yaml")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # the limit below is stricter
            with Image.open(image) as picture:
                if picture.width * picture.height > MAX_PIXELS:
                    raise MissionError(
                        f"{where} has {picture.width} x {picture.height} pixels, over the limit of {MAX_PIXELS}"
                    )
                deep = picture.mode.startswith("I")
                pixels = np.asarray(picture if deep else picture.convert("L"), dtype=np.float64)
    except UnidentifiedImageError:
        raise MissionError(f"{where} is no image that can be read; PGM and PNG can") from None
    except Image.DecompressionBombError:
        raise MissionError(f"{where} has over {MAX_PIXELS} pixels; cut it or scale it down") from None
    except (OSError, ValueError, SyntaxError, EOFError) as error:
        raise MissionError(f"{where} is truncated or damaged ({error})") from None
    return pixels / (65535.0 if deep else 255.0)


def free_cells(brightness: npt.NDArray[np.float64], header: MapHeader) -> npt.NDArray[np.bool_]:
    """Return which cells are free: their probability of being occupied is at most free_thresh."""
    occupied = brightness if header.negate else 1.0 - brightness
    return np.asarray(occupied <= header.free_thresh)


def _numbers(values: dict[str, tuple[str, int]], key: str, path: Path, count: int) -> list[float]:
    text, line = values[key]
    try:
        numbers = [float(part) for part in text.strip("[] ").split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(isfinite(n) for n in numbers):
        form = "a number" if count == 1 else "[x, y, heading]"
        raise MissionError(f"{path}: line {line}: {key} = '{text}' must be {form}")
    return numbers


def _flag(values: dict[str, tuple[str, int]], path: Path) -> bool:
    text, line = values["negate"]
    if text.lower() not in ("0", "1", "true", "false"):
        raise MissionError(f"{path}: line {line}: negate = '{text}' must be 0 or 1")
    return text.lower() in ("1", "true")
