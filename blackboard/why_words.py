"""Entries in words: motivations, firings and facts as sentences, all else by its fields."""

import re
from collections.abc import Sequence
from typing import Any

import msgspec

from blackboard.entry import Support
from blackboard.journal import JournalLine
from blackboard.kinds import FACT, FIRING, MOTIVATION, RULES, Kind
from blackboard.messages.control import Fact, Firing, RuleFiles
from blackboard.messages.motion import Motivation

SHOWN_CHARACTERS = 110
SHOWN_NUMBERS = 16  # a ring of sonars; longer lists are counted
SHOWN_FACTS = 6
FACT_CHARACTERS = 90
_ORIGIN = re.compile(r' \((?:key "[^"]*"|stamp-s [^()]*)\)')  # slots that only tell where a fact came from
_LONG_NUMBER = re.compile(r"-?\b\d+\.\d{3,}(?:e-?\d+)?\b")


def short(key: str) -> str:
    """Return a key without `ski/<robot>/`."""
    return "/".join(key.split("/")[2:])


def is_firing(key: str) -> bool:
    """Say whether a rule's firing stands at this key."""
    return _is(FIRING, key)


def words_of(support: Support, first: JournalLine, last: JournalLine) -> str:
    """Return what a stretch of a key's revisions says."""
    name = short(support.key)
    if support.first != support.last:
        count = support.last - support.first + 1
        return (
            f"{name}, {count} revisions {support.first} to {support.last} ({first.stamp_s:.2f} to {last.stamp_s:.2f} s), "
            f"the last: {_brief(last.value)}"
        )
    sentence = _sentence(last)
    if sentence is not None:
        return sentence
    gone = ", retracted" if last.event == "retracted" else ""
    return f"{name} revision {last.revision}{gone} at {last.stamp_s:.2f} s by {last.source}: {_brief(last.value)}"


def _sentence(line: JournalLine) -> str | None:
    """Return what rules did as a sentence, with the key in brackets so that it can be asked about; None for other kinds."""
    try:
        if _is(MOTIVATION, line.key):
            said = _motivation(_id(line.key), msgspec.json.decode(line.value, type=Motivation))
        elif _is(FIRING, line.key):
            said = _firing(msgspec.json.decode(line.value, type=Firing), line.stamp_s)
        elif _is(FACT, line.key):
            said = _fact(msgspec.json.decode(line.value, type=Fact), line)
        elif _is(RULES, line.key):
            said = _rules(msgspec.json.decode(line.value, type=RuleFiles))
        else:
            return None
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return None  # of a record from before these kinds were as they are now
    when = "" if _is(FIRING, line.key) or (_is(FACT, line.key) and not line.supports) else f" at {line.stamp_s:.2f} s"
    return f"{said}{when}  [{short(line.key)} revision {line.revision}]"


def _motivation(behaviour: str, asked: Motivation) -> str:
    if not asked.on:
        return f"{behaviour} was told to stop"
    given = asked.parameters
    if len(given) >= 2 and isinstance(given[0], float) and isinstance(given[1], float):
        more = f", with {_listed(given[2:])}" if given[2:] else ""
        return f"{behaviour} was asked to go to ({given[0]:.2f}, {given[1]:.2f}){more}"
    return f"{behaviour} was asked to act" + (f", with {_listed(given)}" if given else "")


def _firing(fired: Firing, stamp_s: float) -> str:
    facts = [plain_fact(fact) for fact in fired.facts if fact]
    more = f" and {len(facts) - SHOWN_FACTS} more" if len(facts) > SHOWN_FACTS else ""
    matched = f": it matched {', '.join(facts[:SHOWN_FACTS])}{more}" if facts else ", which needed no fact"
    failed = f"; it failed: {fired.error}" if fired.error else ""
    return f"rule {fired.rule} fired at {stamp_s:.2f} s{matched}{failed}"


def _fact(fact: Fact, line: JournalLine) -> str:
    if line.event == "retracted":
        return f"the fact {plain_fact(fact.fact)} was retracted"
    return f"the fact {plain_fact(fact.fact)} " + ("was asserted" if line.supports else "stood from the start")


def _rules(rules: RuleFiles) -> str:
    names = ", ".join(file.name for file in rules.files)
    return (
        f"the rules of {names} were kept, a change was refused ({rules.refused})"
        if rules.refused
        else f"the rules of {names} came into force"
    )


def plain_fact(text: str) -> str:
    """Return a fact's text without what only tells where it came from, its numbers rounded, cut where it is long."""
    plain = _LONG_NUMBER.sub(lambda number: f"{float(number.group()):.4g}", _ORIGIN.sub("", text))
    return plain if len(plain) <= FACT_CHARACTERS else f"{plain[: FACT_CHARACTERS - 4]}...)"


def _listed(parameters: Sequence[float | str]) -> str:
    return ", ".join(f"{one:.4g}" if isinstance(one, float) else one for one in parameters)


def _is(kind: Kind[Any], key: str) -> bool:
    name = short(key)
    return name.startswith(f"{kind.path}/") if kind.collection else name == kind.path


def _id(key: str) -> str:
    return key.rsplit("/", 1)[1]


def _brief(raw: msgspec.Raw) -> str:
    try:
        value = msgspec.json.decode(raw)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return f"{len(bytes(raw))} bytes that are no JSON"
    text = ", ".join(f"{name} {_shown(item)}" for name, item in value.items()) if isinstance(value, dict) else ""
    return text if len(text) <= SHOWN_CHARACTERS else f"{text[: SHOWN_CHARACTERS - 3]}..."


def _shown(item: object) -> str:
    if isinstance(item, dict):
        if item.keys() >= {"zlib_base64", "dtype", "shape"}:
            return f"{item['dtype']}{item['shape']}"
        return f"({', '.join(map(_shown, item.values()))})"
    if isinstance(item, list):
        numbers = all(part is None or isinstance(part, int | float) for part in item)
        return f"[{' '.join(map(_shown, item))}]" if numbers and len(item) <= SHOWN_NUMBERS else f"{len(item)} values"
    if isinstance(item, float):
        return f"{item:.3g}"
    return "-" if item is None else str(item)
