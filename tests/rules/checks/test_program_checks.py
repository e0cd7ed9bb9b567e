"""Each fault that the checks know, by an example; and sound rules have none."""

import pytest

from blackboard.component import Parts
from blackboard.vocabulary import Vocabulary
from rules.checks.names import Board
from rules.checks.program import findings, refuse_faults
from rules.language.errors import RuleErrors
from rules.language.reader import read_text
from rules.language.templates import planning_templates

VOCABULARY = Vocabulary()
TEMPLATES = planning_templates(VOCABULARY)
PARTS = Parts(
    behaviours={"path_following": (("x_m", "y_m"), 0), "wall_following": (("side",), 1), "curiosity": ((), 0)},
    levels=("explore",),
    sources={"eou_grid": 50.0},
    vocabulary=VOCABULARY,
    owners={},
)
BOARDS = {certain: Board(PARTS, certain) for certain in (True, False)}


def found(text: str, *, certain: bool = True) -> list[str]:
    program = read_text(text, "a.clp", TEMPLATES)
    return [str(finding).removeprefix("a.clp:") for finding in findings(program, BOARDS[certain])]


NAMES = [
    (
        "(behaviour-select curiosty on)",
        "1:37: error: behaviour-select: this mission has no behaviour 'curiosty'; did you mean 'curiosity'?",
    ),
    ("(behaviour-select curiosity onn)", "1:47: error: behaviour-select: onn must be on or off"),
    ("(behaviour-select path-following on 1.0)", "1:19: error: behaviour 'path_following' takes x_m y_m; not 1"),
    ("(motivate wall_following left 2)", "1:19: error: behaviour 'wall_following' takes side; not 2"),
    ("(motivate 3)", "1:29: error: motivate: 3 must be the name of a behaviour"),
    (
        "(focus eou_gird 3)",
        "1:26: error: focus: this mission has no knowledge source 'eou_gird'; did you mean 'eou_grid'?",
    ),
    ("(focus eou_grid maybe)", "1:35: error: focus: maybe must be a rating (a number), on or off"),
    (
        "(set-gain exploer 1)",
        "1:29: error: set-gain: this mission has no behaviour or level 'exploer'; did you mean 'explore'?",
    ),
    ("(set-gain explore -1)", "1:37: error: set-gain: -1 must be a number in [0, 100]"),
    ("(set-threshold explore 2000)", "1:42: error: set-threshold: 2000 must be a number in [0, 1000]"),
    ("(post (targt (id a)))", "1:26: error: post: no kind has the template 'targt'; did you mean 'target'?"),
    ("(post (target (reason frontier)))", "1:19: error: post: 'target' needs (id ...)"),
    ("(post (mission (id a) (state done)))", "1:19: error: post: 'mission' takes no id: there is only one"),
    (
        "(post (target (id a) (reson frontier)))",
        "1:19: error: 'target' has no slot 'reson' to post; did you mean 'reason'?",
    ),
    ("(post (mission (state don)))", "1:19: error: post: 'mission': Invalid enum value 'don' - at state"),
    (
        "(if (eq 1 2) then (bind ?y (+ 1 2)) (behaviour-select curiosit on))",
        "1:73: error: behaviour-select: this mission has no behaviour 'curiosit'; did you mean 'curiosity'?",
    ),
]


@pytest.mark.parametrize(("action", "told"), NAMES)
def test_what_is_asked_of_the_board_must_be_there_and_fit(action: str, told: str) -> None:
    assert found(f"(defrule a (b) => {action}) (deffacts d (b))") == [told]


def test_what_shipped_missions_do_not_have_is_a_warning_where_no_mission_is_given() -> None:
    (told,) = found("(defrule a => (focus my_source 3))", certain=False)
    assert told.startswith("1:22: warning: focus: the shipped missions have no knowledge source 'my_source'")


NEVER = [
    (
        "(defrule a (node go) => ) (deffacts d (mode go))",
        "1:12: warning: nothing asserts (node ...), so the rule 'a' cannot fire; did you mean 'mode'?",
    ),
    (
        "(defrule a (mode gone) => ) (deffacts d (mode go))",
        "1:12: warning: nothing asserts (mode ...) with gone, so the rule 'a' cannot fire; did you mean 'go'?",
    ),
    (
        "(defrule a (mode go ?) => ) (deffacts d (mode go))",
        "1:12: warning: nothing asserts a (mode ...) that matches this, so the rule 'a' cannot fire",
    ),
    (
        "(defrule a (mode ?x) => (assert (seen ?x))) (defrule b (seen ? ?) => ) (deffacts d (mode go))",
        "1:56: warning: nothing asserts a (seen ...) that matches this, so the rule 'b' cannot fire",
    ),
    (
        "(defrule a (not (given-upp)) => (assert (given-up)))",
        "1:17: warning: nothing asserts (given-upp ...), so this (not ...) always holds; did you mean 'given-up'?",
    ),
    (
        "(deftemplate t (slot a) (slot b)) (deffacts d (t (a 1))) (defrule a (t (b ?b)) => )",
        "1:75: warning: nothing sets the slot 'b' of 't': it always holds its default",
    ),
    (
        "(deftemplate t (slot a (default 2))) (deffacts d (t)) (defrule a ?f <- (t (a 1)) => (modify ?f (a 3)))",
        "1:72: warning: nothing asserts (t ...) with 1 in the slot 'a', so the rule 'a' cannot fire",
    ),
    (
        "(defrule a (trap (trap no-progres)) => )",
        "1:24: warning: the slot 'trap' of 'trap' is never no-progres; did you mean 'no-progress'?",
    ),
    (
        "(defrule a (battery (charge-fraction 1)) => )",
        "1:38: warning: the slot 'charge-fraction' of 'battery' never holds an integer such as 1; write 1.0",
    ),
    (
        '(defrule a (component (id "travel")) => )',
        "1:27: warning: the slot 'id' of 'component' never holds a string such as \"travel\"; "
        "write travel without quotation marks",
    ),
    (
        "(defrule a (behaviour (id path-following)) => )",
        "1:27: warning: this mission has no behaviour 'path-following', so this never matches; "
        "did you mean 'path_following'?",
    ),
    (
        "(defrule a (b ?x&:(> ?x 5)&:(< ?x 3)) => ) (deffacts d (b 4))",
        "1:29: warning: no number is left for ?x beside what was asked of it before, so the rule 'a' cannot fire",
    ),
    (
        "(defrule a (b ?x) (c ?x&:(>= ?*g* ?x)) (test (and (> ?x 3) (integerp ?x))) => )"
        " (defglobal ?*g* = 3) (deffacts d (b 4) (c 4))",
        "1:51: warning: no number is left for ?x beside what was asked of it before, so the rule 'a' cannot fire",
    ),
    (
        "(defrule a (b ?x&1|2) (test (> ?x 2)) => ) (deffacts d (b 1))",
        "1:29: warning: ?x is 1 or 2 already, so the rule 'a' cannot fire",
    ),
    (
        "(defrule a (b ?x&1|2) (b ?x&3) => ) (deffacts d (b 1) (b 3))",
        "1:26: warning: ?x is 1 or 2 already, so the rule 'a' cannot fire",
    ),
]


@pytest.mark.parametrize(("text", "told"), NEVER)
def test_what_can_never_match_is_told(text: str, told: str) -> None:
    assert found(text) == [told]


def test_rules_that_wait_for_each_other_are_told_and_what_hangs_on_a_faulty_one_is_not() -> None:
    circle = "(defrule a (x) => (assert (y))) (defrule b (y) => (assert (x)))"
    assert [line.split(":", 2)[2] for line in found(circle)] == [
        f" warning: the rule '{name}' cannot fire: what it waits for is asserted only by rules that wait for it in turn"
        for name in "ab"
    ]
    assert len(found("(defrule a (x) => (assert (y))) (defrule b (y) => (assert (z))) (defrule c (z) => )")) == 1


SOUND = [
    "(defrule a (mode ?m) (uses ?m ?b) => (behaviour-select ?b on)) (deffacts d (mode go) (uses go curiosity))",
    "(defrule a (or (mode never) (mode go)) => ) (deffacts d (mode go))",
    "(defrule a (mode stay|go) => ) (deffacts d (mode go))",
    "(defrule a (list $?x) => (assert (other $?x))) (defrule b (other 1 2 3) => ) (deffacts d (list))",
    "(deftemplate t (multislot m)) (defrule a ?f <- (t (m $? x)) => (modify ?f (m 1 2))) (deffacts d (t (m x)))",
    "(defrule a (b ?x&:(> ?x 3)) (b ?y&:(< ?y 3)) => ) (deffacts d (b 1))",
    "(defrule a (b ?x) (test (or (> ?x 5) (< ?x 3))) => ) (deffacts d (b 1))",
    "(defglobal ?*g* = 5) (defrule a (b ?x&:(> ?x ?*g*)&:(< ?x 3)) => (bind ?*g* 1)) (deffacts d (b 1))",
    "(defrule a (behaviour (id curiosity) (outcome reached|blocked) (remaining-m nil)) => )",
    "(defrule a (battery (charge-fraction ?c&:(< ?c 0.2))) => (behaviour-select wall_following on))",
    "(defrule a (target (id ?t) (place-x-m ?x)) => (post (target (id next) (reason frontier) (place-x-m ?x))))",
    '(defrule a => (behavior-select "path_following" "ON" 1.0 2.0) (behaviour-select path_following off))',
]


@pytest.mark.parametrize("text", SOUND)
def test_sound_rules_have_no_findings(text: str) -> None:
    assert found(text) == []


def test_only_errors_keep_rules_from_being_loaded() -> None:
    refuse_faults(read_text("(defrule a (never) => (motivate curiosity))", templates=TEMPLATES), PARTS)
    with pytest.raises(RuleErrors, match="no behaviour 'walk'"):
        refuse_faults(read_text("(defrule a => (motivate walk))", templates=TEMPLATES), PARTS)


def test_clips_is_asked_too_where_it_is_installed() -> None:
    pytest.importorskip("clips")
    (told,) = found("(defrule a (b ?x&1|2) (b ?x&2|3) => ) (deffacts d (b 2))")
    assert told.startswith("1:1: warning: the engine 'clips' cannot run this: [CSTRNCHK1]")
