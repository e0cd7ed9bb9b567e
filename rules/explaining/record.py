"""What rules had before them at some time of a run, out of its record: the rules in force, and the facts in working memory.

Working memory is put together as the planning module keeps it: entries of the kinds that the rules name, facts that rules (and
deffacts) asserted, and the clock. It is that at the end of a cycle, after the rules have had their turn.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import msgspec

from blackboard.entry import Entry
from blackboard.errors import BoardError, MessageError, RecordingError
from blackboard.journal import JournalLine
from blackboard.kinds import COMPONENT, FACT, FIRING, RULES
from blackboard.messages.control import Fact, Firing, RuleFiles
from blackboard.vocabulary import Vocabulary, decode
from rules.language.actions import ActionCompiler
from rules.language.errors import RuleErrors
from rules.language.reader import read_texts
from rules.language.syntax import Program
from rules.language.templates import CLOCK, KindTemplate, kind_templates, planning_templates
from rules.language.values import FactValue

STANDING = "<standing facts>"  # the file name under which they are read


@dataclass(frozen=True, slots=True)
class FiringThen:
    """One firing of a rule and when."""

    stamp_s: float
    value: Firing


@dataclass(frozen=True, slots=True)
class Situation:
    """What stood at `stamp_s`: `unread` counts facts that could not be read back."""

    stamp_s: float
    program: Program
    facts: dict[int, FactValue]
    firings: tuple[FiringThen, ...]  # of all rules, until then
    unread: int = 0
    failure: str = ""  # of the planning module as a whole: then no rule fires any more


def situation(
    lines: Iterable[JournalLine], at_s: float | None = None, vocabulary: Vocabulary | None = None
) -> Situation:
    """Return what rules had before them at `at_s`, or at the end; `vocabulary` is the mission's, where it has kinds of its own.

    Raises RecordingError where no rules decided by then.
    """
    vocabulary = vocabulary or Vocabulary()
    newest: dict[str, tuple[JournalLine, Any]] = {}  # by key, with its kind
    firings: list[FiringThen] = []
    latest_s = 0.0
    for line in lines:
        if at_s is not None and line.stamp_s > at_s:
            continue
        latest_s = max(latest_s, line.stamp_s)
        try:
            kind = vocabulary.parse_key(line.key)[1]
        except BoardError:
            continue  # of a component from elsewhere
        if kind is FIRING and line.event != "retracted":
            firings.append(FiringThen(line.stamp_s, decode(FIRING, line.key, bytes(line.value))))
        newest.pop(line.key, None)  # in the order of the newest posting
        if line.event != "retracted":
            newest[line.key] = (line, kind)
    rules = [line for line, kind in newest.values() if kind is RULES]
    if not rules:
        when = "" if at_s is None else f" by {at_s:g} s"
        raise RecordingError(f"no rules decided in this run{when}; its mission has no [rules], or give a later --at")
    files = decode(RULES, rules[0].key, bytes(rules[0].value))
    stamp_s = latest_s if at_s is None else at_s
    told = {key: line for key, (line, kind) in newest.items() if kind is FACT}
    program, asserted, unread = read_rules(
        files, [decode(FACT, key, bytes(line.value)) for key, line in told.items()], vocabulary
    )
    templates = kind_templates(vocabulary)
    used = {template.name for template in program.templates if template.position is None}
    found = [
        fact_of(templates[kind.path], line)
        for line, kind in newest.values()
        if kind.path in templates and templates[kind.path].template.name in used
    ]
    clock = [FactValue(CLOCK.name, (stamp_s,), ("time-s",))] if CLOCK.name in used else []
    facts = dict(enumerate([*clock, *(fact for fact in found if fact is not None), *asserted], 1))
    failed = [
        decode(COMPONENT, line.key, bytes(line.value))
        for line, kind in newest.values()
        if kind is COMPONENT and line.source == rules[0].source
    ]
    failure = next((status.error for status in failed if status.state == "failed"), "")
    return Situation(stamp_s, program, facts, tuple(firings), unread, failure)


def read_rules(
    files: RuleFiles, asserted: Iterable[Fact], vocabulary: Vocabulary
) -> tuple[Program, list[FactValue], int]:
    """Return the program of these files, facts read back from their texts, and how many could not be read."""
    templates = planning_templates(vocabulary)
    texts = {file.name: file.text for file in files.files}

    def read(facts: Iterable[str]) -> Program:
        return read_texts({**texts, STANDING: "\n".join(["(deffacts standing-facts", *facts, ")"])}, templates)

    told = [fact.fact for fact in asserted]
    readable = told
    try:
        program = read(told)
    except RuleErrors:
        try:
            read(())  # the files themselves must be sound
        except RuleErrors as error:
            text = f"{error}; where the mission has kinds of its own, name it: --mission FILE"
            raise RecordingError(text) from None
        readable = [fact for fact in told if _reads(read, fact)]
        program = read(readable)
    compiler = ActionCompiler(program, {})
    forms = [form for one in program.deffacts if one.position.file == STANDING for form in one.facts]
    deffacts = tuple(one for one in program.deffacts if one.position.file != STANDING)
    return (
        replace(program, deffacts=deffacts),
        [compiler.fact(form)({}, {}) for form in forms],
        len(told) - len(readable),
    )


def _reads(read: Callable[[Iterable[str]], Program], fact: str) -> bool:
    try:
        read([fact])
    except RuleErrors:
        return False
    return True


def fact_of(made: KindTemplate, line: JournalLine) -> FactValue | None:
    """Return an entry of the record as a fact; None for a value that its kind does not know any more."""
    try:
        value = decode(made.kind, line.key, bytes(line.value))
    except (MessageError, msgspec.DecodeError):
        return None
    entry: Entry[Any] = Entry(
        key=line.key,
        id=line.key.rsplit("/", 1)[1] if made.kind.collection else None,
        revision=line.revision,
        event=line.event,
        stamp_s=line.stamp_s,
        source=line.source,
        value=value,
    )
    return made.fact(entry)
