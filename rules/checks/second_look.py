"""A second look by CLIPS itself where it is installed: it refuses some rules that can never match, and cannot run a few others."""

from collections.abc import Iterator
from importlib.util import find_spec

from rules.checks.finding import Finding
from rules.engines.factory import make_engine
from rules.language.errors import RuleError
from rules.language.reading.vocabulary import BOARD_ACTIONS, RIGHT_HAND_ONLY
from rules.language.syntax import Program


def second_look(program: Program) -> Iterator[Finding]:
    """Yield what CLIPS refuses first, or nothing where it is not installed."""
    if find_spec("clips") is None:
        return
    try:
        engine = make_engine("clips", program, dict.fromkeys((*BOARD_ACTIONS, *RIGHT_HAND_ONLY), lambda *values: None))
    except RuleError as error:
        text = str(error).removeprefix(f"{error.position}: ").removeprefix("CLIPS refuses this: ")
        yield Finding(f"the engine 'clips' cannot run this: {text}", error.position)
    else:
        engine.close()
