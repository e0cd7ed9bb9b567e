"""A planning module after a restart: its rules go on where they were.

What rules asserted stands on the board, to the last firing. What they have fired on, and which facts they have before them, is in
the kept state, which may be a little older. So first the rules go on from that; then facts and entries are brought up to date by
the board, and what a firing since then has fired on is not fired on again, but for the newest: nobody knows whether that was done
to its end, and once too often is better than never.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from blackboard.access import Access
from blackboard.entry import Entry
from blackboard.errors import SkiError
from blackboard.kinds import FACT, FIRING
from blackboard.messages.control import Fact, RuleFiles
from blackboard.vocabulary import Vocabulary
from rules.board_actions import ActionsState
from rules.engines.engine import Engine
from rules.explaining.record import read_rules
from rules.language.values import FactValue
from rules.remembered import Remembered, emptied, go_on
from rules.shown_facts import shown
from rules.working_memory import WorkingMemory


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannerState:
    """What of a planning module outlives its process."""

    remembered: Remembered
    actions: ActionsState
    fired: int
    told_s: float
    looked_s: float


def resumed(
    known: Remembered | None, engine: Engine, vocabulary: Vocabulary, files: RuleFiles, board: Access
) -> tuple[WorkingMemory, list[str]]:
    """Return the working memory with which an engine goes on, and the facts that could not be read back.

    Raises RuleError where what is remembered does not fit the program.
    """
    memory = WorkingMemory(emptied(engine), vocabulary)
    indices = go_on(known, engine, memory) if known is not None else {}
    lost = _facts_as_shown(known, indices, memory, files, vocabulary, board)
    standing = [entry for kind in memory.kinds for entry in board.entries(kind)]
    memory.forget_all_but({entry.key for entry in standing})
    for entry in standing:
        memory.take(entry)
    return memory, lost


def drop_fired(engine: Engine, board: Access, after: int) -> None:
    """Take off the agenda what the firings above a number have fired on, but for the newest."""
    firings = sorted((entry.value for entry in board.entries(FIRING)), key=lambda firing: firing.number)
    done = {(firing.rule, firing.facts) for firing in firings[:-1] if firing.number > after}
    for activation in list(engine.agenda()):
        matched = tuple(shown(engine.fact(index)) if index is not None else "" for index in activation.facts)
        if (activation.rule, matched) in done:
            engine.drop(activation)


def _facts_as_shown(
    known: Remembered | None,
    indices: dict[int, int],
    memory: WorkingMemory,
    files: RuleFiles,
    vocabulary: Vocabulary,
    board: Access,
) -> list[str]:
    """Make the facts that stand by rules' doing those that are shown on the board; return those that cannot be read."""
    standing = {int(str(entry.id)): entry for entry in board.own(FACT)}
    for old, fact in _by_rules(known).items():
        entry = standing.get(old)
        if old not in indices:
            continue
        if entry is not None and entry.value.fact == shown(fact):
            memory.put_behind(indices[old], standing.pop(old).as_support())
        else:
            memory.engine.retract(indices.pop(old))
    order = sorted(standing)
    read, lost = _read([standing[old].value for old in order], files, vocabulary)
    for old, told in zip(order, read, strict=True):
        if told is None:
            continue
        index = memory.engine.assert_fact(told)
        if index is not None:
            memory.put_behind(index, standing[old].as_support())
    return lost


def _by_rules(known: Remembered | None) -> Mapping[int, FactValue]:
    if known is None:
        return {}
    record = known.memory
    others = {record.clock, *(index for _, _, index in record.held.values())}
    return {index: fact for index, fact in record.facts.items() if index not in others}


def _read(facts: Sequence[Fact], files: RuleFiles, vocabulary: Vocabulary) -> tuple[list[FactValue | None], list[str]]:
    """Return facts from their texts, None for one that cannot be read, and the texts of those."""

    def values(some: Iterable[Fact]) -> list[FactValue] | None:
        try:
            _, found, unread = read_rules(files, some, vocabulary)
        except SkiError:
            return None
        return None if unread else found

    together = values(facts)
    if together is not None:
        return [*together], []
    each = [found[0] if (found := values([fact])) else None for fact in facts]
    return each, [fact.fact for fact, found in zip(facts, each, strict=True) if found is None]


def newest_number(entries: Iterable[Entry[Any]]) -> int:
    """Return the highest number that the values of entries bear, 0 where there are none."""
    return max((entry.value.number for entry in entries), default=0)
