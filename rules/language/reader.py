"""Rule files to a Program: all files together, every fault found told with its place.

`read_program` takes files, `read_text` and `read_texts` what stands in them; `templates` are those that follow from the board's
vocabulary. Constructs may use each other in any order. Raises RuleErrors.
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from blackboard.errors import did_you_mean
from rules.language.errors import RuleError, RuleErrors
from rules.language.evaluation import evaluate
from rules.language.reading import constructs
from rules.language.reading.expressions import Arity
from rules.language.reading.forms import CONSTRUCTS, Form, top_forms
from rules.language.reading.shadows import shadows
from rules.language.reading.surroundings import Surroundings
from rules.language.reading.tokens import tokens
from rules.language.reading.vocabulary import ARITIES, FACT_ACTIONS, hint
from rules.language.scope import function_faults, rule_faults
from rules.language.syntax import Function, Global, Position, Program, Template
from rules.language.values import Value


def read_program(paths: Iterable[Path | str], templates: Sequence[Template] = ()) -> Program:
    """Read rule files as one program."""
    faults: list[RuleError] = []
    forms: list[Form] = []
    for path in paths:
        try:
            text = Path(path).read_text(encoding="utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
            faults.append(RuleError(f"{path}: cannot be read: {reason}"))
            continue
        forms += top_forms(tokens(text, str(path), faults), faults)
    return _program(forms, templates, faults)


def read_text(text: str, file: str = "<text>", templates: Sequence[Template] = ()) -> Program:
    """Read the text of one rule file; `file` is its name in positions."""
    return read_texts({file: text}, templates)


def read_texts(texts: Mapping[str, str], templates: Sequence[Template] = ()) -> Program:
    """Read the texts of several rule files, by the files' names, as one program."""
    faults: list[RuleError] = []
    forms: list[Form] = []
    for file, text in texts.items():
        forms += top_forms(tokens(text, file, faults), faults)
    return _program(forms, templates, faults)


def _program(forms: Sequence[Form], given: Sequence[Template], faults: list[RuleError]) -> Program:
    by_head: dict[str, list[Form]] = {head: [] for head in CONSTRUCTS}
    for form in forms:
        if form.head in by_head:
            by_head[form.head].append(form)
        else:
            near = hint(form.head) or did_you_mean(form.head, CONSTRUCTS)
            faults.append(RuleError(f"'{form.head}' begins no construct{near}", form.position))
    known = Surroundings(faults=faults, shadows=shadows(forms, {t.name for t in given}))
    known.templates = {t.name: t for t in given if t.name not in known.shadows}
    _forward(by_head, known)
    templates = _templates(by_head["deftemplate"], known)
    functions = _functions(by_head["deffunction"], known)
    globals_, values = _globals(by_head["defglobal"], known, functions)
    deffacts, rules = [], []
    for form in _named_once(by_head["deffacts"], known):
        with known.collecting():
            deffacts.append(constructs.read_deffacts(form, known))
    for form in _named_once(by_head["defrule"], known):
        with known.collecting():
            before = len(faults)
            rules.append(rule := constructs.read_rule(form, known, values))
            if len(faults) == before:  # else what is missing would be told a second time
                faults += rule_faults(rule, known.templates)
    boards = [t for t in given if t.name in known.used and t.name in known.templates]
    program = Program((*boards, *templates), tuple(deffacts), tuple(globals_), tuple(functions), tuple(rules))
    if faults:
        raise RuleErrors(faults)
    return program


def _named_once(forms: Iterable[Form], known: Surroundings, taken: Mapping[str, str] = {}) -> list[Form]:
    """Return the forms whose names nothing else has; a second definition is told with the place of the first."""
    first: dict[str, Position] = {}
    kept: list[Form] = []
    for form in forms:
        with known.collecting():
            name = constructs.named(form)[0]
            if name in taken:
                raise RuleError(f"'{name}' {taken[name]}: choose another name", form.position)
            if name in first:
                raise RuleError(f"a second {form.head} '{name}'; the first stands at {first[name]}", form.position)
            first[name] = form.position
            kept.append(form)
    return kept


def _forward(by_head: Mapping[str, Sequence[Form]], known: Surroundings) -> None:
    """Note functions and globals before anything that uses them is read."""
    for form in by_head["deffunction"]:
        try:
            name, _, parameters, more, _ = constructs.function_header(form)
        except RuleError:
            continue  # told when the function itself is read
        arity: Arity = (len(parameters), None if more is not None else len(parameters))
        known.functions.setdefault(name, arity)
    for form in by_head["defglobal"]:
        for name, position in constructs.global_names(form):
            if name in known.globals:
                text = f"a second global ?*{name}*; the first stands at {known.globals[name]}"
                known.faults.append(RuleError(text, position))
            known.globals.setdefault(name, position)


def _templates(forms: Sequence[Form], known: Surroundings) -> list[Template]:
    taken = dict.fromkeys(known.templates, "is a template of the board")
    templates: list[Template] = []
    for form in _named_once(forms, known, taken):
        with known.collecting():
            templates.append(constructs.read_template(form, known))
    known.templates |= {template.name: template for template in templates}
    return templates


def _functions(forms: Sequence[Form], known: Surroundings) -> list[Function]:
    taken = dict.fromkeys((*ARITIES, *FACT_ACTIONS), "is a function of the language")
    functions: list[Function] = []
    for form in _named_once(forms, known, taken):
        with known.collecting():
            before = len(known.faults)
            functions.append(function := constructs.read_function(form, known))
            if len(known.faults) == before:
                known.faults += function_faults(function)
    return functions


def _globals(
    forms: Sequence[Form], known: Surroundings, functions: Sequence[Function]
) -> tuple[list[Global], dict[str, Value]]:
    """Return the globals with their values at the start."""
    found: list[Global] = []
    values: dict[str, Value] = {}
    by_name = {function.name: function for function in functions}
    for form in forms:
        with known.collecting():
            for one in constructs.read_globals(form, known):
                found.append(one)
                values[one.name] = evaluate(one.value, {}, values, by_name)
    return found, values
