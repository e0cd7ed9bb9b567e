"""Lines of a text file, plain or gzipped, with their numbers."""

import gzip
import zlib
from collections.abc import Iterator
from pathlib import Path

from blackboard.errors import RecordingError, did_you_mean

EXPECTED = "an ARIA map (plain or gzipped) or a text file with x and y in metres on each line"
MAX_LINE = 10_000  # bytes: no line of numbers is longer


def text_lines(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the number and the text of each line that is not empty; raise RecordingError where there is no text to read."""
    number = 0
    try:
        with path.open("rb") as plain:
            zipped = plain.read(2) == b"\x1f\x8b"
            plain.seek(0)
            lines = gzip.GzipFile(fileobj=plain) if zipped else plain
            while line := lines.readline(MAX_LINE + 1):
                number += 1
                if len(line) > MAX_LINE or b"\x00" in line:
                    raise RecordingError(f"{path}: line {number}: no text; expected {EXPECTED}")
                text = line.decode("utf-8-sig" if number == 1 else "utf-8", "replace").strip()
                if text:
                    yield number, text
    except FileNotFoundError:
        neighbours = [p.name for p in path.parent.iterdir()] if path.parent.is_dir() else []
        raise RecordingError(f"{path}: there is no such file{did_you_mean(path.name, neighbours)}") from None
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise RecordingError(
            f"{path}: the gzip data breaks off or is damaged after line {number} ({error}); copy the file again"
        ) from None
    except IsADirectoryError:
        raise RecordingError(f"{path}: is a folder; name the file in it: {EXPECTED}") from None
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror or error})") from None
