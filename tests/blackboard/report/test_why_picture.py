"""Why-trees as boxes on a page."""

import pytest

from blackboard.entry import Support
from blackboard.errors import OutputError
from blackboard.report.why_picture import why_figure, write_why_picture
from blackboard.report.why_tree import LETTERS, Box, boxes_of
from blackboard.why import Reason


def reason(path: str, words: str = "", *reasons: Reason) -> Reason:
    return Reason(Support(f"ski/k2a/{path}", 1, 1), f"{path} {words}", reasons=list(reasons))


def everything(box: Box) -> list[Box]:
    return [box, *(inner for child in box.below for inner in everything(child))]


@pytest.fixture
def tree() -> Reason:
    scan = reason("observations/signal/sonar_scan", "revision 7: ranges")
    firing = Reason(
        Support("ski/k2a/control/firing/go", 1, 1),
        "because rule go fired at 2.00 s: it matched (mode choose)  [control/firing/go revision 1]",
        reasons=[reason("hypotheses/symbol/target/a", "revision 1: place", scan)],
    )
    asked = Reason(
        Support("ski/k2a/motivations/motivation/path_following", 1, 1),
        "path_following was asked to go to (1.00, 2.00) at 2.00 s  [motivations/motivation/path_following revision 1]",
        reasons=[firing],
    )
    return reason("commands/drive", "revision 3: forward", asked, scan, reason("status/robot", "k2a"))


def test_a_deed_and_its_rule_share_a_box_and_ends_are_put_together(tree: Reason) -> None:
    root = boxes_of(tree)
    assert [box.heading for box in everything(root)] == [
        "drive", "motivation/path_following", "target/a", "sonar_scan", "2 entries",
    ]  # fmt: skip
    asked = root.below[0]
    assert asked.lines == [
        "path_following was asked to go to (1.00, 2.00)",
        "at 2.00 s",
        "because rule go fired at 2.00 s: it matched",
        "(mode choose)",
    ]
    assert root.below[1].lines == ["sonar_scan: revision 7: ranges", "robot: k2a"]


def test_no_two_boxes_meet(tree: Reason) -> None:
    many = reason("commands/drive", "", *[reason(f"hypotheses/feature/k{i}", "w " * 40, tree) for i in range(6)])
    boxes = everything(boxes_of(many))
    for i, one in enumerate(boxes):
        for other in boxes[:i]:
            if abs(one.x - other.x) < LETTERS:
                assert abs(one.y - other.y) >= (one.height + other.height) / 2, (one.heading, other.heading)
    assert min(box.y - box.height / 2 for box in boxes) >= 0


def test_what_lies_deeper_is_folded_and_many_of_a_kind_are_one_box() -> None:
    chain = reason("hypotheses/feature/route")
    for i in range(50):
        chain = reason("hypotheses/feature/route", f"revision {i}", chain)
    boxes = everything(boxes_of(chain, most=10))
    assert len(boxes) == 10
    assert boxes[-1].note == "+ 41 more below"
    lines = [
        reason(f"observations/feature/line/1-{i}", "", reason("observations/signal/sonar_scan")) for i in range(12)
    ]
    (one,) = boxes_of(reason("hypotheses/feature/model_line/1", "", *lines)).below
    assert (one.heading, one.note) == ("12 of observations/feature/line", "+ 12 more below")
    assert one.lines[0].startswith("1-0, 1-1, 1-2")


def test_the_same_bytes_each_time_as_png_and_svg(tree: Reason, tmp_path) -> None:
    for ending in ("png", "svg"):
        one, two = (tmp_path / f"{name}.{ending}" for name in ("one", "two"))
        write_why_picture(tree, one)
        write_why_picture(tree, two)
        assert one.read_bytes() == two.read_bytes()
    assert b"path_following was asked to go to" in (tmp_path / "one.svg").read_bytes()
    with pytest.raises(OutputError, match=r"name a \.png or \.svg file"):
        write_why_picture(tree, tmp_path / "one.gif")
    with pytest.raises(OutputError, match="cannot be written"):
        write_why_picture(tree, tmp_path / "nowhere" / "one.png")


def test_words_stay_within_their_boxes(tree: Reason) -> None:
    wide = reason(f"control/firing/{'mw-' * 30}", "revision 1: " + "WIDE MARGINS " * 20, tree)
    figure = why_figure(reason("commands/drive", "revision 4", wide))
    (axes,) = figure.axes
    edges = {round(patch.get_x(), 3): patch.get_x() + LETTERS for patch in axes.patches if hasattr(patch, "get_x")}
    for text in axes.texts:
        right = axes.transData.inverted().transform(text.get_window_extent().get_points())[1, 0]
        box = max(left for left in edges if left <= text.get_position()[0])
        assert right <= edges[box], text.get_text()
