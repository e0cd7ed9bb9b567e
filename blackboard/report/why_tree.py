"""Where the boxes of a why-tree go: what is worth a box, how its words are wrapped, and its place on the page. No drawing here."""

import heapq
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, field

from blackboard.why import Reason
from blackboard.why_words import is_firing, short

BOXES = 30  # more cannot be read on one page: what lies deeper is folded
ALIKE = 3  # so many entries of one kind below one box are shown one by one, more of them as one box
LETTERS = 46  # of a line
HEADING = 40  # letters, which are bold
LINES = 5  # of a paragraph
ROW_GAP, COLUMN_GAP = 1.1, 6.0  # in lines, in letters
# What leads to a decision is unfolded before what it was measured with: panels, by how many steps nearer others count.
STEPS_BACK = {"commands": 0, "motivations": 0, "control": 1, "hypotheses": 1}
FARTHEST_BACK = 2


@dataclass
class Box:
    """One box: heading and words, already wrapped; `x` and `y` its left and middle, letters and lines, y downwards."""

    panel: str
    heading: str
    lines: list[str]
    note: str = ""  # what is folded, or explained elsewhere
    below: list["Box"] = field(default_factory=list)
    x: float = 0.0
    y: float = 0.0

    @property
    def height(self) -> float:
        """Lines that it takes, with its edges."""
        return len(self.lines) + 2.0 + (1.0 if self.note else 0.0)


def boxes_of(reason: Reason, most: int = BOXES) -> Box:
    """Return the tree of boxes, at most about `most`, in their places: causes to the right of what they explain."""
    root, below = _box([reason])
    waiting: list[tuple[int, int, int, Box, Sequence[Reason]]] = [(0, 0, 0, root, below)]
    used, order = 1, 0
    while waiting:
        _, depth, _, box, reasons = heapq.heappop(waiting)
        groups = _grouped(reasons)
        if used + len(groups) > most:
            box.note = f"+ {sum(1 + _size(one) for one in reasons)} more below"
            continue
        used += len(groups)
        for group in groups:
            child, further = _box(group)
            box.below.append(child)
            if further:
                order += 1
                heapq.heappush(waiting, (depth + 1 + _steps_back(group[0]), depth + 1, order, child, further))
    _place(root, 0.0, 0.0)
    return root


def _steps_back(reason: Reason) -> int:
    return STEPS_BACK.get(short(reason.support.key).split("/")[0], FARTHEST_BACK)


def _grouped(reasons: Sequence[Reason]) -> list[list[Reason]]:
    """Return the reasons below a box by boxes: what ends there together, and many of one kind together."""
    ends = [reason for reason in reasons if not reason.reasons and not reason.repeated]
    together = {id(reason) for reason in ends} if len(ends) > 1 else set[int]()
    by_kind: dict[str, list[Reason]] = {}
    for reason in reasons:
        by_kind.setdefault("" if id(reason) in together else _kind(reason), []).append(reason)
    groups: list[list[Reason]] = []
    for kind, alike in by_kind.items():
        groups += [alike] if not kind or len(alike) > ALIKE else [[one] for one in alike]
    return groups


def _kind(reason: Reason) -> str:
    chunks = short(reason.support.key).split("/")
    return "/".join(chunks[: 3 if chunks[0] in ("observations", "hypotheses") else 2])


def _box(group: Sequence[Reason]) -> tuple[Box, Sequence[Reason]]:
    """Return the box of one reason or of several, and what is to be unfolded below it."""
    first = group[0]
    panel = short(first.support.key).split("/")[0]
    if len(group) == 1:
        heading, words = _split(first)
        paragraphs, below = [words, *first.said], first.reasons
        repeated = first.repeated
        if len(below) == 1 and is_firing(below[0].support.key):  # what a rule did, and the rule: one thought
            paragraphs.append(_split(below[0])[1])
            below, repeated = below[0].reasons, below[0].repeated
        note = "explained elsewhere" if repeated else ""
        return Box(panel, heading, [line for text in paragraphs for line in _wrapped(text, LINES)], note), below
    kinds = list(dict.fromkeys(_kind(one) for one in group))
    if len(kinds) == 1:
        ids = ", ".join(one.support.key.rsplit("/", 1)[1] for one in group)
        below_all = sum(_size(one) for one in group)
        note = f"+ {below_all} more below" if below_all else ""
        return Box(panel, f"{len(group)} of {kinds[0]}", _wrapped(ids, LINES), note), ()
    lines = [line for one in group for line in _wrapped(": ".join(_split(one)), 2)]
    return Box(panel, f"{len(group)} entries", lines), ()


def _split(reason: Reason) -> tuple[str, str]:
    """Return the key as heading, without its panel and level, and the words without it."""
    key = short(reason.support.key)
    sentence, bracket, _ = reason.words.partition("  [")
    chunks = key.split("/")
    heading = "/".join(chunks[2 if chunks[0] in ("observations", "hypotheses") else 1 :])
    heading = heading if len(heading) <= HEADING else f"{heading[: HEADING - 1]}…"
    return heading, sentence if bracket else reason.words.removeprefix(key).lstrip(" ,")


def _wrapped(words: str, most: int) -> list[str]:
    lines = textwrap.wrap(words, LETTERS, break_long_words=True) or [""]
    return lines if len(lines) <= most else [*lines[: most - 1], f"{lines[most - 1][: LETTERS - 2]} …"]


def _size(reason: Reason) -> int:
    return sum(1 + _size(one) for one in reason.reasons)


def _place(box: Box, x: float, top: float) -> float:
    """Put a box and all below it from `top` on; return where the next may begin."""
    box.x = x
    y = top
    for child in box.below:
        y = _place(child, x + LETTERS + COLUMN_GAP, y)
    bottom = max(y, top + box.height + ROW_GAP)
    if box.below:
        box.y = (box.below[0].y + box.below[-1].y) / 2
        if box.y - box.height / 2 < top:  # higher than its children together
            _shift(box.below, top + box.height / 2 - box.y)
            box.y = top + box.height / 2
    else:
        box.y = top + box.height / 2
    return bottom


def _shift(boxes: Sequence[Box], down: float) -> None:
    for box in boxes:
        box.y += down
        _shift(box.below, down)
