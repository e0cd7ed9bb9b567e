"""A verdict on a rule in words."""

from collections.abc import Iterator, Mapping

from blackboard.vocabulary import Vocabulary
from rules.explaining.record import Situation
from rules.explaining.why_not import Obstacle, Verdict, Way, brief
from rules.language.syntax import Constant, FactForm, Pattern, Program, Rule
from rules.language.templates import kind_templates
from rules.language.values import FactValue, same
from rules.language.walk import asserted

WAYS_SHOWN = 3
RULES_SHOWN = 6


def told(verdict: Verdict, then: Situation) -> Iterator[str]:
    """Yield the lines that say whether a rule could fire, and why not."""
    rule = verdict.rule
    doc = f": {rule.doc}" if rule.doc else ""
    yield f"{rule.name} ({rule.position.file}:{rule.position.line}){doc}"
    if then.failure:
        yield f"  The planning module had failed, so no rule fired any more: {then.failure}"
    if verdict.obstacle is None:
        yield from _could_fire(verdict, then)
    else:
        yield from _blocked(verdict.obstacle, then)
    if verdict.cut_off:
        yield "  There are so many ways to match its conditions that not all were tried."
    if then.unread:
        yield f"  {then.unread} facts of the record could not be read back and are left out."
    yield f"  {_history(rule, then)}"


def _could_fire(verdict: Verdict, then: Situation) -> Iterator[str]:
    many = len(verdict.ways)
    yield f"  At {then.stamp_s:g} s it could fire: all its conditions hold{f', in {many} ways' if many > 1 else ''}."
    for way in verdict.ways[:WAYS_SHOWN]:
        yield f"    {_facts(way, then.facts)}"
    if many > WAYS_SHOWN:
        yield f"    and {many - WAYS_SHOWN} more"
    if any(firing.value.rule == verdict.rule.name for firing in then.firings):
        yield "  A rule fires once for the same facts: it waits until one of them changes."
    else:
        yield "  It waits for its turn: the facts are newer than the last firing, or a rule said halt."


def _blocked(obstacle: Obstacle, then: Situation) -> Iterator[str]:
    place = f"{obstacle.position.file}:{obstacle.position.line}"
    yield f"  At {then.stamp_s:g} s condition {obstacle.number} of {obstacle.total} kept it from firing: {obstacle.verdict}."
    yield f"    {obstacle.text}   at {place}"
    for reason in obstacle.reasons:
        yield f"      {reason}"
    yield from (f"    {line}" for line in _where_from(obstacle, then.program))
    if obstacle.number > 1:
        ways = f", in {obstacle.ways} ways, the first" if obstacle.ways > 1 else ""
        yield f"  The conditions before it hold{ways}: {_facts(obstacle.best, then.facts)}"


def _where_from(obstacle: Obstacle, program: Program) -> Iterator[str]:
    """Yield where facts of the relation that is asked for come from."""
    if (pattern := obstacle.pattern) is None:
        return
    relation = pattern.relation
    makers = [rule.name for rule in program.rules if any(_fits(form, pattern) for form in asserted(rule))]
    if makers:
        more = f" and {len(makers) - RULES_SHOWN} more" if len(makers) > RULES_SHOWN else ""
        yield f"what would match is asserted by {', '.join(makers[:RULES_SHOWN])}{more}"
    kinds = {made.template.name: made.kind for made in kind_templates(Vocabulary()).values()}
    boards = {template.name for template in program.templates if template.position is None}
    if relation in kinds and relation in boards:
        yield f"({relation} ...) is an entry of {kinds[relation].path} on the board"


def _fits(form: FactForm, pattern: Pattern) -> bool:
    """Say whether a fact of this form may match: the same relation, and no constant in another's place."""
    if form.relation != pattern.relation or (form.slots is None) is not (pattern.slots is None):
        return False
    if form.slots is None and len(form.fields) != len(pattern.constraints):
        return True  # one of them has a multifield
    places = range(len(pattern.constraints)) if pattern.slots is None else pattern.slots
    fields = dict(zip(range(len(form.fields)) if form.slots is None else form.slots, form.fields, strict=False))
    for place, constraint in zip(places, pattern.constraints, strict=True):
        field = fields.get(place)
        wanted = [atoms[0] for atoms in constraint.alternatives if len(atoms) == 1]
        constants = [a.term.value for a in wanted if isinstance(a.term, Constant) and not a.negated]
        only_constants = len(constants) == len(constraint.alternatives)
        if isinstance(field, Constant) and only_constants and not any(same(field.value, one) for one in constants):
            return False
    return True


def _history(rule: Rule, then: Situation) -> str:
    fired = [firing for firing in then.firings if firing.value.rule == rule.name]
    if not fired:
        return "It had never fired until then."
    times = "once" if len(fired) == 1 else f"{len(fired)} times"
    failed = f", and failed: {fired[-1].value.error}" if fired[-1].value.error else ""
    return f"It had fired {times} until then, the last time at {fired[-1].stamp_s:.2f} s{failed}."


def _facts(way: Way, facts: Mapping[int, FactValue]) -> str:
    return " ".join(brief(facts[index]) for index in way.facts if index is not None) or "(no fact is needed)"


def as_dict(verdict: Verdict, then: Situation) -> dict[str, object]:
    """Return the same as plain data, for JSON."""
    rule, obstacle = verdict.rule, verdict.obstacle
    told: dict[str, object] = {
        "rule": rule.name,
        "at": f"{rule.position.file}:{rule.position.line}",
        "stamp_s": then.stamp_s,
        "could_fire": obstacle is None,
        "ways": [[str(then.facts[i]) for i in way.facts if i is not None] for way in verdict.ways],
        "fired": [firing.stamp_s for firing in then.firings if firing.value.rule == rule.name],
    }
    if obstacle is not None:
        told["obstacle"] = {
            "condition": obstacle.number,
            "of": obstacle.total,
            "text": obstacle.text,
            "at": f"{obstacle.position.file}:{obstacle.position.line}",
            "verdict": obstacle.verdict,
            "reasons": list(obstacle.reasons),
            "held_before": [str(then.facts[i]) for i in obstacle.best.facts if i is not None],
        }
    return told
