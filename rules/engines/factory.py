"""Engines by name."""

from collections.abc import Mapping

from blackboard.errors import did_you_mean
from rules.engines.engine import Engine, External
from rules.language.errors import RuleError
from rules.language.syntax import Program

ENGINES = ("experta", "clips")


def make_engine(name: str, program: Program, externals: Mapping[str, External] | None = None) -> Engine:
    """Return the engine of this name with a program; raise RuleError where there is none, or it is not installed."""
    if name not in ENGINES:
        raise RuleError(f"there is no rule engine '{name}'{did_you_mean(name, ENGINES)}")
    from rules.engines.experta_engine import ExpertaEngine  # takes a moment to load: not before it is asked for

    return ExpertaEngine(program, externals)
