"""Which kinds rules post, and whether they may."""

from collections.abc import Iterable
from typing import Any

from blackboard.component import Parts
from blackboard.kinds import Kind
from rules.language.errors import RuleError
from rules.language.syntax import Constant, Program
from rules.language.templates import kind_template, kind_templates
from rules.language.walk import calls_of


def posted_kinds(program: Program, parts: Parts, own: Iterable[Kind[Any]]) -> tuple[Kind[Any], ...]:
    """Return the kinds that the program's rules post. Raises RuleError for one that is unknown or has an owner."""
    free = set(own)
    found: dict[str, Kind[Any]] = {}
    templates = kind_templates(parts.vocabulary)
    for rule in program.rules:
        for call in calls_of(rule):
            if call.function != "post" or not isinstance(call.arguments[0], Constant):
                continue
            name, position = str(call.arguments[0].value), call.position
            try:
                kind = kind_template(name, templates).kind
            except RuleError as error:
                raise RuleError(str(error), position) from None
            owner = parts.owners.get(kind.path)
            if owner is not None and not kind.shared and kind not in free:
                raise RuleError(f"post: '{name}' is posted by {owner} already; only one may", position)
            found[kind.path] = kind
    return tuple(found.values())
