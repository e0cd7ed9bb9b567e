"""The names of rules: by where something stands in a file, and as parts of keys."""

from blackboard.key_expressions import is_chunk
from rules.language.syntax import Position, Program


def rule_at(position: Position | None, program: Program) -> str:
    """Return the name of the rule that stands at a place: the last one that begins before it."""
    before = [rule for rule in program.rules if position is not None and rule.position <= position]
    here = [rule for rule in before if position is not None and rule.position.file == position.file]
    return max(here, key=lambda rule: rule.position).name if here else "unknown"


def chunk(name: str) -> str:
    """Return a rule's name as a part of a key."""
    return "".join(letter if is_chunk(letter) else "_" for letter in name)
