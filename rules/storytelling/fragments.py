"""The facts, patterns and entries of a story, read by the language's own reader: faults are told with the story's line."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from blackboard.errors import did_you_mean
from rules.explaining.matching import Matcher
from rules.language.actions import ActionCompiler
from rules.language.errors import RuleError, RuleErrors
from rules.language.evaluation import evaluate
from rules.language.library.multifields import flattened
from rules.language.reader import read_texts
from rules.language.syntax import FactForm, Match, Modify, Pattern, Program, Template
from rules.language.values import FactValue, Value
from rules.language.walk import asserted
from rules.storytelling.story_file import Said, Story
from rules.working_memory import slots_looked_at

MARK = "story-told-"  # begins the names of what a story is read as


@dataclass(frozen=True, slots=True)
class Change:
    """A `modify`: the one fact that matches, and what its slots become."""

    pattern: Pattern
    slots: tuple[tuple[str, Value], ...]


@dataclass(frozen=True, slots=True)
class Fragments:
    """What a story's texts mean."""

    program: Program  # of the rule files alone
    facts: Mapping[Said, FactValue]
    entries: Mapping[Said, tuple[str, dict[str, Value]]]  # template, and the slots that are told
    patterns: Mapping[Said, Pattern]
    changes: Mapping[Said, Change]


def read_fragments(story: Story, texts: Mapping[str, str], templates: Sequence[Template]) -> Fragments:
    """Return what a story means, beside rule files of these texts. Raises RuleError with file and line."""
    asserted = [said for step in story.steps for said in step.asserted]
    entries = [said for step in story.steps for said in step.entries]
    patterns = [said for step in story.steps for said in (*step.gone, *step.retract, *step.expect, *step.expect_not)]
    changes = [said for step in story.steps for said in step.modify]
    forms = {
        **{said: f"(deffacts {{}} {said.text})" for said in (*asserted, *entries)},
        **{said: f"(defrule {{}} {said.text} =>)" for said in patterns},
        **{said: _change(story, said) for said in changes},
    }
    names = {said: f"{MARK}{number}" for number, said in enumerate(forms)}
    file = str(story.path)
    program = _read(file, texts, {said: form.replace("{}", names[said], 1) for said, form in forms.items()}, templates)
    deffacts = {one.name: one for one in program.deffacts}
    rules = {one.name: one for one in program.rules}
    boards = {template.name for template in program.templates if template.position is None}
    compiler, globals_ = ActionCompiler(program, {}), Matcher(program).globals

    def form_of(said: Said) -> FactForm:
        facts = deffacts[names[said]].facts
        if len(facts) != 1:
            raise RuleError(f"{file}:{said.line}: write one fact: {said.text}")
        return facts[0]

    def pattern_of(said: Said) -> Pattern:
        conditions = rules[names[said]].conditions
        if len(conditions) != 1 or not isinstance(conditions[0], Match):
            raise RuleError(f"{file}:{said.line}: write one pattern of a fact: {said.text}")
        return conditions[0].pattern

    def entry_of(said: Said) -> tuple[str, dict[str, Value]]:
        form = form_of(said)
        if form.slots is None or form.relation not in boards:
            raise RuleError(
                f"{file}:{said.line}: ({form.relation} ...) is no entry of the board; put it under `assert`"
            )
        return form.relation, _slots(form, globals_)

    def fact_of(said: Said) -> FactValue:
        form = form_of(said)
        if form.relation in boards:
            raise RuleError(
                f"{file}:{said.line}: ({form.relation} ...) is an entry of the board; put it under `entries`"
            )
        return compiler.fact(form)({}, globals_)

    def change_of(said: Said) -> Change:
        action = rules[names[said]].actions[0]
        assert isinstance(action, Modify)
        slots = tuple((slot, _together(evaluate(v, {}, globals_) for v in values)) for slot, values in action.slots)
        return Change(pattern_of(said), slots)

    own = Program(
        templates=program.templates,
        deffacts=tuple(one for one in program.deffacts if not one.name.startswith(MARK)),
        globals=program.globals,
        functions=program.functions,
        rules=tuple(one for one in program.rules if not one.name.startswith(MARK)),
    )
    facts = {said: fact_of(said) for said in asserted}
    told = {said: pattern_of(said) for said in patterns}
    _refuse_unheard(story, own, told, {fact.relation for fact in facts.values()})
    return Fragments(
        program=own,
        facts=facts,
        entries={said: entry_of(said) for said in entries},
        patterns=told,
        changes={said: change_of(said) for said in changes},
    )


def _refuse_unheard(story: Story, program: Program, patterns: Mapping[Said, Pattern], facts: set[str]) -> None:
    """Refuse names that nothing knows: what must not happen never would, and the story could not fail."""
    rules = {rule.name for rule in program.rules}
    relations = facts | {one.name for one in program.templates} | set(slots_looked_at(program))
    relations |= {form.relation for one in program.deffacts for form in one.facts}
    relations |= {form.relation for rule in program.rules for form in asserted(rule)}
    for step in story.steps:
        for said in (*step.fires, *step.fires_not):
            if said.text not in rules:
                hint = did_you_mean(said.text, rules)
                raise RuleError(f"{story.path}:{said.line}: there is no rule '{said.text}'{hint}")
        for said in step.expect_not:
            relation = patterns[said].relation
            if relation not in relations:
                hint = did_you_mean(relation, relations)
                raise RuleError(f"{story.path}:{said.line}: nothing speaks of ({relation} ...){hint}")


def _read(file: str, texts: Mapping[str, str], forms: Mapping[Said, str], templates: Sequence[Template]) -> Program:
    """Read the forms of a story, each on the line on which the story tells it."""
    lines: dict[int, list[str]] = {}
    for said, form in forms.items():
        lines.setdefault(said.line, []).append(form.replace("\n", " "))
    written = "\n".join(" ".join(lines.get(number, ())) for number in range(1, max(lines, default=0) + 1))
    try:
        return read_texts({**texts, file: written}, templates)
    except RuleErrors as errors:
        first = errors.errors[0]
        if first.position is None or first.position.file != file:
            raise
        told = str(first).removeprefix(f"{first.position}: ")
        raise RuleError(f"{file}:{first.position.line}: {told}") from None


def _change(story: Story, said: Said) -> str:
    """Return a rule that changes what a pattern matches: the pattern is the first form of the text, the rest are slots."""
    depth, quoted = 0, False
    for place, letter in enumerate(said.text):
        if letter == '"' and said.text[place - 1 : place] != "\\":
            quoted = not quoted
        depth += 0 if quoted else (letter == "(") - (letter == ")")
        if depth == 0 and letter == ")":
            rest = said.text[place + 1 :].strip()
            if rest:
                return f"(defrule {{}} ?story-told <- {said.text[: place + 1]} => (modify ?story-told {rest}))"
            break
    raise RuleError(
        f"{story.path}:{said.line}: modify: write a pattern and then the slots: (goal (target a)) (x-m 3.0)"
    )


def _slots(form: FactForm, globals_: Mapping[str, Value]) -> dict[str, Value]:
    """Return the slots that are written, with their values."""
    written: dict[str, list[Value]] = {}
    for slot, field in zip(form.slots or (), form.fields, strict=True):
        written.setdefault(slot, []).append(evaluate(field, {}, globals_))
    return {slot: _together(values) for slot, values in written.items()}


def _together(values: Iterable[Value]) -> Value:
    found = list(values)
    return found[0] if len(found) == 1 else flattened(found)
