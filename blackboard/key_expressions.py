"""Keys and key expressions, with zenoh's own meaning.

A key is a `/`-separated list of non-empty chunks. In an expression `*` stands for one chunk, `**` for any number of chunks,
and `$*` inside a chunk for any number of characters. A chunk that starts with `@` is verbatim: no wildcard matches it.
"""

import re
from functools import lru_cache

from blackboard.errors import BoardError

_CHUNK = re.compile(r"[A-Za-z0-9_.\-]+")


def is_chunk(text: str) -> bool:
    """Say whether `text` may be one part of a key that this project makes: letters, digits, `_`, `.`, `-`."""
    return _CHUNK.fullmatch(text) is not None


def check_expression(expression: str) -> None:
    """Raise BoardError unless zenoh would take `expression` as it stands (its canonical form)."""
    problem = _problem(expression)
    if problem:
        raise BoardError(f"key expression '{expression}': {problem}")


def _problem(expression: str) -> str | None:
    if not expression:
        return "it is empty"
    chunks = expression.split("/")
    for previous, chunk in zip([None, *chunks], chunks, strict=False):
        if chunk == "":
            return "it has an empty chunk (a leading, trailing or double '/')"
        if "#" in chunk or "?" in chunk:
            return f"chunk '{chunk}' holds '#' or '?', which zenoh reserves"
        if chunk in ("*", "**"):
            if previous == "**":
                return f"write '{'**' if chunk == '**' else '*/**'}' for '**/{chunk}'"
            continue
        if chunk == "$*":
            return "write '*' for a chunk that is only '$*'"
        if "$*$*" in chunk:
            return "write '$*' for '$*$*'"
        rest = chunk.replace("$*", "")
        if "*" in rest:
            return f"chunk '{chunk}': '*' inside a chunk is written '$*'"
        if "$" in rest:
            return f"chunk '{chunk}': '$' must be followed by '*'"
    return None


def matches(expression: str, key: str) -> bool:
    """Say whether `expression` matches the concrete `key`, as zenoh's KeyExpr.intersects does."""
    return _compiled(expression).fullmatch("/" + key) is not None


@lru_cache(maxsize=4096)
def _compiled(expression: str) -> re.Pattern[str]:
    check_expression(expression)
    pattern = ""  # each chunk matches with a '/' in front; the key gets one too
    for chunk in expression.split("/"):
        if chunk == "**":
            pattern += r"(?:/(?!@)[^/]+)*"
        elif chunk == "*":
            pattern += r"/(?!@)[^/]+"
        elif chunk.startswith("@") and "$*" in chunk:
            pattern += "(?!)"  # zenoh takes such an expression, and it matches no key
        else:
            wild = "(?!@)" if chunk.startswith("$*") else ""
            pattern += "/" + wild + "[^/]*".join(re.escape(part) for part in chunk.split("$*"))
    return re.compile(pattern)
