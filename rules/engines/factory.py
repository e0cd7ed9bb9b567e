"""Engines by name."""

from collections.abc import Mapping

from blackboard.errors import did_you_mean
from rules.engines.engine import Engine, External
from rules.language.errors import RuleError
from rules.language.syntax import Program

ENGINES = ("experta", "clips")


def make_engine(name: str, program: Program, externals: Mapping[str, External] | None = None) -> Engine:
    """Return the engine of this name with a program; raise RuleError where there is none, or it is not installed."""
    if name == "experta":
        from rules.engines.experta_engine import ExpertaEngine  # takes a moment to load: not before it is asked for

        return ExpertaEngine(program, externals)
    if name == "clips":
        try:
            from rules.engines.clips_engine import ClipsEngine
        except ModuleNotFoundError as error:
            if error.name is None or error.name.partition(".")[0] != "clips":
                raise
            install = 'pip install "sensory-knowledge-integrator[clips]"'
            raise RuleError(f"the rule engine 'clips' is not installed: {install}, or use 'experta'") from None
        return ClipsEngine(program, externals)
    raise RuleError(f"there is no rule engine '{name}'{did_you_mean(name, ENGINES)}")
