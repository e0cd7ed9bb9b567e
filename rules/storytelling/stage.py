"""Where a story is played: a board with a planning module on it, no robot, and behaviours that do no more than acknowledge."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from blackboard.board import Board
from blackboard.component import Parts
from blackboard.entry import Entry
from blackboard.errors import SkiError
from blackboard.kinds import BEHAVIOUR, FIRING, MOTIVATION, RULE_ERROR, SWITCH
from blackboard.messages.control import Firing, RuleError
from blackboard.messages.motion import BehaviourStatus, Motivation, Switch
from blackboard.planning import Planning
from rules.explaining.matching import Matcher
from rules.language.errors import RuleError as LanguageError
from rules.language.syntax import Pattern
from rules.language.templates import kind_templates
from rules.language.values import FactValue, Value
from rules.planning import PlanningModule, PlanningParams
from rules.storytelling.entries import revised
from rules.storytelling.fragments import Fragments
from rules.storytelling.story_file import Step, Story

CLOCK_S = 0.05  # rules are told the time in each step that moves it
SETTLING = 50  # cycles after which behaviours and rules that only answer each other are left alone


@dataclass
class Seen:
    """What rules did in one step."""

    firings: list[Firing] = field(default_factory=list)
    errors: list[RuleError] = field(default_factory=list)

    @property
    def did(self) -> list[str]:
        """Their deeds, in order."""
        return [deed for firing in self.firings for deed in firing.did]

    @property
    def fired(self) -> list[str]:
        """The rules, in order."""
        return [firing.rule for firing in self.firings]

    @property
    def said(self) -> str:
        """What they printed."""
        return "".join(firing.said for firing in self.firings)


class Stage:
    """One story being played."""

    def __init__(self, story: Story, params: PlanningParams, parts: Parts, fragments: Fragments) -> None:
        self._story = story
        self._fragments = fragments
        self._templates = {made.template.name: made for made in kind_templates(parts.vocabulary).values()}
        self.board = Board(parts.vocabulary, robot="story")
        self.module = PlanningModule(params, name="rules")
        self._planning = Planning(self.board, self.module, parts, strict=True)
        self.matcher = Matcher(fragments.program)
        self._seen = Seen()
        self.board.subscribe(f"ski/story/{FIRING.path}/*", lambda entry: self._seen.firings.append(entry.value))
        self.board.subscribe(f"ski/story/{RULE_ERROR.path}/*", lambda entry: self._seen.errors.append(entry.value))
        for name in (*parts.behaviours, *parts.levels):
            self.board.post(SWITCH, Switch(), id=name, source=self.module.name)

    def play(self, step: Step) -> Seen:
        """Let a step happen and the rules have their turn. Raises RuleError with the step's line."""
        self._seen = Seen()
        if step.at_s is not None:
            self.board.now_s = step.at_s
        for said in step.gone:
            self._take_off(self._fragments.patterns[said], f"{self._story.path}:{said.line}")
        for said in step.entries:
            try:
                self._post(*self._fragments.entries[said])
            except SkiError as error:
                raise LanguageError(f"{self._story.path}:{said.line}: {error}") from None
        self._change_facts(step)
        for _ in range(SETTLING):
            self._planning.decide()
            if not self._acknowledge():
                break
        self.matcher.globals.update(self.module.memory.engine.globals())
        return self._seen

    def close(self) -> None:
        """Let go of the engine."""
        self._planning.close()

    @property
    def facts(self) -> Mapping[int, FactValue]:
        """What stands in working memory."""
        return self.module.memory.engine.facts()

    def matching(self, pattern: Pattern) -> list[int]:
        """Return the facts that match a pattern."""
        return [
            index
            for index, fact in self.facts.items()
            if fact.relation == pattern.relation and self.matcher.match(pattern, fact, {}) is not None
        ]

    def motivation(self, behaviour: str) -> Motivation | None:
        """Return what a behaviour is asked for."""
        entry = self.board.newest(MOTIVATION, behaviour)
        return None if entry is None else entry.value

    def _take_off(self, pattern: Pattern, where: str) -> None:
        made = self._templates.get(pattern.relation)
        standing = [] if made is None else self.board.entries(made.kind)
        found = [e for e in standing if made is not None and self.matcher.match(pattern, made.fact(e), {}) is not None]
        if not found:
            raise LanguageError(f"{where}: gone: no entry matches this")
        for entry in found:
            self.board.retract(self._templates[pattern.relation].kind, entry.id, source=entry.source)

    def _post(self, template: str, slots: Mapping[str, Value]) -> None:
        made = self._templates[template]
        member = str(slots["id"]) if "id" in slots else None
        if made.kind.collection != (member is not None):
            raise LanguageError(f"'{template}' {'needs (id ...)' if made.kind.collection else 'takes no id'}")
        standing: Entry[Any] | None = self.board.newest(made.kind, member)
        source = standing.source if standing is not None else "story"
        self.board.post(made.kind, revised(made, slots, standing), id=member, source=source)

    def _change_facts(self, step: Step) -> None:
        for said in (*step.retract, *step.modify):
            change = self._fragments.changes.get(said)
            pattern = change.pattern if change is not None else self._fragments.patterns[said]
            found = self.matching(pattern)
            if not found or (change is not None and len(found) > 1):
                many = "no fact matches this" if not found else f"{len(found)} facts match this; say which one"
                raise LanguageError(f"{self._story.path}:{said.line}: {many}")
            changed = []
            if change is not None:
                fact, new = self.facts[found[0]], dict(change.slots)
                names = fact.slots or ()
                fields = tuple(new.get(slot, value) for slot, value in zip(names, fact.fields, strict=True))
                changed = [FactValue(fact.relation, fields, fact.slots)]
            self.module.put(changed, found)
        self.module.put([self._fragments.facts[said] for said in step.asserted])

    def _acknowledge(self) -> bool:
        """Let behaviours take up what they were asked for; return whether any had anything to take up."""
        any_did = False
        for entry in self.board.entries(MOTIVATION):
            name, asked = str(entry.id), entry.value
            standing = self.board.newest(BEHAVIOUR, name)
            if name in self._story.silent or (standing is not None and _needs_nothing(standing.value, asked.number)):
                continue
            any_did = True
            status = BehaviourStatus(
                state="active" if asked.on else "idle",
                selected=asked.on,
                acknowledged=asked.number,
                outcome="underway" if asked.on else "none",
            )
            self.board.post(BEHAVIOUR, status, id=name, source=standing.source if standing is not None else name)
        return any_did


def _needs_nothing(status: BehaviourStatus, number: int) -> bool:
    """Say whether a behaviour has taken up a motivation, or has failed and takes up none any more."""
    return status.acknowledged >= number or status.state == "failed"
