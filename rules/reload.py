"""A changed program takes over from the one that ran: with its facts, and without firing again what has fired."""

from blackboard.vocabulary import Vocabulary
from rules.engines.engine import Engine
from rules.remembered import emptied, go_on, remembered
from rules.working_memory import WorkingMemory


def take_over(memory: WorkingMemory, engine: Engine, vocabulary: Vocabulary) -> WorkingMemory:
    """Return the working memory of another engine that goes on where `memory`'s engine stands.

    Raises RuleError where a fact does not fit the templates of the engine's program; nothing has changed then.
    """
    moved = WorkingMemory(emptied(engine), vocabulary)
    go_on(remembered(memory), engine, moved)
    return moved
