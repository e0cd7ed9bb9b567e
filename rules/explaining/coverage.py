"""Which rules fired how often in some runs, and which never did."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from blackboard.journal import JournalLine
from blackboard.kinds import FIRING, RULES
from blackboard.vocabulary import decode
from rules.language.reading.constructs import named
from rules.language.reading.forms import top_forms
from rules.language.reading.tokens import tokens


@dataclass(frozen=True, slots=True)
class RuleCount:
    """How often a rule fired, and in how many of the runs it was there."""

    rule: str
    file: str
    line: int
    firings: int
    runs: int


@dataclass(frozen=True, slots=True)
class FileCount:
    """The rules of one file, in its order."""

    file: str
    rules: tuple[RuleCount, ...]

    @property
    def fired(self) -> int:
        """How many of its rules fired at all."""
        return sum(rule.firings > 0 for rule in self.rules)

    @property
    def firings(self) -> int:
        """How often its rules fired, all together."""
        return sum(rule.firings for rule in self.rules)


@dataclass(frozen=True, slots=True)
class RunRules:
    """What one run says of its rules: where each stands (file and line) by its name, and how often each fired."""

    places: dict[str, tuple[str, int]]
    firings: dict[str, int]


def rules_of_run(lines: Iterable[JournalLine]) -> RunRules | None:
    """Return the rules of a run and how often they fired; None where no rules decided."""
    places: dict[str, tuple[str, int]] = {}
    firings: dict[str, int] = {}
    seen = ""
    for line in lines:
        if line.event == "retracted":
            continue
        if line.key.endswith(f"/{RULES.path}"):
            seen = line.key
            files = decode(RULES, line.key, bytes(line.value))
            for file in files.files:
                places |= {name: (file.name, line_number) for name, line_number in rules_in(file.text, file.name)}
        elif f"/{FIRING.path}/" in line.key:
            name = decode(FIRING, line.key, bytes(line.value)).rule
            firings[name] = firings.get(name, 0) + 1
    return RunRules(places, firings) if seen else None


def rules_in(text: str, file: str) -> Iterator[tuple[str, int]]:
    """Yield the names of the rules in a rule file with their lines; what they speak of need not be known."""
    for form in top_forms(tokens(text, file, []), []):
        if form.head == "defrule":
            yield named(form)[0], form.position.line


def coverage(runs: Sequence[RunRules]) -> list[FileCount]:
    """Return the counts of all runs together, by file in the order in which the files were first met."""
    found: dict[str, dict[str, RuleCount]] = {}
    for run in runs:
        for name, (file, line) in run.places.items():
            rules = found.setdefault(file, {})
            before = rules.get(name)
            count = run.firings.get(name, 0)
            rules[name] = RuleCount(
                name,
                file,
                line,
                count + (before.firings if before is not None else 0),
                1 + (before.runs if before is not None else 0),
            )
    return [
        FileCount(file, tuple(sorted(rules.values(), key=lambda rule: (rule.line, rule.rule))))
        for file, rules in found.items()
    ]


def told(files: Sequence[FileCount], runs: int) -> Iterable[str]:
    """Yield the counts as lines: each file with its rules, those that never fired marked, and the total."""
    width = max((len(rule.rule) for file in files for rule in file.rules), default=0)
    digits = max((len(f"{rule.firings:,}") for file in files for rule in file.rules), default=1)
    for file in files:
        yield f"{file.file}: {file.fired} of {len(file.rules)} rules fired, {_times(file.firings)}"
        for rule in file.rules:
            less = f"   in force in {rule.runs} of {runs} runs" if rule.runs < runs else ""
            never = "never" if not rule.firings else ""
            yield f"  {rule.firings:>{digits},}  {rule.rule:<{width}}  {never}{less}".rstrip()
    rules, fired = sum(len(file.rules) for file in files), sum(file.fired for file in files)
    share = f" ({100 * fired / rules:.0f} %)" if rules else ""
    times = sum(file.firings for file in files)
    yield f"{fired} of {rules} rules fired{share}, {_times(times)} in {runs} run{'s' if runs != 1 else ''}"


def _times(number: int) -> str:
    return "once" if number == 1 else f"{number:,} times"
