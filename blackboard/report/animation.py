"""The map growing over a run, as a small moving picture: `map.gif`.

Few colours and no dithering, so that what does not change between two pictures costs nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from math import cos, pi, sin
from pathlib import Path

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

from blackboard.messages.geometry import Pose
from blackboard.messages.world import Line
from blackboard.report import palette
from blackboard.report.result import GridView, Trajectory, driven_m, segments
from blackboard.report.view import View, colours_over, scale_bar_m, simplified, view_of

WIDTH_PX = 720
FOOT_PX = 40
EDGE_PX = 12
FINER = 2  # drawn this much larger, then reduced: smooth edges
SHAPE = (0.35, 0.9)  # height over width
SHADES = 9  # of grey for the cells; more would cost bytes in every frame
PATH_STEPS = 8  # colours along the path
LAST_FRAME_MS = 2500


@dataclass(frozen=True, kw_only=True)
class Frame:
    """The state of a run at one moment: a grid that no longer changes, the pose, and what came before."""

    stamp_s: float
    pose: Pose
    trajectory: Trajectory
    grid: GridView | None = None
    lines: Sequence[Line] = ()


def write_animation(frames: Sequence[Frame], radius_m: float, path: Path, frame_ms: int = 120) -> None:
    """Write the frames as a GIF that repeats for ever; all show the part of the map that the last one knows."""
    if not frames:
        return
    last = frames[-1]
    view = view_of(last.grid, last.trajectory, segments(last.lines), radius_m).widened(*SHAPE)
    pictures = [frame_picture(frame, frames[0].stamp_s, last.stamp_s, view, radius_m) for frame in frames]
    colours = _shared_colours()
    drawn = [picture.quantize(palette=colours, dither=Image.Dither.NONE) for picture in pictures]
    durations = [frame_ms] * (len(drawn) - 1) + [LAST_FRAME_MS]
    drawn[0].save(path, format="GIF", save_all=True, append_images=drawn[1:], duration=durations, loop=0, disposal=1)


def frame_picture(frame: Frame, start_s: float, end_s: float, view: View, radius_m: float) -> Image.Image:
    """Return one frame; the path's colours tell the time between `start_s` and `end_s`, as in the overview."""
    px_per_m = WIDTH_PX * FINER / view.width_m
    height_px = round(WIDTH_PX * view.height_m / view.width_m)
    size = (WIDTH_PX * FINER, (height_px + FOOT_PX) * FINER)
    picture = Image.new("RGB", size, palette.UNKNOWN_COLOUR)
    if frame.grid is not None:
        cells, covered = colours_over(frame.grid, view, _shades())
        if cells.size:
            left, right = (round((x - view.x_min_m) * px_per_m) for x in (covered.x_min_m, covered.x_max_m))
            top, bottom = (round((view.y_max_m - y) * px_per_m) for y in (covered.y_max_m, covered.y_min_m))
            box = (max(1, right - left), max(1, bottom - top))
            picture.paste(Image.fromarray(cells).resize(box, Image.Resampling.NEAREST), (left, top))
    draw = ImageDraw.Draw(picture)

    def pixels(points: npt.NDArray[np.float64]) -> list[tuple[float, float]]:
        x, y = (points[:, 0] - view.x_min_m) * px_per_m, (view.y_max_m - points[:, 1]) * px_per_m
        return list(zip(x.tolist(), y.tolist(), strict=True))

    _draw_path(draw, frame.trajectory, pixels(frame.trajectory[:, 1:3]), start_s, end_s)
    for ends in segments(frame.lines):
        draw.line(pixels(ends.reshape(2, 2)), fill=palette.PAPER, width=5 * FINER)
    for ends in segments(frame.lines):
        draw.line(pixels(ends.reshape(2, 2)), fill=palette.LINE_COLOUR, width=3 * FINER)
    (centre,) = pixels(np.array([[frame.pose.x_m, frame.pose.y_m]]))
    _draw_robot(draw, centre, frame.pose.heading_rad, radius_m * px_per_m)
    _draw_foot(draw, frame, start_s, end_s, px_per_m, height_px * FINER, view)
    return picture.resize((WIDTH_PX, height_px + FOOT_PX), Image.Resampling.BOX)


def _draw_path(
    draw: ImageDraw.ImageDraw, trajectory: Trajectory, points: list[tuple[float, float]], start_s: float, end_s: float
) -> None:
    kept = simplified(np.array(points).reshape(-1, 2), 3.0 * FINER).tolist()
    span_s = max(end_s - start_s, 1e-9)
    for a, b in pairwise(kept):
        fraction = np.floor((trajectory[b, 0] - start_s) / span_s * PATH_STEPS) / PATH_STEPS
        red, green, blue = np.rint(palette.path_colours(np.array([fraction]))[0] * 255).astype(int).tolist()
        draw.line([points[a], points[b]], fill=(red, green, blue), width=2 * FINER)


def _draw_robot(draw: ImageDraw.ImageDraw, centre: tuple[float, float], heading_rad: float, radius_px: float) -> None:
    x, y = centre
    radius_px = max(radius_px, 6.0 * FINER)
    draw.circle(centre, radius_px, fill=palette.ROBOT_COLOUR, outline=palette.INK, width=2 * FINER)
    turns, reach = (0.0, 2.5, pi, -2.5), (0.72, 0.68, 0.25, 0.68)
    corners = [
        (x + r * radius_px * cos(heading_rad + a), y - r * radius_px * sin(heading_rad + a))
        for a, r in zip(turns, reach, strict=True)
    ]
    draw.polygon(corners, fill=palette.INK)


def _draw_foot(
    draw: ImageDraw.ImageDraw, frame: Frame, start_s: float, end_s: float, px_per_m: float, top: int, view: View
) -> None:
    """Put time and distance on the left, a scale bar on the right, and how far the run is on the edge between."""
    width, middle = WIDTH_PX * FINER, top + (FOOT_PX * FINER) // 2
    draw.rectangle((0, top, width, top + FOOT_PX * FINER), fill=palette.PAPER)
    done = (frame.stamp_s - start_s) / max(end_s - start_s, 1e-9)
    draw.rectangle((0, top, round(width * done), top + 3 * FINER), fill=palette.PATH_COLOURS[1])
    text = f"{frame.stamp_s - start_s:.0f} s     {driven_m(frame.trajectory):.0f} m driven"
    draw.text((EDGE_PX * FINER, middle + 2 * FINER), text, font=_font(), fill=palette.INK, anchor="lm")
    length_m = scale_bar_m(view.width_m)
    right, y, tick = width - EDGE_PX * FINER, middle + 2 * FINER, 5 * FINER
    left = right - length_m * px_per_m
    for bar in ([(left, y), (right, y)], [(left, y - tick), (left, y + tick)], [(right, y - tick), (right, y + tick)]):
        draw.line(bar, fill=palette.INK, width=2 * FINER)
    draw.text((left - 8 * FINER, y), f"{length_m:g} m", font=_font(), fill=palette.INK, anchor="rm")


def _shades() -> npt.NDArray[np.uint8]:
    """Return the colours of the 256 cell values in SHADES steps, with unknown a step of its own."""
    values = np.arange(256)
    steps = np.rint(np.interp(values, (0, 128, 255), (0, SHADES // 2, SHADES - 1))).astype(int)
    stepped = np.rint(np.interp(steps, (0, SHADES // 2, SHADES - 1), (0, 128, 255))).astype(int)
    return np.asarray(palette.cell_colours()[stepped])


def _shared_colours() -> Image.Image:
    """Return the palette of all frames: every colour drawn with, and the mixtures that smooth edges are made of."""
    shades: list[palette.Colour] = [(r, g, b) for r, g, b in np.unique(_shades(), axis=0).tolist()]
    steps = np.rint(palette.path_colours(np.linspace(0.0, 1.0, PATH_STEPS + 1)) * 255).astype(int).tolist()
    path: list[palette.Colour] = [(r, g, b) for r, g, b in steps]
    grounds = (palette.PAPER, palette.UNKNOWN_COLOUR, palette.OCCUPIED_COLOUR)
    colours = [*shades, *path, palette.LINE_COLOUR, palette.ROBOT_COLOUR, palette.INK, palette.FAINT_INK, *grounds]
    colours += [_mixed(c, palette.PAPER, 0.5) for c in path]
    colours += [_mixed(palette.LINE_COLOUR, ground, f) for ground in grounds for f in (0.33, 0.67)]
    colours += [_mixed(palette.INK, c, f) for c in (palette.PAPER, palette.ROBOT_COLOUR) for f in (0.25, 0.5, 0.75)]
    holder = Image.new("P", (1, 1))
    holder.putpalette([channel for colour in dict.fromkeys(colours) for channel in colour])
    return holder


def _mixed(one: palette.Colour, other: palette.Colour, fraction: float) -> palette.Colour:
    red, green, blue = (round(fraction * a + (1 - fraction) * b) for a, b in zip(one, other, strict=True))
    return (red, green, blue)


@cache
def _font() -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(Path(mpl.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf", 15 * FINER)
