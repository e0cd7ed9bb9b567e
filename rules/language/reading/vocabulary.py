"""The words of the language: which functions and actions there are, and what to use instead of what there is not."""

from rules.language.functions import FUNCTIONS, STOP_EARLY

BOARD_ACTIONS = {
    "behaviour-select": (2, None),
    "behavior-select": (2, None),
    "motivate": (1, None),
    "post": (1, None),
    "retract-entry": (1, 1),
    "set-gain": (2, 2),
    "set-threshold": (2, 2),
    "focus": (2, 2),
}
"""Actions on the board, with the least and the largest number of their arguments."""

SPELT = {"behavior-select": "behaviour-select"}
CONDITION_WORDS = ("and", "or", "not", "exists", "forall", "logical", "test", "object", "declare")
FACT_ACTIONS = ("assert", "retract", "modify", "bind", "if")
OTHER_ACTIONS = {"halt": (0, 0), "printout": (1, None)}
RIGHT_HAND_ONLY = {"now": (0, 0)}

_LOOPS = "rules repeat by matching facts: assert a counter or write a recursive deffunction"
_COOL = "there are no objects: use deftemplate"
_MODULES = "there are no modules: use salience, or a fact that names the phase"
_BOARD = "the mission does this"
_RANDOM = "it would make runs differ: rules decide by facts alone"
HINTS = {
    "while": _LOOPS, "loop-for-count": _LOOPS, "foreach": _LOOPS, "progn$": _LOOPS, "do-for-fact": _LOOPS,
    "do-for-all-facts": _LOOPS, "any-factp": "match the facts in a condition", "find-fact": "match the facts in a condition",
    "find-all-facts": "match the facts in a condition", "fact-slot-value": "match the slot in a condition: (slot ?x)",
    "fact-index": "an index means nothing to the robot: match a slot", "progn": "write the actions one after the other",
    "return": "a deffunction returns its last expression", "break": _LOOPS, "switch": "use if ... then ... else",
    "duplicate": "assert a new fact", "undefrule": "rules cannot change rules", "build": "rules cannot change rules",
    "eval": "rules cannot change rules", "load": _BOARD, "batch": _BOARD, "run": _BOARD, "reset": _BOARD, "clear": _BOARD,
    "facts": _BOARD, "rules": _BOARD, "agenda": _BOARD, "watch": _BOARD, "open": _BOARD, "close": _BOARD, "read": _BOARD,
    "readline": _BOARD, "system": _BOARD, "exit": "use (halt)", "time": "use (now), on the right-hand side",
    "random": _RANDOM, "seed": _RANDOM, "gensym": _RANDOM, "gensym*": _RANDOM, "setgen": _RANDOM,
    "format": "put the text together with str-cat", "pow": "use **", "sort": "let salience or a condition choose",
    "expand$": "a multifield's values are spread in facts anyway", "assert-string": "use assert", "str-assert": "use assert",
    "send": _COOL, "make-instance": _COOL, "defclass": _COOL, "definstances": _COOL, "defmessage-handler": _COOL,
    "defgeneric": "use deffunction", "defmethod": "use deffunction", "defmodule": _MODULES,
    "eval-string": "rules cannot change rules", "set-strategy": "the strategy is depth; use salience",
    "refresh": "assert the fact anew", "pop-focus": _MODULES, "get-focus": _MODULES, "set-current-module": _MODULES,
    "not=": "use <> for numbers, neq for all else", "!=": "use <> for numbers, neq for all else",
    "==": "use = for numbers, eq for all else",
    "xor": "use neq", "print": "use (printout t ... crlf)", "println": "use (printout t ... crlf)",
}  # fmt: skip
"""What CLIPS or a habit of writing has and the language has not, with what to do instead."""


def hint(name: str) -> str:
    """Return `; what to do instead` for a word that is not in the language, or nothing."""
    return f": {HINTS[name]}" if name in HINTS else ""


ARITIES: dict[str, tuple[int, int | None]] = {
    **{name: (function.least, function.most) for name, function in FUNCTIONS.items()},
    **STOP_EARLY,
    **BOARD_ACTIONS,
    **OTHER_ACTIONS,
    **RIGHT_HAND_ONLY,
}
"""The numbers of arguments of all functions that expressions of a right-hand side may call, but those of the files."""
