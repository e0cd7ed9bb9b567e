"""Which kinds of values functions take and return, so that what can never do is refused when it is read, as CLIPS does."""

from rules.language.library.arithmetic import ARITHMETIC
from rules.language.library.comparison import COMPARISON
from rules.language.library.function import kind
from rules.language.library.trigonometry import TRIGONOMETRY
from rules.language.syntax import Call, Constant, Expression
from rules.language.values import Symbol

Kinds = tuple[type, ...]

NUMBER: Kinds = (int, float)
INTEGER: Kinds = (int,)
LEXEME: Kinds = (Symbol, str)
ROW: Kinds = (tuple,)
ANY: Kinds = ()
SYMBOL: Kinds = (Symbol,)
STRING: Kinds = (str,)
FLOAT: Kinds = (float,)
SINGLE: Kinds = (Symbol, str, int, float)
NAMES: dict[Kinds, str] = {
    NUMBER: "a number",
    INTEGER: "an integer",
    LEXEME: "a symbol or a string",
    ROW: "a multifield",
    SINGLE: "one value",
}


TAKES: dict[str, tuple[Kinds, ...]] = {
    **dict.fromkeys(ARITHMETIC, (NUMBER,)),
    **dict.fromkeys(TRIGONOMETRY, (NUMBER,)),
    **dict.fromkeys(("=", "<>", "<", ">", "<=", ">="), (NUMBER,)),
    **dict.fromkeys(("evenp", "oddp"), (INTEGER,)),
    **dict.fromkeys(("str-length", "str-index", "upcase", "lowcase", "str-replace"), (LEXEME,)),
    **dict.fromkeys(("str-cat", "sym-cat"), (SINGLE,)),
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


GIVES: dict[str, Kinds] = {
    **dict.fromkeys(("+", "-", "*", "mod", "abs", "min", "max"), NUMBER),
    **dict.fromkeys(("div", "round", "integer", "str-length", "str-compare", "length$"), INTEGER),
    **dict.fromkeys(("/", "**", "float", *TRIGONOMETRY), FLOAT),
    **dict.fromkeys((*COMPARISON, "and", "or", "subsetp"), SYMBOL),
    **dict.fromkeys(("str-cat", "sub-string"), STRING),
    **dict.fromkeys(("upcase", "lowcase", "str-replace"), LEXEME),
    "sym-cat": SYMBOL,
    "str-index": (int, Symbol),
    **dict.fromkeys(("create$", "first$", "rest$", "subseq$", "delete$", "replace$", "insert$", "delete-member$"), ROW),
    **dict.fromkeys(("union$", "intersection$", "difference$"), ROW),
}
"""By function: the kinds of what it returns. What is not here may return anything."""


def kinds_of(expression: Expression) -> Kinds:
    """Return the kinds that a value can have, ANY where nothing is known."""
    if isinstance(expression, Constant):
        return (type(expression.value),)
    return GIVES.get(expression.function, ANY) if isinstance(expression, Call) else ANY


def unfit(function: str, index: int, argument: Expression, kinds: Kinds) -> str | None:
    """Return what is wrong with an argument (counted from 0) whose value is of these kinds, or None."""
    takes = TAKES.get(function, (ANY,))
    wanted = takes[min(index, len(takes) - 1)]
    if wanted == ANY or kinds == ANY or set(kinds) & set(wanted):
        return None
    if isinstance(argument, Constant):
        what = kind(argument.value)
    elif isinstance(argument, Call):
        what = f"what ({argument.function} ...) returns"
    else:
        what = "several ($?)" if kinds == ROW else "one field"
    return f"({function} ...) takes {NAMES[wanted]} here, not {what}"
