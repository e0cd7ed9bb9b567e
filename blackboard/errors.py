"""Errors that reach the user: each is one line that says what is wrong and what to do."""

from collections.abc import Iterable
from difflib import get_close_matches


class SkiError(Exception):
    """Base of every error that `ski` raises on purpose; its text is one line for the user.

    What it quotes may hold anything: line breaks and what would steer a terminal are written out.
    """

    def __str__(self) -> str:
        text = super().__str__()
        if text.isprintable():
            return text
        return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


class MissionError(SkiError):
    """A mission, world, robot, component or parameter is wrong: refused before anything runs."""


class MessageError(SkiError):
    """A value is not fit for its key: refused where it was posted or decoded."""


class BoardError(SkiError):
    """The board was used in a way that it cannot honour (an undeclared key, an unknown entry, a stamp that runs back)."""


class RecordingError(SkiError):
    """A recording cannot be read, or holds nothing that can be used."""


class UncertaintyError(SkiError):
    """A theory of uncertainty cannot work with what it was given (a probability of 2, evidence in total conflict)."""


class OutputError(SkiError):
    """Results cannot be written where they were asked for."""


class LinkError(SkiError):
    """A process cannot speak with the board's keeper: a wrong address, nobody there, no keys or the wrong ones."""


class CheckpointError(SkiError):
    """A checkpoint cannot be written, or what was found is none that may be used."""


class KeysError(SkiError):
    """Keys, certificates or the list of members cannot be made, read or used."""


class ComponentFailed(SkiError):
    """A component raised while running under `--strict`."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return `; did you mean 'x'?` with the name nearest to `name`, or what there is when nothing is near."""
    names = sorted(known)
    near = get_close_matches(name, names, n=1, cutoff=0.6)
    if near:
        return f"; did you mean '{near[0]}'?"
    if names and len(names) <= 12:
        return f"; known: {', '.join(names)}"
    return ""
