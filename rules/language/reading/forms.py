"""Tokens to bracketed forms; an unclosed one is told at its opening bracket, and reading goes on with the next construct."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from rules.language.errors import RuleError
from rules.language.reading.tokens import Token, TokenKind
from rules.language.syntax import Position
from rules.language.values import Symbol

CONSTRUCTS = ("deftemplate", "deffacts", "defglobal", "deffunction", "defrule")
DEEPEST_FORM = 100  # brackets within brackets; far more than anyone writes, far less than Python's stack takes


@dataclass(slots=True)
class Form:
    """What stands between two brackets."""

    position: Position
    items: list["Form | Token"] = field(default_factory=list)

    @property
    def head(self) -> str:
        """The symbol that it begins with, or nothing."""
        return word(self.items[0]) if self.items else ""

    def __str__(self) -> str:
        return f"({self.head or '...'}"


Node = Form | Token


def word(node: Node) -> str:
    """Return the name of a symbol, or nothing where the node is none."""
    return node.value.name if isinstance(node, Token) and isinstance(node.value, Symbol) else ""


def name_of(node: Node | None, what: str, after: Position) -> str:
    """Return a symbol's name; RuleError where something else stands there."""
    if node is None:
        raise RuleError(f"{what} is missing", after)
    if not word(node):
        raise RuleError(f"{what} must be a symbol (a word without quotation marks)", node.position)
    if "::" in word(node):
        raise RuleError(f"'{word(node)}': there are no modules; leave out what stands before the ::", node.position)
    return word(node)


class _Nesting:
    """The forms that are open, and what became whole."""

    def __init__(self, faults: list[RuleError]) -> None:
        self.faults = faults
        self.open: list[Form] = []
        self.stray = False  # something stood outside of constructs: told once, until the next construct

    def add(self, token: Token) -> Form | None:
        """Take one more token; return the construct that it closes."""
        if token.kind is TokenKind.OPEN:
            self.open.append(Form(token.position))
            return None
        if token.kind is TokenKind.CLOSE:
            return self._close(token)
        if not self.open:
            self._outside(token.position, f"'{token.text}'")
            return None
        if token.text in CONSTRUCTS and not self.open[-1].items and len(self.open) > 1:
            self.faults.append(_unclosed(self.open[0]))
            del self.open[:-1]
        elif token.text == "=>" and len(self.open) > 1 and self.open[0].head == "defrule":
            self.faults.append(RuleError(f"{self.open[-1]} is not closed before the =>", self.open[-1].position))
            del self.open[1:]
        self.open[-1].items.append(token)
        return None

    def _close(self, token: Token) -> Form | None:
        if not self.open:
            self._outside(token.position, "this bracket")
            return None
        whole = self.open.pop()
        if self.open:
            self.open[-1].items.append(whole)
            return None
        if self.stray and whole.head not in CONSTRUCTS:
            return None
        self.stray = False
        return whole

    def _outside(self, position: Position, what: str) -> None:
        if not self.stray:
            text = f"{what} stands outside of any construct: a bracket too many before it, or one missing?"
            self.faults.append(RuleError(text, position))
        self.stray = True


def top_forms(tokens: Iterable[Token], faults: list[RuleError]) -> Iterator[Form]:
    """Yield the whole forms of a file; faults of brackets go into `faults`."""
    nesting = _Nesting(faults)
    for token in tokens:
        whole = nesting.add(token)
        if whole is not None:
            yield whole
        if len(nesting.open) > DEEPEST_FORM:
            faults.append(RuleError(f"brackets within brackets, more than {DEEPEST_FORM} deep", token.position))
            return
    if nesting.open:
        faults.append(_unclosed(nesting.open[0]))


def _unclosed(form: Form) -> RuleError:
    name = f" {word(form.items[1])}" if len(form.items) > 1 and word(form.items[1]) else ""
    return RuleError(f"this bracket is not closed: {form}{name} ...", form.position)
