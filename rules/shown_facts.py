"""The facts that stand by rules' doing, shown on the board: control/fact/<index>, on the firing or the files behind each."""

from collections.abc import Iterable, Mapping, Sequence

from blackboard.access import Access
from blackboard.entry import Entry, Support
from blackboard.kinds import FACT
from blackboard.messages.control import Fact, Firing, RuleFiles
from rules.engines.engine import FactChange
from rules.language.values import FactValue
from rules.working_memory import WorkingMemory

MOST = 4000  # letters of a fact that are shown


def shown(fact: FactValue | None) -> str:
    """Return a fact as it is shown; nothing for a condition that matches no one fact."""
    return "" if fact is None else str(fact)[:MOST]


def show(board: Access, index: int, fact: FactValue, supports: Sequence[Support | Entry[RuleFiles]]) -> Support:
    """Post a fact."""
    value = Fact(relation=fact.relation, fact=shown(fact))
    return board.post(FACT, value, id=str(index), supports=supports).as_support()


def show_deffacts(board: Access, memory: WorkingMemory, rules: Entry[RuleFiles]) -> None:
    """Show the facts with which rules begin."""
    for index, fact in memory.engine.facts().items():
        memory.put_behind(index, show(board, index, fact, (rules,)))


def show_anew(board: Access, memory: WorkingMemory, rules: Entry[RuleFiles]) -> None:
    """Show what stands by rules' doing under its new indices, and take away what else is shown."""
    standing = {str(entry.id): entry for entry in board.entries(FACT)}
    wanted = {str(index): fact for index, fact in memory.engine.facts().items() if memory.is_ours(index)}
    for index, fact in wanted.items():
        value = Fact(relation=fact.relation, fact=shown(fact))
        if index not in standing or standing[index].value != value:
            board.post(FACT, value, id=index, supports=[memory.support(int(index)) or rules])
    for index in standing:
        if index not in wanted:
            board.retract(FACT, index)


def show_changes(
    board: Access, memory: WorkingMemory, changes: Iterable[FactChange], firing: Entry[Firing]
) -> Mapping[int, Support]:
    """Show what a firing changed; return what then stands behind the facts that have come.

    First what has come: whoever is killed in between leaves a fact too many, and none too few.
    """
    behind: dict[int, Support] = {}
    gone = []
    for change in changes:
        if change.asserted:
            behind[change.index] = show(board, change.index, change.fact, (firing.as_support(),))
        else:
            gone.append(change.index)
    for index in gone:
        if index not in behind and memory.entry_of(index) is None and board.newest(FACT, str(index)) is not None:
            board.retract(FACT, str(index))
    return behind
