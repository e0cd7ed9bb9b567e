"""What a changed fact costs the rule engines: 100 rules shaped like those that come with the project, 500 facts.

python benchmarks/rule_engine.py [--rounds N] [--memory]

A change takes a fact out, puts another in its place and fires until nothing waits. CLIPS is asked through clipspy itself, as text.
The plan's own facts differ between the ten sets of ten rules; entries of the board are shared, so one change concerns many rules.
"""

import argparse
import gc
import os
from collections.abc import Callable, Iterable, Iterator
from itertools import count
from pathlib import Path
from statistics import median
from time import perf_counter

import clips

from rules.engines.engine import Engine
from rules.engines.factory import make_engine
from rules.language.reader import read_text
from rules.language.syntax import Program
from rules.language.values import FactValue, Symbol, Value
from rules.language.writing import written_constructs

TEMPLATES = """
(deftemplate travel (slot id) (slot state) (slot length-m) (slot stand-x-m) (slot stand-y-m))
(deftemplate target (slot id) (slot x-m) (slot y-m) (slot status))
(deftemplate behaviour (slot id) (slot acknowledged) (slot outcome) (slot state))
(deftemplate motivation (slot id) (slot number))
(deftemplate clock (slot time-s))
(defglobal ?*rest-s* = 30.0 ?*same-place-m* = 0.5)
(deffunction apart-m (?x1 ?y1 ?x2 ?y2) (sqrt (+ (** (- ?x1 ?x2) 2) (** (- ?y1 ?y2) 2))))
"""
SET = """
(deftemplate candidate-N (slot target) (slot length-m))
(deffacts start-N (mode-N choose) (goal-N t3) (given-up-N t5) (looked-from-N 40.0 40.0) (postponed-N t7 1e9) (tried-N t9 1))
(defrule target-is-reachable-N
  (travel (id ?target) (state reachable) (length-m ?length))
  (not (given-up-N ?target)) (not (postponed-N ?target ?))
  => (assert (candidate-N (target ?target) (length-m ?length))))
(defrule candidate-is-outdated-N (declare (salience 20))
  ?candidate <- (candidate-N (target ?target) (length-m ?length))
  (not (travel (id ?target) (state reachable) (length-m ?length)))
  => (retract ?candidate))
(defrule place-was-looked-at-N (declare (salience 10))
  (travel (id ?target) (stand-x-m ?x) (stand-y-m ?y))
  (looked-from-N ?lx ?ly)
  (test (< (apart-m ?x ?y ?lx ?ly) ?*same-place-m*))
  => (assert (given-up-N ?target)))
(defrule nearest-target-go-N (declare (salience -10))
  (mode-N go)
  (candidate-N (target ?target) (length-m ?length))
  (not (candidate-N (length-m ?other&:(< ?other ?length))))
  => (assert (goal-N ?target)))
(defrule goal-reached-N
  (mode-N choose) (goal-N ?target)
  (motivation (id path_following) (number ?asked))
  (behaviour (id path_following) (acknowledged ?asked) (outcome reached))
  => (assert (reached-N ?target)))
(defrule goal-left-N
  ?reached <- (reached-N ?target)
  (behaviour (id path_following) (outcome ~reached))
  => (retract ?reached))
(defrule goal-gone-N
  (mode-N choose) (goal-N ?target) (not (target (id ?target)))
  => (assert (gone-N ?target)))
(defrule rested-N
  ?postponed <- (postponed-N ?target ?until)
  (clock (time-s ?now&:(>= ?now ?until)))
  => (retract ?postponed))
(defrule behaviour-is-lost-N
  (or (behaviour (id ?behaviour) (state failed)) (communication-error ?behaviour))
  => (assert (lost-N ?behaviour)))
(defrule goal-takes-too-long-N
  (mode-N go) (goal-N ?target) (since-N ?since)
  (clock (time-s ?now&:(> (- ?now ?since) (* 2 ?*rest-s*))))
  => (assert (failed-N ?target)))
"""
SCAN = """
(deffacts start-N (goal-N t3))
(defrule something-is-near-N
  (goal-N ?target) (target (id ?target) (x-m ?x) (y-m ?y))
  (exists (target (id ~?target) (status seen) (x-m ?ox&:(< (abs (- ?ox ?x)) 1.0))))
  => (assert (near-N ?target)))
"""
RULES = 100


def program(one_set: str = SET) -> Program:
    """Return the rules of ten sets."""
    return read_text(TEMPLATES + "".join(one_set.replace("-N", f"-{number}") for number in range(10)))


def travel(number: int, length_m: float) -> FactValue:
    values = (Symbol(f"t{number}"), Symbol("reachable"), length_m, number * 0.7, 3.0)
    return FactValue("travel", values, ("id", "state", "length-m", "stand-x-m", "stand-y-m"))


def target(number: int, x_m: float) -> FactValue:
    values = (Symbol(f"t{number}"), x_m, 2.0, Symbol("seen"))
    return FactValue("target", values, ("id", "x-m", "y-m", "status"))


def clock(time_s: float) -> FactValue:
    return FactValue("clock", (time_s,), ("time-s",))


def behaviour(outcome: str) -> FactValue:
    values: tuple[Value, ...] = (Symbol("path_following"), 4, Symbol(outcome), Symbol("selected"))
    return FactValue("behaviour", values, ("id", "acknowledged", "outcome", "state"))


def facts(number: int) -> list[FactValue]:
    """Return as many facts of the board."""
    found = [clock(0.0), behaviour("none"), FactValue("motivation", (Symbol("path_following"), 4), ("id", "number"))]
    for at in count():
        found += [travel(at, 4.0 + at * 0.01), target(at, at * 3.0)]
        if len(found) >= number:
            return found[:number]
    raise AssertionError


Change = Callable[[int], FactValue]
CHANGES: dict[str, tuple[FactValue, Change]] = {
    "the clock": (clock(0.0), lambda number: clock(number * 0.1)),
    "a target has moved": (target(3, 9.0), lambda number: target(3, 9.0 + number % 2)),
    "a way is longer": (travel(11, 4.11), lambda number: travel(11, 4.11 + number * 0.001)),
    "a behaviour's outcome": (behaviour("none"), lambda number: behaviour(("reached", "none")[number % 2])),
}


class ThroughEngine:
    """One of our engines."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        engine.reset()

    def put(self, fact: FactValue) -> int | None:
        return self.engine.assert_fact(fact)

    def take(self, index: int) -> None:
        self.engine.retract(index)

    def run(self) -> None:
        while self.engine.fire() is not None:
            pass


class ThroughClipspy:
    """clipspy, with nothing of ours around it."""

    def __init__(self, rules: Program) -> None:
        self.clips = clips.Environment()
        for text, _ in written_constructs(rules):
            self.clips.build(text)
        self.clips.reset()

    def put(self, fact: FactValue) -> int:
        index: int = self.clips.eval(f"(fact-index (assert {fact}))")
        return index

    def take(self, index: int) -> None:
        self.clips.eval(f"(retract {index})")

    def run(self) -> None:
        self.clips.run()


Driven = ThroughEngine | ThroughClipspy


def all_driven(rules: Program) -> Iterator[tuple[str, Driven]]:
    yield "clipspy", ThroughClipspy(rules)
    yield "engine clips", ThroughEngine(make_engine("clips", rules))
    yield "engine experta", ThroughEngine(make_engine("experta", rules))


def prepared(driven: Driven, number: int) -> dict[object, int]:
    """Put the facts in and fire; return the indices."""
    indices: dict[object, int] = {}
    for fact in facts(number):
        index = driven.put(fact)
        assert index is not None
        indices[fact.key] = index
    driven.run()
    return indices


def cost_ms(driven: Driven, indices: dict[object, int], change: str, rounds: int) -> float:
    """Return what a change costs, the median."""
    first, make = CHANGES[change]
    at: int | None = indices.pop(first.key)
    times = []
    for number in range(1, rounds + 1):
        fact = make(number)
        started = perf_counter()
        assert at is not None
        driven.take(at)
        at = driven.put(fact)
        driven.run()
        times.append(perf_counter() - started)
    return median(times) * 1e3


def table(rules: Program, number: int, changes: Iterable[str], rounds: int) -> dict[tuple[str, str], float]:
    found = {}
    for name, driven in all_driven(rules):
        indices = prepared(driven, number)
        for change in changes:
            found[name, change] = cost_ms(driven, indices, change, rounds)
    return found


def print_row(title: str, change: str, few: dict[tuple[str, str], float], many: dict[tuple[str, str], float]) -> None:
    theirs, between, ours = (few[name, change] for name in ("clipspy", "engine clips", "engine experta"))
    grown = many["engine experta", change]
    print(f"{title:33} {theirs:8.3f} {between:8.3f} {ours:8.3f} {ours / theirs:8.1f} {grown:14.3f} {grown / ours:8.2f}")


def resident_mib() -> float:
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


def memory(rules: Program) -> None:
    """Print what reloads, and facts that come and go, leave behind."""
    for name in ("experta", "clips"):
        engine = make_engine(name, rules)
        engine.reset()
        for reload in range(60):
            engine = make_engine(name, rules)
            engine.reset()
            for fact in facts(500):
                engine.assert_fact(fact)
            engine.close()
            if reload == 9:
                gc.collect()
                before = resident_mib()
        gc.collect()
        print(f"{name:8} a reload leaves behind          {(resident_mib() - before) / 50 * 1024:8.1f} KiB")
        engine = make_engine(name, rules)
        engine.reset()
        for number in range(120_000):
            if number == 20_000:
                before = resident_mib()
            index = engine.assert_fact(FactValue("seen", (number, 0.5, Symbol("red"))))
            assert index is not None
            engine.retract(index)
        print(f"{name:8} 100,000 facts come and gone     {resident_mib() - before:8.1f} MiB")
        before = resident_mib()
        for number in range(100_000):
            engine.assert_fact(FactValue("seen", (number, 0.5, Symbol("red"))))
        print(f"{name:8} 100,000 facts that stay         {resident_mib() - before:8.1f} MiB")


def reload_cost(rules: Program) -> None:
    """Print what a new engine with the same facts costs, the best of five."""
    standing = facts(500)
    for name in ("experta", "clips"):
        built, filled = [], []
        for _ in range(5):
            started = perf_counter()
            engine = make_engine(name, rules)
            engine.reset()
            built.append(perf_counter() - started)
            started = perf_counter()
            for fact in standing:
                engine.assert_fact(fact)
            filled.append((perf_counter() - started) / len(standing))
            engine.close()
        each_us = min(filled) * 1e6
        print(
            f"{name:8} new engine of {RULES} rules {min(built) * 1e3:6.1f} ms, and {each_us:5.0f} us for each fact again"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=200)
    parser.add_argument("--memory", action="store_true", help="what reloads and facts leave behind, instead")
    options = parser.parse_args()
    rules = program()
    assert len(rules.rules) == RULES
    if options.memory:
        memory(rules)
        return
    few, many = (table(rules, number, CHANGES, options.rounds) for number in (500, 5000))
    print(f"{'ms; 500 facts':33}  clipspy    clips  experta experta/clipspy   5000 facts  to 500")
    for change in CHANGES:
        print_row(f"100 rules: {change}", change, few, many)
    moved, scan = "a target has moved", program(SCAN)
    few, many = (table(scan, number, [moved], max(5, options.rounds // 20)) for number in (500, 5000))
    print_row("10 rules that look at all targets", moved, few, many)
    reload_cost(rules)


if __name__ == "__main__":
    main()
