"""Why does it stand there? From an entry through its supports down to the readings."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from blackboard.entry import Endorsement, Support
from blackboard.errors import BoardError, did_you_mean
from blackboard.journal import JournalLine
from blackboard.key_expressions import matches
from blackboard.why_words import is_firing, short, words_of


@dataclass
class Reason:
    """One step of an explanation: an entry or a stretch of them, in words, and what it stands on."""

    support: Support
    words: str
    said: tuple[str, ...] = ()  # endorsements
    reasons: list["Reason"] = field(default_factory=list)
    repeated: bool = False  # explained further up

    def as_dict(self) -> dict[str, object]:
        """Return the same as plain data, for JSON."""
        return {
            "key": self.support.key,
            "first": self.support.first,
            "last": self.support.last,
            "words": self.words,
            "endorsements": list(self.said),
            "repeated": self.repeated,
            "supports": [reason.as_dict() for reason in self.reasons],
        }


class Record:
    """All revisions of a run, by key."""

    def __init__(self, lines: Iterable[JournalLine]) -> None:
        self._revisions: dict[str, dict[int, JournalLine]] = {}
        for line in lines:
            self._revisions.setdefault(line.key, {})[line.revision] = line

    def find(self, name: str, *, at_s: float | None = None) -> JournalLine:
        """Return the newest revision (at or before `at_s`) of the key that `name` says: whole, without `ski/<robot>/`, or an
        expression that matches one key. Raises BoardError where it is none or several.
        """
        candidates = [key for key in self._revisions if key == name or short(key) == name]
        if not candidates and "*" in name:
            candidates = [key for key in self._revisions if matches(name, key) or matches(name, short(key))]
        if not candidates:
            raise BoardError(f"nothing stood at '{name}'{did_you_mean(name, map(short, self._revisions))}")
        if len(candidates) > 1:
            shown = ", ".join(sorted(map(short, candidates))[:5])
            raise BoardError(f"'{name}' matches {len(candidates)} keys ({shown}, ...); name one")
        revisions = self._revisions[candidates[0]].values()
        before = [line for line in revisions if at_s is None or line.stamp_s <= at_s]
        if not before:
            first = min(line.stamp_s for line in revisions)
            raise BoardError(f"'{name}' was first posted at {first:.3f} s; give a later --at")
        return max(before, key=lambda line: line.revision)

    def explain(self, line: JournalLine, depth: int = 12) -> Reason:
        """Return why an entry stands: a tree whose leaves are readings (entries without supports)."""
        return self._reason(Support(line.key, line.revision, line.revision), depth, set(), below=False)

    def _reason(self, support: Support, depth: int, seen: set[tuple[str, int, int]], *, below: bool = True) -> Reason:
        revisions = self._revisions.get(support.key, {})
        first, last = revisions.get(support.first), revisions.get(support.last)
        name = (support.key, support.first, support.last)
        if last is None:
            return Reason(support, "not in this record")
        told = words_of(support, first or last, last)
        reason = Reason(support, f"because {told}" if below and is_firing(support.key) else told)
        reason.said = said_of(last.endorsements)
        if name in seen:
            reason.repeated = bool(last.supports)
            return reason
        seen.add(name)
        if depth > 0:
            reason.reasons = [self._reason(s, depth - 1, seen) for s in last.supports]
        return reason


def render(reason: Reason, indent: str = "", last: bool = True, root: bool = True) -> Iterator[str]:
    """Yield a tree of reasons as lines of text."""
    branch = "" if root else ("└─ " if last else "├─ ")
    note = "  (explained above)" if reason.repeated else ""
    yield f"{indent}{branch}{reason.words}{note}"
    below = indent if root else indent + ("   " if last else "│  ")
    for said in reason.said:
        yield f"{below}   {said}"
    for i, inner in enumerate(reason.reasons):
        yield from render(inner, below, i == len(reason.reasons) - 1, root=False)


def said_of(endorsements: Sequence[Endorsement]) -> tuple[str, ...]:
    """Return the endorsements of an entry in words, as they came; of those that stand no more, until when they stood."""
    words = []
    for i, e in enumerate(endorsements):
        by = f"{e.who}, {e.about}" if e.about else e.who
        later = next((said for said in endorsements[i + 1 :] if (said.who, said.about) == (e.who, e.about)), None)
        until = "" if later is None or e.verdict == "withdrawn" else f", until {later.stamp_s:.2f} s"
        words.append(f"{e.verdict} ({by}{until}): {e.why}")
    return tuple(words)
