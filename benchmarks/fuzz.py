"""Fuzz: a coverage-guided fuzzer (atheris) on every decoder of what comes from outside, and a report.

python benchmarks/fuzz.py [--minutes 10] [--targets rules journal ...] [--out DIR]

Needs atheris: pip install -e ".[fuzz]", in an environment of its own or not. What a target may raise is a SkiError of one line;
anything else, and an input that takes longer than `--hang` seconds, is a finding. Inputs that were found stand in DIR/<target>,
each with its traceback; a corpus beside them is gone on from. The exit status is 1 where there are findings.
"""

import argparse
import subprocess
import sys
import tempfile
import time
import traceback
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:
    from fuzz_targets import Target

MAX_BYTES = 20_000  # of an input: longer ones find the same and take their time


@dataclass(frozen=True)
class Report:
    """What became of one target."""

    name: str
    runs: int
    covered: int
    corpus: int
    findings: list[Path]


def hunt(name: str, folder: Path, seconds: float, hang_s: float) -> None:
    """Fuzz one target in this process until the time is over, or something is found. Does not return."""
    import atheris

    with atheris.instrument_imports(include=["blackboard", "rules", "sim", "tomllib"]):
        from fuzz_targets import TARGETS, feed
    target = next(target for target in TARGETS if target.name == name)
    scratch = Path(tempfile.mkdtemp(prefix="ski-fuzz-"))

    def one(data: bytes) -> None:
        fault = feed(target, data, scratch)
        if fault is not None:
            raise fault

    settings = {
        "max_total_time": round(seconds),
        "max_len": MAX_BYTES,
        "timeout": round(hang_s),
        "rss_limit_mb": 3000,
        "artifact_prefix": f"{folder}/found-",
        "print_final_stats": 1,
    }
    atheris.Setup(["fuzz", *(f"-{name}={value}" for name, value in settings.items()), str(folder / "corpus")], one)
    atheris.Fuzz()


def fuzz(target: "Target", folder: Path, seconds: float, hang_s: float) -> Report:
    """Fuzz one target in a process of its own; return what became of it."""
    corpus = folder / "corpus"
    corpus.mkdir(parents=True, exist_ok=True)
    for number, seed in enumerate(target.seeds()):
        (corpus / f"seed-{number}").write_bytes(seed)
    for old in folder.glob("found-*"):
        old.unlink()
    command = [sys.executable, __file__, "--hunt", target.name, "--out", str(folder.parent), "--seconds", str(seconds)]
    try:
        done = subprocess.run(
            [*command, "--hang", str(hang_s)], capture_output=True, text=True, errors="replace", timeout=seconds + 120
        )
        said = done.stdout + done.stderr
    except subprocess.TimeoutExpired as error:
        said = f"{error.stdout!r} {error.stderr!r}"
        (folder / "found-hang").write_text("the fuzzer itself did not come back\n", encoding="utf-8")
    (folder / "log.txt").write_text(said, encoding="utf-8")
    numbers: dict[str, int] = {}
    for line in said.splitlines():
        words = line.split()
        if line.startswith("stat::number_of_executed_units:"):
            numbers["runs"] = int(words[-1])
        if "cov:" in words:
            numbers["covered"] = int(words[words.index("cov:") + 1])
            numbers.setdefault("runs", 0)
            if words[0].startswith("#"):
                numbers["runs"] = max(numbers["runs"], int(words[0][1:].rstrip(":")))
    found = sorted(folder.glob("found-*"))
    return Report(target.name, numbers.get("runs", 0), numbers.get("covered", 0), len(list(corpus.iterdir())), found)


def told(target: "Target", path: Path) -> str:
    """Return what an input that was found does, in one line."""
    from fuzz_targets import feed

    with tempfile.TemporaryDirectory() as scratch:
        fault = feed(target, path.read_bytes(), Path(scratch)) if "timeout" not in path.name else None
    if fault is None:
        return "too slow, or too much memory"
    path.with_suffix(".txt").write_text("".join(traceback.format_exception(fault)), encoding="utf-8")
    return f"{type(fault).__name__}: {fault}"[:150]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--minutes", type=float, default=10.0, help="in all")
    parser.add_argument("--targets", nargs="*", help="by name; all unless given")
    parser.add_argument("--out", type=Path, default=Path("runs/fuzz"))
    parser.add_argument("--hang", type=float, default=10.0, help="seconds after which an input counts as hanging")
    parser.add_argument("--hunt", help=argparse.SUPPRESS)
    parser.add_argument("--seconds", type=float, help=argparse.SUPPRESS)
    options: Any = parser.parse_args()
    if find_spec("atheris") is None:
        sys.stderr.write("fuzz: atheris is not installed; pip install -e '.[fuzz]', on Linux\n")
        return 2
    if options.hunt:
        hunt(options.hunt, options.out / options.hunt, options.seconds, options.hang)
    from fuzz_targets import TARGETS

    chosen = [target for target in TARGETS if not options.targets or target.name in options.targets]
    if len(chosen) < len(options.targets or ()):
        sys.stderr.write(f"fuzz: there are the targets {', '.join(target.name for target in TARGETS)}\n")
        return 2
    seconds = 60.0 * options.minutes / len(chosen)
    table = Table("target", "runs", "covered edges", "inputs kept", "findings")
    findings = 0
    console = Console()
    began_s = time.monotonic()
    for target in chosen:
        report = fuzz(target, options.out / target.name, seconds, options.hang)
        findings += len(report.findings)
        table.add_row(report.name, str(report.runs), str(report.covered), str(report.corpus), str(len(report.findings)))
        for path in report.findings:
            console.print(f"{target.name}: {path}: {told(target, path)}", highlight=False, markup=False)
    console.print(table)
    console.print(f"{findings} findings in {(time.monotonic() - began_s) / 60:.1f} minutes")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
