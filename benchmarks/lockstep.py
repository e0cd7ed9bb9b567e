"""experta and CLIPS in lockstep on random programs: after every change both have the same facts and the same agenda.

python benchmarks/lockstep.py [--programs N] [--first SEED]

CLIPS chooses what fires; the same activation then fires in experta. Compared are the agendas as multisets of rules and the facts
that they matched, working memory with its indices, the globals, what was printed and whether the actions failed.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields
from random import Random
from time import perf_counter

from random_facts import FactMaker
from random_programs import Writer

from rules.engines.clips_engine import ClipsEngine
from rules.engines.engine import Activation, Engine, External, Firing
from rules.engines.experta_engine import ExpertaEngine
from rules.language.errors import RuleError
from rules.language.reader import read_text
from rules.language.reading.vocabulary import BOARD_ACTIONS
from rules.language.syntax import Program
from rules.language.values import FactValue, Value, written

MOST_FIRINGS = 15  # after each change from outside
CHANGES = 8  # from outside
TYPE_CODES = ("[RULECSTR1]", "[RULECSTR2]", "[RULECSTR3]")


@dataclass(slots=True)
class Tally:
    """What a program made of itself."""

    firings: int = 0
    first: int = 0  # firings of what experta by itself would have fired
    changes: int = 0
    failed_actions: int = 0
    activations: int = 0
    fired: list[str] = field(default_factory=list)  # rules
    refused: int = 0  # by CLIPS, which sees that a variable can never be a number where one is asked for

    def add(self, other: "Tally") -> None:
        for one in fields(self):
            setattr(self, one.name, getattr(self, one.name) + getattr(other, one.name))


class Pair:
    """One program on both engines."""

    def __init__(self, program: Program) -> None:
        self.called: tuple[list[str], list[str]] = ([], [])  # what board actions were asked for
        self.clips = ClipsEngine(program, _board_actions(self.called[0]))
        self.experta = ExpertaEngine(program, _board_actions(self.called[1]))
        self.tally = Tally()

    def reset(self) -> str | None:
        self.clips.reset()
        self.experta.reset()
        return self.difference()

    def difference(self) -> str | None:
        """Return how the two differ, in a few lines; None where they do not."""
        facts = [{index: fact.key for index, fact in engine.facts().items()} for engine in (self.clips, self.experta)]
        if facts[0] != facts[1]:
            return f"facts\n  CLIPS   {_facts(self.clips)}\n  experta {_facts(self.experta)}"
        agendas = [_multiset(engine.agenda()) for engine in (self.clips, self.experta)]
        self.tally.activations += len(agendas[0])
        if agendas[0] != agendas[1]:
            less = [one for one in agendas[0] if one not in agendas[1]]
            more = [one for one in agendas[1] if one not in agendas[0]]
            return f"agenda of {len(agendas[0])}: experta lacks {less} and has {more} too\n  {_facts(self.clips)}"
        if self.called[0] != self.called[1]:
            return f"board actions: {self.called[0]} in CLIPS, {self.called[1]} in experta"
        values = [
            {name: repr(value) for name, value in engine.globals().items()} for engine in (self.clips, self.experta)
        ]
        return None if values[0] == values[1] else f"globals: {values[0]} in CLIPS, {values[1]} in experta"

    def assert_fact(self, fact: FactValue) -> str | None:
        self.tally.changes += 1
        indices = [engine.assert_fact(fact) for engine in (self.clips, self.experta)]
        return self.difference() if indices[0] == indices[1] else f"{fact} has the indices {indices}"

    def retract(self, index: int) -> str | None:
        self.tally.changes += 1
        self.clips.retract(index)
        self.experta.retract(index)
        return self.difference()

    def fire(self) -> tuple[bool, str | None]:
        """Fire what CLIPS would; say whether anything fired, and how the two differ."""
        fired = self.clips.fire()
        if fired is None:
            return False, None
        self.tally.firings += 1
        self.tally.fired.append(fired.activation.rule)
        waiting = self.experta.agenda()
        same = next((one for one in waiting if _shape(one) == _shape(fired.activation)), None)
        if same is None:
            return True, f"{fired.activation} does not fire in experta"
        self.tally.first += same == waiting[0]
        other = self.experta.fire(same)
        assert other is not None
        self.tally.failed_actions += fired.error is not None
        return True, _unlike(fired, other) or self.difference()

    def close(self) -> None:
        self.clips.close()
        self.experta.close()


def _board_actions(called: list[str]) -> dict[str, External]:
    """Return functions in the place of those of a planning module: they take note that they were called."""

    def named(name: str) -> External:
        def call(*arguments: Value) -> Value:
            called.append(f"({name} {' '.join(map(written, arguments))})")
            return len(called) * 0.5

        return call

    return {name: named(name) for name in (*BOARD_ACTIONS, "now")}


def _shape(activation: Activation) -> tuple[str, tuple[int, ...], int]:
    return activation.rule, tuple(one for one in activation.facts if one is not None), activation.salience


def _multiset(agenda: Sequence[Activation]) -> list[tuple[str, tuple[int, ...], int]]:
    return sorted(map(_shape, agenda))


def _facts(engine: Engine) -> str:
    return " ".join(f"f-{index}{fact}" for index, fact in engine.facts().items())


def _unlike(clips: Firing, experta: Firing) -> str | None:
    if clips.printed != experta.printed:
        return f"{clips.activation} prints {clips.printed!r} in CLIPS, {experta.printed!r} in experta"
    if (clips.error is None) is not (experta.error is None):
        return f"{clips.activation} fails with {clips.error!r} in CLIPS, {experta.error!r} in experta"
    changes = [[(one.index, one.fact.key, one.asserted) for one in firing.changes] for firing in (clips, experta)]
    return (
        None
        if changes[0] == changes[1]
        else f"{clips.activation} changes {changes[0]} in CLIPS, {changes[1]} in experta"
    )


def drive(pair: Pair, random: Random, facts: Iterator[FactValue], changes: int = CHANGES) -> str | None:
    """Change working memory from outside and let rules fire in between; return the first difference."""
    fault = pair.reset()
    for _ in range(changes):
        for _ in range(MOST_FIRINGS):
            if fault is not None:
                return fault
            fired, fault = pair.fire()
            if not fired:
                break
        if fault is not None:
            return fault
        standing = list(pair.clips.facts())
        if standing and random.random() < 0.3:
            fault = pair.retract(random.choice(standing))
        else:
            for _ in range(random.randint(1, 3)):
                fault = fault or pair.assert_fact(next(facts))
    return fault


def lockstep(seed: int) -> tuple[Tally, str | None]:
    """Run the program of a seed on both engines; return what happened and the first difference."""
    writer = Writer(seed)
    text = writer.program()
    try:
        pair = Pair(read_text(text, f"program {seed}"))
    except RuleError as refusal:
        if any(code in str(refusal) for code in TYPE_CODES):
            return Tally(refused=1), None
        return Tally(), f"refused: {refusal}\n{text}"

    try:
        fault = drive(pair, writer.random, iter(writer.fact, None))
        return pair.tally, fault if fault is None else f"{fault}\n{text}"
    finally:
        pair.close()


def lockstep_of(program: Program, seed: int, changes: int = 60) -> tuple[Tally, str | None]:
    """Run a program on both engines, fed with facts that its rules look at; return what happened and the first difference."""
    random = Random(seed)
    pair = Pair(program)
    try:
        fault = drive(pair, random, FactMaker(program, random).facts(), changes)
        return pair.tally, fault
    finally:
        pair.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("--show", type=int, default=3, help="how many differences to print")
    options = parser.parse_args()
    started = perf_counter()
    total, faults = Tally(), []
    for seed in range(options.first, options.first + options.programs):
        tally, fault = lockstep(seed)
        total.add(tally)
        if fault is not None:
            faults.append((seed, fault))
    print(f"programs                      {options.programs}, of which CLIPS refuses {total.refused}")
    print(f"changes from outside          {total.changes}")
    print(f"firings                       {total.firings}, of which {total.failed_actions} with actions that fail")
    print(f"of them next in experta too   {total.first}")
    print(f"activations compared          {total.activations}")
    print(f"programs with a difference    {len(faults)}")
    print(f"took {perf_counter() - started:.0f} s", file=sys.stderr)
    for seed, fault in faults[: options.show]:
        print(f"\nseed {seed}: {fault}")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
