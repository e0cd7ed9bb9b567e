"""What the keeper knew when its journal had so many bytes, so that a restart need not read all of it."""

from pathlib import Path

import msgspec

from blackboard.errors import MessageError, OutputError
from blackboard.keeper.clock import replace_file
from blackboard.keeper.positions import LanePositions
from blackboard.link.envelope import Envelope, join_batch, split_batch
from blackboard.link.lanes import Lane

FILE_NAME = "checkpoint.jsonl"


class LaneMark(msgspec.Struct, frozen=True, array_like=True):
    """The position of one lane."""

    host: str
    boot: str
    lane: Lane
    up_to: int
    beyond: list[tuple[int, int]]


class Header(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The first line: how much of the journal it stands for, the journal's bytes before that, and the positions."""

    journal_bytes: int
    journal_tail: bytes
    positions: list[LaneMark]


def write_checkpoint(
    folder: Path, journal_bytes: int, journal_tail: bytes, positions: LanePositions, envelopes: list[Envelope]
) -> None:
    """Write a checkpoint in place of the last one. Raises OSError."""
    marks = [LaneMark(*names, at.up_to, at.beyond) for names, at in positions]  # type: ignore[arg-type]
    header = Header(journal_bytes=journal_bytes, journal_tail=journal_tail, positions=marks)
    replace_file(folder / FILE_NAME, msgspec.json.encode(header) + b"\n" + join_batch(envelopes))


def read_checkpoint(folder: Path) -> tuple[Header, list[Envelope]] | None:
    """Return the checkpoint; None where there is none that can be read: the journal has everything."""
    try:
        first, _, rest = (folder / FILE_NAME).read_bytes().partition(b"\n")
        return msgspec.json.decode(first, type=Header), split_batch(rest)
    except (FileNotFoundError, msgspec.DecodeError, UnicodeDecodeError, RecursionError, MessageError):
        return None
    except OSError as error:
        raise OutputError(f"{folder / FILE_NAME}: cannot be read ({error.strerror}); choose another --out") from None
