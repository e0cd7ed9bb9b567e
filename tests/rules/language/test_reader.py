"""Rule files are read with exact positions, and every fault is told at its place."""

from pathlib import Path

import pytest

from rules.language.errors import RuleErrors
from rules.language.reader import read_program, read_text
from rules.language.syntax import Assert, Call, Constant, Match, Position, Retract, Slot, Template, VariableUse
from rules.language.values import Symbol

ACTIVE_TARGET = """
(defrule active-target
?mode <- (mode end-wander-scan)
(position-index ?num)
?f <- (position-index ?num frontier-center ?xt ?yt)
=>
(retract ?mode ?f)
(assert (target ?xt ?yt))
(behavior-select "target-nav" "ON" ?xt ?yt) )
"""
TARGET = Template("target", (Slot("id"), Slot("x-m"), Slot("y-m")))


def faults(text: str, *templates: Template) -> list[str]:
    with pytest.raises(RuleErrors) as caught:
        read_text(text, "a.clp", templates)
    return [str(error) for error in caught.value.errors]


@pytest.mark.parametrize("templates", [(), (TARGET,)])
def test_the_rule_of_the_thesis_reads_as_printed_also_where_the_board_has_targets(
    templates: tuple[Template, ...],
) -> None:
    program = read_text(ACTIVE_TARGET, "thesis.clp", templates)
    assert program.templates == ()
    (rule,) = program.rules
    assert rule.name == "active-target"
    assert rule.position == Position("thesis.clp", 2, 1)
    bindings = [condition.binding for condition in rule.conditions if isinstance(condition, Match)]
    assert bindings == ["mode", None, "f"]
    retract, insert, select = rule.actions
    assert isinstance(retract, Retract)
    assert [fact.name for fact in retract.facts if isinstance(fact, VariableUse)] == ["mode", "f"]
    assert isinstance(insert, Assert)
    assert insert.facts[0].slots is None
    assert isinstance(select, Call)
    assert select.function == "behaviour-select"
    assert select.position == Position("thesis.clp", 9, 1)
    assert [a.value for a in select.arguments if isinstance(a, Constant)] == ["target-nav", "ON"]


def test_all_files_make_one_program_whatever_their_order(tmp_path: Path) -> None:
    (tmp_path / "rules.clp").write_text("(defrule go (t (a ?x)) => (assert (u (twice ?x) ?*g*)))\n")
    (tmp_path / "words.clp").write_text(
        "(deftemplate t (slot a)) (deffunction twice (?x) (* 2 ?x)) (defglobal ?*g* = (+ 1 2))\n"
    )
    program = read_program([tmp_path / "rules.clp", tmp_path / "words.clp"])
    assert [template.name for template in program.templates] == ["t"]
    assert [rule.name for rule in program.rules] == ["go"]
    assert program.rules[0].position.file == str(tmp_path / "rules.clp")


def test_templates_of_the_board_are_in_the_program_where_it_uses_them() -> None:
    other = Template("other", (Slot("id"),))
    program = read_text("(defrule r (target (id ?i) (x-m ?x)) => (printout t ?i ?x))", "a.clp", (TARGET, other))
    assert program.templates == (TARGET,)


def test_post_is_lowered_to_a_flat_call() -> None:
    program = read_text("(defrule r (go ?x) => (post (target (id a) (x-m ?x) (points 1 2))))")
    (post,) = program.rules[0].actions
    assert isinstance(post, Call)
    kinds = [argument.value if isinstance(argument, Constant) else type(argument) for argument in post.arguments]
    assert kinds == [Symbol("target"), Symbol("id"), Symbol("a"), Symbol("x-m"), VariableUse, Symbol("points"), Call]


def test_a_salience_may_be_a_global() -> None:
    program = read_text("(defglobal ?*high* = (* 2 50)) (defrule r (declare (salience ?*high*)) (a) => )")
    assert program.rules[0].salience == 100


def test_all_faults_of_a_file_are_told_in_order_each_once() -> None:
    text = "(defrule a (x ?y) => (foo 1) (bar ?z))\n(deffact d (a))\n(defrule b (x) (assert (y)))\n"
    assert faults(text) == [
        "a.clp:1:22: there is no function 'foo'",
        "a.clp:1:30: there is no function 'bar'",
        "a.clp:2:1: 'deffact' begins no construct; did you mean 'deffacts'?",
        "a.clp:3:1: the rule 'b': the => between conditions and actions is missing",
    ]


def test_the_error_as_a_whole_is_one_line_with_the_first_fault() -> None:
    with pytest.raises(RuleErrors, match=r"^a.clp:1:1: .*\(and 1 more: `ski rules check` lists them\)$"):
        read_text("(foo)\n(bar)", "a.clp")


FAULTS = {
    "(defrule a (x) => (assert (y))\n(defrule b (z) => )": "1:1: this bracket is not closed: (defrule a ...",
    "(defrule a (x (y) => )": "1:12: (x is not closed before the =>",
    "(defrule a (x)) => (y))": "1:1: the rule 'a': the => between conditions and actions is missing",
    "(defrule a (x) =>))": "1:19: this bracket stands outside of any construct: a bracket too many before it, or one missing?",
    '(defrule a (x "y) => )': "1:15: this string is not closed: its last quotation mark is missing",
    "(defrule a (x [y]) => )": "1:15: '[y]' is the name of an object, which rule files cannot have; write a symbol or a string",
    "(defrule a (x ?1) => )": "1:15: the name of a variable begins with a letter, not with '1'",
    "(defrule a (x 99999999999999999999) => )":
        "1:15: the integer 99999999999999999999 is out of range (64 bits); write it as a float",
    "(defrule a (x) => ) (defrule a (y) => )": "1:21: a second defrule 'a'; the first stands at a.clp:1:1",
    "(defrule a (not (x) (y)) => )": "1:12: (not ...) takes one condition; put several into (and ...)",
    "(defrule a (not (and (x ?y) ?f <- (z ?y))) => )":
        "1:35: ?f <- has no place within not and exists: no one fact is meant",
    "(defrule a (not (or (x ?y) (z))) (not (and (b ?y) (c ~?z))) => )":
        "1:55: ?z has no value here: a variable gets its value where it stands alone in a field, or first before &",
    "(defrule a (forall (x) (y)) => )":
        "1:12: (forall ...) is not in the language: write (not (and (pattern) (not ...)))",
    "(defrule a (logical (x)) => )":
        "1:12: (logical ...) is not in the language: retract in a rule of its own what no longer holds",
    "(defrule a (x $? y $?) => )":
        "1:20: a second $? in one pattern: only one may stand there; test with member$ or subseq$ instead",
    "(defrule a (x ?y|b) => )":
        "1:15: ?y has no value here: a variable gets its value where it stands alone in a field, or first before &",
    "(defrule a (x ?y&b&c) => )": "1:20: no value is b and c: this can never match",
    "(defrule a (x b&~b) => )": "1:18: no value is b and not b: this can never match",
    "(defrule a (x ?y&:(> ?y b)) => )": "1:25: (> ...) takes a number here, not a symbol",
    '(defrule a (x ?y) => (nth$ "1" ?y))': "1:28: (nth$ ...) takes an integer here, not a string",
    "(defrule a (x ?y) => (length$ ?y))": "1:31: (length$ ...) takes a multifield here, not one field",
    "(defrule a (x $?y) (test (> ?y 1)) => )": "1:29: (> ...) takes a number here, not several ($?)",
    "(defrule a (x ?y) => (+ 1 (str-cat ?y)))": "1:27: (+ ...) takes a number here, not what (str-cat ...) returns",
    "(defrule a (x $?y) => (assert (target (id $?y))))": "1:43: the slot 'id' holds one value, not a multifield",
    "(defrule a (x =(create$ 1)) => )": "1:15: one field is never what (create$ ...) returns: a multifield",
    "(defrule a => (assert (x = 3)))": "1:26: '=' must be followed by an expression in brackets: =(...)",
    "(defrule MAIN::a (x) => )": "1:10: 'MAIN::a': there are no modules; leave out what stands before the ::",
    "(defrule a (B::x) => )": "1:13: 'B::x': there are no modules; leave out what stands before the ::",
    "(defrule a (x b&?) => )": "1:17: ? joined to a constraint says nothing: leave it out, or name it: ?x",
    "(defrule a (x ?*g*) => ) (defglobal ?*g* = 1)": "1:15: ?*g* may not stand here: write ?x&:(eq ?x ?*g*), or use = for numbers",
    "(defrule a (x (y 1)) => )": "1:15: there is no template 'x' with a slot 'y'; is its deftemplate missing?",
    "(defrule a (target (x-n ?x)) => )": "1:20: the template 'target' has no slot 'x-n'; did you mean 'x-m'?",
    "(defrule a (target (x-m ?x)) => (assert (target 1 2)))":
        "1:20: 'target' is used as an ordered fact at a.clp:1:41, so it has no slots",
    "(deftemplate target (slot a))": "1:1: 'target' is a template of the board: choose another name",
    "(deftemplate t (slot a (type INTEGER)))":
        "1:24: (type ...) is not in the language; values are not checked against types here: leave it out",
    "(deftemplate t (slot a) (slot a))": "1:25: the slot 'a' stands there twice",
    "(deftemplate t (slot a (default 1 2)))": "1:24: the default of a slot is one value",
    "(deftemplate t (slot a (default ?NONE)))":
        "1:24: ?NONE and ?DERIVE are not in the language: write a value, or leave (default ...) out",
    "(deffacts d (x ?y))": "1:16: ?y: there are no variables in a value that is set at the start",
    "(defglobal ?*g* 3)": "1:12: write ?*g* = value",
    "(defglobal ?*g* = 3 ?*g* = 4)": "1:21: a second global ?*g*; the first stands at a.clp:1:12",
    "(defglobal ?*g* = (/ 1 0))": "1:19: (/ ...) divides by zero",
    "(deffunction + (?x) 1)": "1:1: '+' is a function of the language: choose another name",
    "(deffunction f (?x) (assert (y)))": "1:21: (assert ...) has no place in a deffunction: functions change nothing",
    "(deffunction f (?x) ?y)": "1:21: ?y has no value here; known: x",
    "(deffunction f (?x) (+ 1 (if ?x then 1)))":
        "1:26: (if ...) may not stand within an expression: put it into a deffunction and call that",
    "(defrule a (declare (salience 1.5)) (x) => )": "1:31: a salience is an integer or a ?*global* that holds one",
    "(defrule a (declare (salience 20000)) (x) => )": "1:31: the salience 20000 is out of range: -10000 to 10000",
    "(defrule a (declare (auto-focus TRUE)) (x) => )": "1:12: write (declare (salience n)); nothing else can be declared",
    "(defrule a (x) => (retract ?f))": "1:28: ?f is no fact; bind it in a condition: ?fact <- (pattern)",
    "(defrule a ?f <- (x) (y ?f) => (retract ?f))": "1:25: ?f is a fact; facts are for retract and modify only",
    "(defrule a ?f <- (x) => (modify ?f (y 1)))": "1:25: 'x' is no template: retract the fact and assert another",
    "(defrule a (x) => (bind ?y))": "1:19: (bind ?y) has no value to bind",
    "(defrule a (x) => (sqrt 1 2))": "1:19: (sqrt ...) takes 1 argument, not 2",
    "(defrule a (x) => (while TRUE (halt)))":
        "1:19: there is no function 'while': rules repeat by matching facts: assert a counter or write a recursive deffunction",
    "(defrule a (x) => (printout file 1))": "1:19: printout writes to t only: (printout t ... crlf)",
    "(defrule a (x ?y) (test (now)) => )": "1:25: (now ...) may stand on the right-hand side of a rule only, not in a condition",
    "(defrule a (x ?y) (test ?y) => )": "1:19: (test ...) takes one expression in brackets: (test (> ?x 3))",
    "(defrule a (x ?y) (z $?y) => )": "1:22: ?y is used for one field and for several ($?y)",
    "(defrule a (or (x ?y) (z)) => (printout t ?y))": "1:43: ?y has no value here",
    "(defrule a (not (x ?y)) => (printout t ?y))": "1:40: ?y has no value here",
    "(defmodule M)": "1:1: 'defmodule' begins no construct: there are no modules: use salience, or a fact that names the phase",
    "(defrule a (x) => (post (target (id a)) 3))": "1:19: write (post (kind (slot value) ...))",
}  # fmt: skip


@pytest.mark.parametrize(("text", "told"), FAULTS.items())
def test_what_is_wrong_is_told_with_its_place_and_what_to_do(text: str, told: str) -> None:
    assert f"a.clp:{told}" in faults(text, TARGET)


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    (tmp_path / "latin.clp").write_bytes(b"; caf\xe9\n")
    with pytest.raises(RuleErrors) as caught:
        read_program([tmp_path / "none.clp", tmp_path / "latin.clp"])
    assert len(caught.value.errors) == 2
    assert "none.clp: cannot be read: No such file" in str(caught.value.errors[0])
    assert "latin.clp: cannot be read: it is not UTF-8" in str(caught.value.errors[1])
