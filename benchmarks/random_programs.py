"""Random rule files, and facts to feed them: everything the language has, in few relations and values, so that much happens.

A seed gives the same program always. Used by benchmarks/lockstep.py and by tests/rules/engines/test_lockstep.py.
"""

from random import Random

from rules.language.values import FactValue, Symbol, Value

HEADER = """
(deftemplate part (slot name) (slot size (default 1)) (multislot tags))
(deftemplate place (slot name (default red)) (slot near))
(defglobal ?*limit* = 2 ?*seen* = 0)
(deffunction double (?n) (* ?n 2))
(deffunction greater (?a ?b) (if (> ?a ?b) then ?a else ?b))
(deffunction many ($?all) (length$ ?all))
"""
CONSTANTS = ("0", "1", "1", "2", "2", "1.0", "red", "red", "blue", '"red"')
NUMBERS = ("0", "1", "2", "1.0")
RELATIONS = {"on": 1, "sees": 2, "link": 2, "row": None}
SLOTS = {"part": ("name", "size"), "place": ("name", "near")}


class Writer:
    """Writes one program."""

    def __init__(self, seed: int) -> None:
        self.random = Random(seed)
        self.names = 0

    def program(self) -> str:
        rules = [self.rule(number) for number in range(self.random.randint(2, 6))]
        facts = [self.fact_form({}) for _ in range(self.random.randint(2, 8))]
        return "\n".join([HEADER, f"(deffacts start {' '.join(facts)})", *rules])

    def chance(self, probability: float) -> bool:
        return self.random.random() < probability

    def fresh(self, start: str) -> str:
        self.names += 1
        return f"{start}{self.names}"

    def rule(self, number: int) -> str:
        bound: dict[str, str] = {}  # name to "one", "many" or "fact:relation"
        conditions = [self.condition(bound, depth=0) for _ in range(self.random.randint(1, 4))]
        if self.chance(0.03):
            conditions = []
            bound = {}
        actions = [self.action(bound, depth=0) for _ in range(self.random.randint(1, 3))]
        salience = f"(declare (salience {self.random.randint(-2, 2)})) " if self.chance(0.4) else ""
        return f"(defrule rule-{number} {salience}{' '.join(conditions)} => {' '.join(actions)})"

    def condition(self, bound: dict[str, str], depth: int) -> str:
        """Return a condition; what it binds for those after it is added to `bound`."""
        choice = self.random.random()
        if choice < 0.58 or depth > 2:
            return self.bound_pattern(bound, depth)
        if choice < 0.68:
            return f"(test {self.truth(bound)})"
        if choice < 0.80:
            return f"(not {self.inner(bound, depth)})"
        if choice < 0.89:
            inner = dict(bound)
            return f"(exists {' '.join(self.inner_row(inner, depth))})"
        if choice < 0.95:
            ways = [self.inner(bound, depth) for _ in range(self.random.randint(2, 3))]
            return f"(or {' '.join(ways)})"
        return f"(and {' '.join(self.condition(bound, depth + 1) for _ in range(2))})"

    def inner(self, bound: dict[str, str], depth: int) -> str:
        """Return a condition whose variables stay inside."""
        inner = dict(bound)
        if self.chance(0.6):
            return self.pattern(inner)
        if self.chance(0.6):
            return f"(and {' '.join(self.inner_row(inner, depth, least=2))})"
        return self.condition(inner, depth + 1)

    def inner_row(self, inner: dict[str, str], depth: int, least: int = 1) -> list[str]:
        row = [self.pattern(inner)]
        while len(row) < least or self.chance(0.4):
            row.append(self.condition_inside(inner, depth + 1))
        return row

    def condition_inside(self, bound: dict[str, str], depth: int) -> str:
        choice = self.random.random()
        if choice < 0.5:
            return self.pattern(bound)
        if choice < 0.75:
            return f"(test {self.truth(bound)})"
        return f"(not {self.pattern(dict(bound))})" if depth > 1 or choice < 0.9 else self.condition(dict(bound), depth)

    def bound_pattern(self, bound: dict[str, str], depth: int) -> str:
        if depth == 0 and self.chance(0.4):
            pattern = self.pattern(bound)
            name = self.fresh("f")
            bound[name] = f"fact:{pattern[1:].split()[0].rstrip(')')}"
            return f"?{name} <- {pattern}"
        return self.pattern(bound)

    def pattern(self, bound: dict[str, str]) -> str:
        if self.chance(0.4):
            template = self.random.choice(sorted(SLOTS))
            slots = [f"({slot} {self.field(bound)})" for slot in SLOTS[template] if self.chance(0.6)]
            if template == "part" and self.chance(0.4):
                slots.append(f"(tags {self.fields(bound)})")
            return f"({' '.join([template, *slots])})"
        relation = self.random.choice(sorted(RELATIONS))
        arity = RELATIONS[relation]
        if arity is None:
            return f"({relation} {self.fields(bound)})"
        return f"({' '.join([relation, *(self.field(bound) for _ in range(arity))])})"

    def fields(self, bound: dict[str, str]) -> str:
        """Return fields in a row, at most one of them a multifield."""
        before = [self.field(bound) for _ in range(self.random.randint(0, 2))]
        if before and not self.chance(0.7):
            return " ".join(before)
        after = [self.field(bound, computed=False) for _ in range(self.random.randint(0, 2 - len(before)))]
        return " ".join([*before, self.stretch(bound), *after])

    def stretch(self, bound: dict[str, str]) -> str:
        if self.chance(0.3):
            return "$?"
        many = [name for name, kind in bound.items() if kind == "many"]
        if many and self.chance(0.3):
            return f"$?{self.random.choice(many)}"
        name = self.fresh("m")
        bound[name] = "many"
        if self.chance(0.25):
            return f"$?{name}&:(> (length$ ?{name}) {self.random.randint(0, 1)})"
        return f"$?{name}"

    def field(self, bound: dict[str, str], computed: bool = True) -> str:
        """Return what one field must be; CLIPS 6.42 crashes where one that must be `computed` stands after a `$?`."""
        choice = self.random.random()
        known = [name for name, kind in bound.items() if kind == "one"]
        if choice < 0.20:
            return "?"
        if choice < 0.28:
            return self.random.choice(CONSTANTS)
        if choice < 0.33:
            return f"{self.random.choice(CONSTANTS)}|{self.random.choice(CONSTANTS)}"
        if choice < 0.40:
            return f"~{self.random.choice(CONSTANTS)}"
        if choice < 0.55 and known:
            return f"?{self.random.choice(known)}"
        if choice < 0.62 and known:
            return f"~?{self.random.choice(known)}"
        if choice < 0.64 and computed:
            return f"=({self.random.choice(('+', '-', '*'))} {self.number(bound)} {self.number(bound)})"
        name = self.fresh("v")
        bound[name] = "one"
        if self.chance(0.7):
            return f"?{name}"
        return f"?{name}&{self.connected(bound, name, computed)}"

    def connected(self, bound: dict[str, str], name: str, computed: bool) -> str:
        known = [other for other, kind in bound.items() if kind == "one" and other != name]
        choice = self.random.random()
        if choice < 0.25:
            return f"~{self.random.choice(CONSTANTS)}"
        if choice < 0.4:
            return f"{self.random.choice(CONSTANTS)}|{self.random.choice(CONSTANTS)}"
        if choice < 0.55 and known:
            return f"~?{self.random.choice(known)}"
        if choice < 0.65 and known and computed:
            return f"?{self.random.choice(known)}|{self.random.choice(CONSTANTS)}"
        if choice < 0.7:
            return f"~{self.random.choice(CONSTANTS)}&~{self.random.choice(CONSTANTS)}"
        return f"{'~' if self.chance(0.15) else ''}:{self.truth(bound, of=name)}"

    def number(self, bound: dict[str, str]) -> str:
        """Return an expression that is a number whatever the facts are."""
        choice = self.random.random()
        if choice < 0.5:
            return self.random.choice(NUMBERS)
        if choice < 0.6:
            return "?*limit*"
        many = [name for name, kind in bound.items() if kind == "many"]
        if choice < 0.75 and many:
            return f"(length$ ?{self.random.choice(many)})"
        if choice < 0.85:
            return f"(double {self.random.choice(NUMBERS)})"
        return f"(greater {self.random.choice(NUMBERS)} {self.random.choice(NUMBERS)})"

    def truth(self, bound: dict[str, str], of: str | None = None) -> str:
        """Return an expression for a test, or for the field that binds the variable `of`; only numbers are compared as such.

        Comparing others makes CLIPS stop the actions, or the deffacts, that asserted the fact; experta only does not match.
        """
        known = [name for name, kind in bound.items() if kind == "one"]
        name = of or (self.random.choice(known) if known else None)
        if name is None:
            return (
                f"({self.random.choice(('>', '<', '>=', '<=', '=', '<>'))} {self.number(bound)} {self.number(bound)})"
            )
        choice = self.random.random()
        other = self.random.choice(known) if known else name
        if choice < 0.35:
            compare = self.random.choice((">", "<", ">=", "<=", "=", "<>"))
            return f"(and (numberp ?{name}) ({compare} ?{name} {self.number(bound)}))"
        if choice < 0.5:
            return f"({self.random.choice(('eq', 'neq'))} ?{name} ?{other} {self.random.choice(CONSTANTS)})"
        if choice < 0.65:
            return f"({self.random.choice(('numberp', 'symbolp', 'stringp', 'integerp', 'floatp'))} ?{name})"
        if choice < 0.75:
            return f"(not (eq ?{name} {self.random.choice(CONSTANTS)}))"
        if choice < 0.85:
            return f"(or (eq ?{name} {self.random.choice(CONSTANTS)}) {self.truth(bound, of)})"
        many = [one for one, kind in bound.items() if kind == "many"]
        if many:
            return f"(member$ ?{name} ?{self.random.choice(many)})"
        return f"(eq ?{name} ?{other})"

    def value(self, bound: dict[str, str]) -> str:
        known = [name for name, kind in bound.items() if kind == "one"]
        if known and self.chance(0.6):
            return f"?{self.random.choice(known)}"
        return self.number(bound) if self.chance(0.3) else self.random.choice(CONSTANTS)

    def values(self, bound: dict[str, str]) -> str:
        many = [name for name, kind in bound.items() if kind == "many"]
        row = [self.value(bound) for _ in range(self.random.randint(0, 3))]
        if many and self.chance(0.5):
            row.append(f"?{self.random.choice(many)}")
        return " ".join(row)

    def fact_form(self, bound: dict[str, str]) -> str:
        if self.chance(0.4):
            template = self.random.choice(sorted(SLOTS))
            slots = [f"({slot} {self.value(bound)})" for slot in SLOTS[template] if self.chance(0.7)]
            if template == "part" and self.chance(0.5):
                slots.append(f"(tags {self.values(bound)})")
            return f"({' '.join([template, *slots])})"
        relation = self.random.choice(sorted(RELATIONS))
        arity = RELATIONS[relation]
        if arity is None:
            return f"({relation} {self.values(bound)})"
        return f"({' '.join([relation, *(self.value(bound) for _ in range(arity))])})"

    def action(self, bound: dict[str, str], depth: int) -> str:
        facts = [name for name, kind in bound.items() if kind.startswith("fact:")]
        templated = [name for name in facts if bound[name].removeprefix("fact:") in SLOTS]
        choice = self.random.random()
        if choice < 0.35:
            return f"(assert {self.fact_form(bound)})"
        if choice < 0.55 and facts:
            name = self.random.choice(facts)
            bound.pop(name)
            return f"(retract ?{name})"
        if choice < 0.72 and templated:
            name = self.random.choice(templated)
            slot = self.random.choice(SLOTS[bound[name].removeprefix("fact:")])
            return f"(modify ?{name} ({slot} {self.value(bound)}))"
        if choice < 0.78:
            name = self.fresh("n")
            action = f"(bind ?{name} {self.value(bound)})"
            bound[name] = "one"
            return action
        if choice < 0.83:
            return "(bind ?*seen* (+ ?*seen* 1))" if self.chance(0.7) else f"(bind ?*limit* {self.number(bound)})"
        if choice < 0.92 and depth == 0:
            then, otherwise = dict(bound), dict(bound)
            return f"(if {self.truth(bound)} then {self.action(then, 1)} else {self.action(otherwise, 1)})"
        known = [name for name, kind in bound.items() if kind == "one"]
        if choice < 0.94 and known and depth == 0:  # fails where that is no number
            return f"(if (> ?{self.random.choice(known)} 0) then (printout t positive crlf))"
        return f"(printout t {self.value(bound)} crlf)"

    def fact(self) -> FactValue:
        """Return a fact to be asserted from outside."""
        if self.chance(0.4):
            if self.chance(0.5):
                tags = tuple(self.constant() for _ in range(self.random.randint(0, 3)))
                return FactValue("part", (self.constant(), self.constant(), tags), ("name", "size", "tags"))
            return FactValue("place", (self.constant(), self.constant()), ("name", "near"))
        relation = self.random.choice(sorted(RELATIONS))
        arity = RELATIONS[relation]
        count = self.random.randint(0, 3) if arity is None else arity
        return FactValue(relation, tuple(self.constant() for _ in range(count)))

    def constant(self) -> Value:
        return self.random.choice(
            (0, 1, 1, 2, 2, 1.0, Symbol("red"), Symbol("red"), Symbol("blue"), "red"),
        )
