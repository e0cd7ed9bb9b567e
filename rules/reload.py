"""A changed program takes over from the one that ran: with its facts, and without firing again what has fired.

Rules that are as they were keep their history: what they have fired on, they do not fire on again. Rules that are new or
changed look at all facts afresh. Deffacts that are new are asserted; globals keep their values unless their definition changed.
"""

from collections import Counter

from rules.engines.engine import Engine
from rules.language.values import FactValue
from rules.language.writing import expression_text, rule_text
from rules.working_memory import WorkingMemory


def take_over(memory: WorkingMemory, engine: Engine) -> WorkingMemory:
    """Return the working memory of another engine that goes on where `memory`'s engine stands.

    Raises RuleError where a fact does not fit the templates of the engine's program; nothing has changed then.
    """
    old = memory.engine
    engine.reset()
    for index in list(engine.facts()):
        engine.retract(index)
    moved, indices = memory.move_to(engine)
    _keep_globals(old, engine)
    waiting = Counter(
        (activation.rule, tuple(None if f is None else indices.get(f) for f in activation.facts))
        for activation in old.agenda()
    )
    before = {rule.name: rule_text(rule) for rule in old.program.rules}
    unchanged = {rule.name for rule in engine.program.rules if before.get(rule.name) == rule_text(rule)}
    known = set(indices.values())
    for activation in list(engine.agenda()):
        if activation.rule not in unchanged or not all(f is None or f in known for f in activation.facts):
            continue
        name = (activation.rule, activation.facts)
        if waiting[name]:
            waiting[name] -= 1
        else:
            engine.drop(activation)
    for fact in new_deffacts(old, engine):
        engine.assert_fact(fact)
    return moved


def new_deffacts(old: Engine, new: Engine) -> list[FactValue]:
    """Return the facts of the new program's deffacts that the old one's did not have."""
    known = {fact.key for fact in old.initial_facts()}
    return [fact for fact in new.initial_facts() if fact.key not in known]


def _keep_globals(old: Engine, new: Engine) -> None:
    values = old.globals()
    before = {g.name: g.value for g in old.program.globals}
    for g in new.program.globals:
        if g.name in values and expression_text(before[g.name]) == expression_text(g.value):
            new.set_global(g.name, values[g.name])
