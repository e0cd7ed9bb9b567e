"""`ski rules templates [NAME ...]`: the templates under which rules see the board's entries."""

import argparse
import sys
from collections.abc import Mapping

from blackboard.errors import did_you_mean
from blackboard.vocabulary import Vocabulary
from rules.checks.slot_values import Holds, slots_hold
from rules.language.errors import RuleError
from rules.language.syntax import Template
from rules.language.templates import kind_templates, planning_templates
from rules.language.writing import template_text


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("names", nargs="*", metavar="NAME", help="templates to print; all of them unless given")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    vocabulary = Vocabulary()
    templates = {template.name: template for template in planning_templates(vocabulary)}
    for name in options.names:
        if name not in templates:
            near = did_you_mean(name.replace("_", "-"), templates)
            raise RuleError(f"there is no template '{name}'{near}")
    shown = [templates[name] for name in options.names] or list(templates.values())
    holds = {made.template.name: slots_hold(made) for made in kind_templates(vocabulary).values()}
    sys.stdout.write("\n\n".join(_text(template, holds.get(template.name, {})) for template in shown) + "\n")
    return 0


def _text(template: Template, holds: Mapping[str, Holds]) -> str:
    """Return a deftemplate with what each slot holds beside it."""
    lines = template_text(template).splitlines()
    width = max(map(len, lines[1:]))
    for index, slot in enumerate(template.slots, start=1):
        if slot.name in holds:
            lines[index] = f"{lines[index]:{width}}  ; {holds[slot.name]}"
    return "\n".join(lines)
