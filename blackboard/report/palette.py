"""The colours of all pictures: a cool grey map, blue for the path, orange for lines; told apart without seeing hues."""

import numpy as np
import numpy.typing as npt

Colour = tuple[int, int, int]

PAPER: Colour = (255, 255, 255)
INK: Colour = (31, 41, 55)
FAINT_INK: Colour = (107, 114, 128)
EMPTY_COLOUR: Colour = (255, 255, 255)
UNKNOWN_COLOUR: Colour = (218, 223, 229)
OCCUPIED_COLOUR: Colour = (38, 48, 61)
LINE_COLOUR: Colour = (213, 94, 0)  # vermilion of Okabe and Ito (2008)
PATH_COLOURS: tuple[Colour, ...] = ((134, 197, 238), (0, 114, 178), (20, 28, 84))  # from first to last pose
CORNER_COLOUR: Colour = (204, 121, 167)  # reddish purple of Okabe and Ito
TARGET_COLOUR: Colour = (0, 158, 115)  # bluish green
ROBOT_COLOUR: Colour = (240, 196, 25)
SECOND_LINE_COLOUR: Colour = (0, 114, 178)  # of a second set beside the first
BEHAVIOUR_COLOURS: tuple[Colour, ...] = (  # Okabe and Ito, the easiest to tell apart first
    (0, 114, 178),
    (230, 159, 0),
    (0, 158, 115),
    (204, 121, 167),
    (86, 180, 233),
    (213, 94, 0),
    (120, 94, 240),
)
EMPTY_GREY, UNKNOWN_GREY, OCCUPIED_GREY = 254, 205, 20


def rgb(colour: Colour) -> tuple[float, float, float]:
    """Return a colour as matplotlib takes it, 0 to 1."""
    return (colour[0] / 255, colour[1] / 255, colour[2] / 255)


def grey_levels() -> npt.NDArray[np.uint8]:
    """Return the grey of each of the 256 cell values: light for empty, a little darker for unknown, near black for occupied."""
    return _ramp((EMPTY_GREY,), (UNKNOWN_GREY,), (OCCUPIED_GREY,))[:, 0]


def cell_colours() -> npt.NDArray[np.uint8]:
    """Return the colour of each of the 256 cell values, (256, 3)."""
    return _ramp(EMPTY_COLOUR, UNKNOWN_COLOUR, OCCUPIED_COLOUR)


def path_colours(fractions: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the colours (n, 3), 0 to 1, of the path at these fractions (0 to 1) of the run."""
    anchors = np.linspace(0.0, 1.0, len(PATH_COLOURS))
    channels = [np.interp(fractions, anchors, [c[i] for c in PATH_COLOURS]) for i in range(3)]
    return np.stack(channels, axis=-1) / 255.0


def _ramp(empty: tuple[int, ...], unknown: tuple[int, ...], occupied: tuple[int, ...]) -> npt.NDArray[np.uint8]:
    values = np.arange(256)
    channels = [np.interp(values, (0, 128, 255), stops) for stops in zip(empty, unknown, occupied, strict=True)]
    return np.rint(np.stack(channels, axis=-1)).astype(np.uint8)
