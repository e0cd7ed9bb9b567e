"""What the keeper answers: the whole board, what was missed, what was handed in late, what stands under some keys, the time."""

from collections.abc import Callable
from contextlib import suppress

import msgspec

from blackboard.errors import BoardError, LinkError, MessageError, SkiError
from blackboard.keeper.clocks import Clocks
from blackboard.keeper.desks import Desks, Tell
from blackboard.kinds import PANELS
from blackboard.link.envelope import (
    LostQuestion,
    Snapshot,
    attachment_of,
    join_batch,
    join_snapshot,
    robot_of,
    split_batch,
)
from blackboard.link.session import Question


def answer_clock(clocks: Clocks, question: Question) -> None:
    """Answer at once, on zenoh's thread: the way there and back is measured by it."""

    def answer() -> None:
        may_begin = question.key.endswith("/begin")  # which takes more rights than to ask
        told = clocks.ask(robot_of(question.key), question.payload, may_begin)
        question.reply(question.key, msgspec.json.encode(told))

    answered(question, answer)


class Answers:
    """Answers questions about the boards, on the keeper's own loop."""

    def __init__(self, desks: Desks, boot: str, tell: Tell) -> None:
        self._desks = desks
        self._boot = boot
        self._tell = tell

    def answer(self, question: Question, now_s: float) -> None:
        """Answer a question, or say why there is no answer."""
        answered(question, lambda: self._reply(question, now_s))

    def _reply(self, question: Question, now_s: float) -> None:
        chunks = question.key.split("/")
        if len(chunks) == 4 and chunks[2:] == ["@keeper", "snapshot"]:
            desk = self._desks.find(chunks[1])
            nothing = join_snapshot(Snapshot(boot=self._boot, now_s=None, lanes={}), [])
            question.reply(question.key, desk.snapshot() if desk is not None else nothing)
        elif len(chunks) == 4 and chunks[2:] == ["@keeper", "lost"]:
            self._reply_lost(question, chunks[1])
        elif len(chunks) == 5 and chunks[2] == "@late":
            self._reply_late(question, chunks[1], "/".join(chunks[3:]), now_s)
        else:
            for desk in self._desks:
                for key, envelope in desk.kept.standing.matching(question.key):
                    question.reply(key, envelope.payload, attachment_of(envelope.origin))

    def _reply_lost(self, question: Question, robot: str) -> None:
        try:
            asked = msgspec.json.decode(question.payload, type=LostQuestion)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            raise MessageError(f"{question.key}: not a question for lost envelopes ({error})") from None
        desk = self._desks.find(robot)
        question.reply(question.key, join_batch(desk.kept.lost(asked) if desk is not None else []))

    def _reply_late(self, question: Question, robot: str, place: str, now_s: float) -> None:
        panel = place.split("/")[0]
        if panel not in PANELS:
            raise BoardError(f"{question.key}: there is no panel '{panel}'")
        envelopes = split_batch(question.payload)
        desk = self._desks.opened(robot)
        if desk is None:
            raise BoardError(f"{question.key}: no board for it")
        for line in desk.take_late(place, envelopes, now_s):
            self._tell(line)
        if desk.kept.journal.trouble:
            raise BoardError(f"{desk.kept.journal.path}: cannot be written ({desk.kept.journal.trouble})")
        question.reply(question.key, desk.told(now_s))


def answered(question: Question, answer: Callable[[], None]) -> None:
    """Have a question answered, or say why not, and finish it."""
    try:
        answer()
    except SkiError as error:
        with suppress(LinkError):  # who asked is gone
            question.fail(str(error))
    finally:
        question.finish()
