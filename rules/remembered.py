"""What an engine and its working memory know, frozen: another engine goes on from it, after a restart or with changed rules."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from rules.engines.engine import Engine
from rules.language.values import Value
from rules.language.writing import expression_text, rule_text
from rules.working_memory import MemoryRecord, WorkingMemory


@dataclass(frozen=True, slots=True, kw_only=True)
class Remembered:
    """Facts with what stands behind them, which activations wait (all others have fired), and the program in texts."""

    memory: MemoryRecord
    waiting: tuple[tuple[str, tuple[int | None, ...]], ...]
    globals_: Mapping[str, Value]
    rules: Mapping[str, str]  # by name, as they are written
    definitions: Mapping[str, str]  # of globals, by name
    initial: frozenset[tuple[object, ...]]  # keys of the deffacts


def remembered(memory: WorkingMemory) -> Remembered:
    """Return what a working memory and its engine know now."""
    engine = memory.engine
    return Remembered(
        memory=memory.record(),
        waiting=tuple((activation.rule, activation.facts) for activation in engine.agenda()),
        globals_=engine.globals(),
        rules={rule.name: rule_text(rule) for rule in engine.program.rules},
        definitions={one.name: expression_text(one.value) for one in engine.program.globals},
        initial=frozenset(fact.key for fact in engine.initial_facts()),
    )


def go_on(known: Remembered, engine: Engine, memory: WorkingMemory) -> dict[int, int]:
    """Let an engine and its empty working memory go on from there; return the new index of each fact by the old one.

    Rules that are as they were do not fire on what they have fired on, others look at all facts afresh. Deffacts that are new are
    asserted; globals keep their values unless their definition changed. Raises RuleError where a fact does not fit the program.
    """
    indices = memory.restore(known.memory)
    for one in engine.program.globals:
        if known.definitions.get(one.name) == expression_text(one.value):
            engine.set_global(one.name, known.globals_[one.name])
    waiting = Counter(
        (rule, tuple(None if f is None else indices.get(f) for f in facts)) for rule, facts in known.waiting
    )
    unchanged = {rule.name for rule in engine.program.rules if known.rules.get(rule.name) == rule_text(rule)}
    facts = set(indices.values())
    for activation in list(engine.agenda()):
        if activation.rule not in unchanged or not all(f is None or f in facts for f in activation.facts):
            continue
        name = (activation.rule, activation.facts)
        if waiting[name]:
            waiting[name] -= 1
        else:
            engine.drop(activation)
    for fact in engine.initial_facts():
        if fact.key not in known.initial:
            engine.assert_fact(fact)
    return indices


def emptied(engine: Engine) -> Engine:
    """Reset an engine, and take its deffacts out again."""
    engine.reset()
    for index in list(engine.facts()):
        engine.retract(index)
    return engine
