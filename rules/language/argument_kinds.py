"""Which kinds of values functions take, so that a constant which can never do is refused when it is read, as CLIPS does."""

from rules.language.library.arithmetic import ARITHMETIC
from rules.language.library.function import kind
from rules.language.library.trigonometry import TRIGONOMETRY
from rules.language.values import Symbol, Value

Kinds = tuple[type, ...]

NUMBER: Kinds = (int, float)
INTEGER: Kinds = (int,)
LEXEME: Kinds = (Symbol, str)
ROW: Kinds = (tuple,)
ANY: Kinds = ()
NAMES: dict[Kinds, str] = {
    NUMBER: "a number",
    INTEGER: "an integer",
    LEXEME: "a symbol or a string",
    ROW: "a multifield",
}

TAKES: dict[str, tuple[Kinds, ...]] = {
    **dict.fromkeys(ARITHMETIC, (NUMBER,)),
    **dict.fromkeys(TRIGONOMETRY, (NUMBER,)),
    **dict.fromkeys(("=", "<>", "<", ">", "<=", ">="), (NUMBER,)),
    **dict.fromkeys(("evenp", "oddp"), (INTEGER,)),
    **dict.fromkeys(("str-length", "str-index", "upcase", "lowcase", "str-replace"), (LEXEME,)),
    "sub-string": (INTEGER, INTEGER, LEXEME),
    "str-compare": (LEXEME, LEXEME, INTEGER),
    "nth$": (INTEGER, ROW),
    "member$": (ANY, ROW),
    "subseq$": (ROW, INTEGER, INTEGER),
    "delete$": (ROW, INTEGER, INTEGER),
    "replace$": (ROW, INTEGER, INTEGER, ANY),
    "insert$": (ROW, INTEGER, ANY),
    "delete-member$": (ROW, ANY),
    **dict.fromkeys(("subsetp", "union$", "intersection$", "difference$", "length$", "first$", "rest$"), (ROW,)),
}
"""By function: the kinds of each argument; those of the last hold for all that follow. What is not here takes anything."""


def unfit(function: str, index: int, value: Value) -> str | None:
    """Return what is wrong with a constant as an argument (counted from 0), or None."""
    kinds = TAKES.get(function, (ANY,))
    wanted = kinds[min(index, len(kinds) - 1)]
    if wanted == ANY or isinstance(value, wanted):
        return None
    return f"({function} ...) takes {NAMES[wanted]} here, not {kind(value)}"
