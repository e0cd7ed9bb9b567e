"""Which colour stands for which role in pictures of a board's graph."""

from blackboard.report import palette
from blackboard.watching.board_graph import Role

ROLE_COLOURS: dict[Role, palette.Colour] = {
    "robot": palette.INK,
    "knowledge source": palette.BEHAVIOUR_COLOURS[0],
    "rules": palette.LINE_COLOUR,
    "behaviour": palette.TARGET_COLOUR,
    "coordinator": palette.CORNER_COLOUR,
    "safety layer": palette.BEHAVIOUR_COLOURS[1],
    "control": palette.FAINT_INK,
    "keeper": palette.FAINT_INK,
}
