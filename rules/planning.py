"""The planning module: rules look at what stands on the board, and set motivations and arbitration.

Reads  every kind that a rule's pattern names, as facts (see `rules.working_memory`)
Posts  motivations/motivation/<behaviour>       Motivation
       control/switch/<behaviour or level>      Switch
       control/focus/<knowledge source>         Focus
       control/firing/<rule>                    Firing: its supports are the entries behind the facts that matched
       control/fact/<index>                     Fact: what rules asserted; its support is the firing
       control/rule_error/<rule>                RuleError
       status/communication_error/<behaviour>   CommunicationError
       control/rules                            RuleFiles
       and what rules `post`

Bou-Ghannam 1992, sections 4.1 and 5.1: the planning module reasons about behaviour selection with knowledge embedded in CLIPS
rules and the facts of the current situation; only what has changed is asserted.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from blackboard.access import Access
from blackboard.component import Parts, Planner
from blackboard.entry import Entry
from blackboard.errors import SkiError
from blackboard.kinds import (
    COMMUNICATION_ERROR,
    FACT,
    FIRING,
    FOCUS,
    MISSION,
    MOTIVATION,
    RULE_ERROR,
    RULES,
    SWITCH,
    Kind,
)
from blackboard.messages.control import CommunicationError, Firing, RuleError, RuleFile, RuleFiles
from blackboard.messages.motion import BehaviourStatus
from blackboard.parameters import require
from rules.board_actions import BoardActions
from rules.checks.program import refuse_faults
from rules.engines.engine import Engine
from rules.engines.engine import Firing as Fired
from rules.engines.factory import make_engine
from rules.language.errors import RuleError as LanguageError
from rules.language.syntax import Program
from rules.language.templates import planning_templates
from rules.language.values import FactValue
from rules.posted_kinds import posted_kinds
from rules.reload import take_over
from rules.remembered import remembered
from rules.resuming import PlannerState, drop_fired, newest_number, resumed
from rules.rule_files import RuleFileSet, program_of
from rules.rule_names import chunk, rule_at
from rules.shown_facts import show_anew, show_changes, show_deffacts, shown
from rules.working_memory import WorkingMemory

OWN = (MOTIVATION, SWITCH, FOCUS, FIRING, FACT, RULE_ERROR, COMMUNICATION_ERROR, RULES, MISSION)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanningParams:
    """Which rules decide, on which engine, and how patient they are."""

    files: tuple[Path, ...]
    engine: Literal["experta", "clips"] = "experta"
    clock_s: float = 1.0  # how often rules are told the time, where they ask for it
    acknowledge_s: float = 1.0  # ten control cycles: a behaviour that works takes one
    firings_per_cycle: int = 200  # rules that go on for longer are taken for an endless loop
    reload_s: float = 1.0  # how often the files are looked at for changes; 0: never

    def __post_init__(self) -> None:
        require(len(self.files) > 0, "files", list(self.files), "a list with at least one rule file")
        require(0.05 <= self.clock_s <= 3600.0, "clock_s", self.clock_s, "[0.05, 3600] seconds")
        require(0.1 <= self.acknowledge_s <= 3600.0, "acknowledge_s", self.acknowledge_s, "[0.1, 3600] seconds")
        require(1 <= self.firings_per_cycle <= 100_000, "firings_per_cycle", self.firings_per_cycle, "[1, 100000]")
        require(0.0 <= self.reload_s <= 3600.0, "reload_s", self.reload_s, "[0, 3600] seconds")


class PlanningModule(Planner[PlanningParams]):
    """Runs rule files on the board."""

    Params = PlanningParams

    def __init__(self, params: PlanningParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._files = RuleFileSet(params.files)
        self._texts = self._files.read()
        self._changed: dict[str, Entry[Any]] = {}  # since rules were last told, by key
        self._posted: tuple[Kind[Any], ...] = ()
        self._fired = 0
        self._begun = False
        self._told_s = self._looked_s = float("-inf")

    @property
    def posts(self) -> tuple[Kind[Any], ...]:  # type: ignore[override]
        return tuple(dict.fromkeys((*OWN, *self._posted)))

    @property
    def reads(self) -> tuple[Kind[Any], ...]:  # type: ignore[override]
        return tuple(self._memory.kinds)  # once started: it follows from the rules

    def start(self, parts: Parts) -> None:
        self._parts = parts
        program = self._program(self._texts)
        self._posted = posted_kinds(program, parts, OWN)
        self._actions = BoardActions(parts, self._posted, self.params.acknowledge_s)
        engine = make_engine(self.params.engine, program, self._actions.externals())
        engine.reset()
        self._take(WorkingMemory(engine, parts.vocabulary))

    def note(self, entry: Entry[Any]) -> None:
        if self._memory.looks_at(entry.key):
            self._changed[entry.key] = entry
        if isinstance(entry.value, BehaviourStatus):
            self._actions.acknowledged(str(entry.id), entry.value)

    def decide(self, board: Access) -> None:
        self._actions.now_s = board.now_s
        if not self._begun:
            self._begin(board)
        elif self.params.reload_s and board.now_s - self._looked_s >= self.params.reload_s:
            self._looked_s = board.now_s
            if self._files.changed():
                self._reload(board)
        self._show_late(board)
        changed = self._take_changes()
        if self._memory.wants_clock and board.now_s - self._told_s >= self.params.clock_s - 1e-9:
            self._told_s = board.now_s
            self._memory.tell_time(board.now_s)
            changed = True
        if changed or self._unfinished:
            self._run(board)
            self._show_faults(board)

    def _take_changes(self) -> bool:
        """Bring working memory up to date with the board; return whether it changed."""
        taken, self._changed = self._changed, {}
        changed = [self._memory.take(entry) for entry in taken.values()]
        return any(changed)

    @property
    def memory(self) -> WorkingMemory:
        """What the rules have before them."""
        return self._memory

    def put(self, asserted: Sequence[FactValue] = (), retracted: Sequence[int] = ()) -> None:
        """Change working memory by hand, as stories about rules do."""
        for index in retracted:
            self._memory.engine.retract(index)
        for fact in asserted:
            self._memory.engine.assert_fact(fact)
        self._unfinished = True

    def state(self) -> object:
        self.acted = False
        if not self._begun:
            return None
        return PlannerState(
            remembered=remembered(self._memory),
            actions=self._actions.state(),
            fired=self._fired,
            told_s=self._told_s,
            looked_s=self._looked_s,
        )

    def resume(self, state: object, board: Access) -> None:
        """Go on where the rules were; where none had begun, begin as ever."""
        rules = board.newest(RULES)
        if rules is None:
            return
        kept = state if isinstance(state, PlannerState) else None
        files = RuleFiles(engine=self.params.engine, files=self._texts)
        known = kept.remembered if kept is not None else None
        memory, lost = resumed(known, self._memory.engine, self._parts.vocabulary, files, board)
        self._begun, self._actions.now_s = True, board.now_s
        if kept is not None:
            self._fired, self._told_s, self._looked_s = kept.fired, kept.told_s, kept.looked_s
        drop_fired(memory.engine, board, self._fired)
        self._fired = max(self._fired, newest_number(board.entries(FIRING)))
        self._actions.resume(kept.actions if kept is not None else None, board)
        if rules.value.files != files.files:
            rules = board.post(RULES, files)
        show_anew(board, memory, rules)
        self._take(memory)
        for fact in lost:
            fault = RuleError(rule="after a restart", text=f"could not be read back and is lost: {fact}"[:4000])
            board.post(RULE_ERROR, fault, id=chunk(fault.rule))

    def close(self) -> None:
        self._memory.engine.close()

    def _program(self, texts: Sequence[RuleFile]) -> Program:
        program = program_of(texts, planning_templates(self._parts.vocabulary))
        refuse_faults(program, self._parts)
        return program

    def _take(self, memory: WorkingMemory) -> None:
        self._memory = memory
        self._actions.entry_of = memory.entry_of
        self._unfinished = True

    def _begin(self, board: Access) -> None:
        self._begun = True
        rules = board.post(RULES, RuleFiles(engine=self.params.engine, files=self._texts))
        show_deffacts(board, self._memory, rules)

    def _reload(self, board: Access) -> None:
        """Let changed files take over; where they cannot, say why and go on with the rules that run."""
        before = self._texts
        engine: Engine | None = None
        try:
            texts = self._files.read()
            program = self._program(texts)
            unknown = [k for k in posted_kinds(program, self._parts, OWN) if k not in (*OWN, *self._posted)]
            if unknown:
                raise LanguageError(f"the changed rules post '{unknown[0].path}', which those before did not; run anew")
            engine = make_engine(self.params.engine, program, self._actions.externals())
            memory = take_over(self._memory, engine, self._parts.vocabulary)
        except SkiError as error:
            if engine is not None:
                engine.close()
            board.post(RULES, RuleFiles(engine=self.params.engine, files=before, refused=str(error)[:4000]))
            return
        self._memory.engine.close()
        self._texts = texts
        rules = board.post(RULES, RuleFiles(engine=self.params.engine, files=texts))
        show_anew(board, memory, rules)
        self._take(memory)
        for kind in memory.kinds:
            for entry in board.entries(kind):
                self._changed.setdefault(entry.key, entry)

    def _show_late(self, board: Access) -> None:
        """Post an error for each behaviour that has not acknowledged in time, and take it back where it has since.

        Once the mission is over nobody answers any more, and nobody is blamed for it.
        """
        mission = board.newest(MISSION)
        if mission is not None and mission.value.state != "underway":
            return
        for behaviour, (number, waited_s) in self._actions.late().items():
            board.post(COMMUNICATION_ERROR, CommunicationError(number=number, waited_s=waited_s), id=behaviour)
        for entry in board.entries(COMMUNICATION_ERROR):
            if not self._actions.is_late(str(entry.id)):
                board.retract(COMMUNICATION_ERROR, entry.id)

    def _run(self, board: Access) -> None:
        engine = self._memory.engine
        engine.resume()
        for _ in range(self.params.firings_per_cycle):
            waiting = engine.waiting()
            if waiting is None:
                self._unfinished = False
                return
            matched = [engine.fact(i) if i is not None else None for i in waiting.facts]
            fired = engine.fire()
            if fired is None or self._settle(board, fired, matched):
                self._unfinished = engine.waiting() is not None  # after a halt the rest waits for the next cycle
                return
        waiting = engine.waiting()
        self._unfinished = waiting is not None
        if waiting is not None:
            name = waiting.rule
            text = f"{self.params.firings_per_cycle} rules fired in one cycle and there was no end; the next is {name}"
            standing = board.newest(RULE_ERROR, chunk(name))
            if standing is None or standing.value.text != text:  # it goes on: no news
                board.post(RULE_ERROR, RuleError(rule=name, text=text), id=chunk(name))

    def _show_faults(self, board: Access) -> None:
        """Post what of rules' conditions could not be evaluated."""
        for fault in self._memory.engine.take_faults():
            name = rule_at(fault.position, self._memory.engine.program)
            board.post(RULE_ERROR, RuleError(rule=name, text=str(fault)[:4000]), id=chunk(name))

    def _settle(self, board: Access, fired: Fired, matched: Sequence[FactValue | None]) -> bool:
        """Show a firing and do what it asked for; return whether it said halt."""
        activation, memory = fired.activation, self._memory
        supports = [s for i in activation.facts if i is not None and (s := memory.support(i)) is not None]
        deeds = self._actions.take()
        self._fired += 1
        self.acted = True
        value = Firing(
            rule=activation.rule,
            number=self._fired,
            facts=tuple(map(shown, matched)),
            did=tuple(deed.words[:4000] for deed in deeds),
            said=fired.printed[:4000],
            error=(fired.error or "")[:4000],
        )
        firing = board.post(FIRING, value, id=chunk(activation.rule), supports=list(dict.fromkeys(supports)))
        errors = [fired.error] if fired.error else []
        for deed in deeds:
            try:
                deed.step(board, (firing,))
            except SkiError as error:
                errors.append(str(error))
        behind = show_changes(board, memory, fired.changes, firing)
        memory.note_changes(fired.changes, behind)
        for text in errors:
            fault = RuleError(rule=activation.rule, text=text[:4000])
            board.post(RULE_ERROR, fault, id=chunk(activation.rule), supports=(firing,))
        self._take_changes()  # what it posted is news to the next rule at once: a motivation, and so its number
        return memory.engine.halted
