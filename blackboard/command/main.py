"""`ski`: parses the command line and runs one verb. Errors are one line on standard error; results go to standard output."""

import argparse
import importlib
import os
import sys
from collections.abc import Sequence
from typing import NoReturn

VERBS = {
    "run": "run a mission: simulated robot, knowledge sources, behaviours",
    "map": "build a map from a recording",
    "lines": "find the lines in a map of points, such as an ARIA map",
    "check": "check a mission file without running it",
    "watch": "show what is on a running board and what comes, as a live table",
    "echo": "print the entries of a running board as they come",
    "get": "print what stands on a running board",
    "post": "post on a running board",
    "doctor": "find what is wrong with a running setup, and say what to do",
    "graph": "show who posts and reads what in a mission, a run or a running board",
    "vocabulary": "print every kind of entry, with its JSON Schema",
    "why": "explain an entry of a run, down to the readings",
    "find": "find objects of a run by kind, place, name or description, and what a place is part of",
    "board": "keep the board for all processes of a mission, and see how it stands",
    "rules": "check rule files, and see what rules can look at",
    "host": "run one process of a mission, on the board that a keeper keeps",
    "up": "run a mission as processes, here and on other machines",
    "down": "end what was started on this machine, whatever state it is in",
    "ps": "show the processes of what is up: machine, state, restarts, heartbeat, what is missing",
    "agent": "run parts of missions on this machine for a manager (ski up) here or elsewhere",
    "keys": "make and list the keys of a board that other machines can reach",
    "new": "write a new component to start from",
}
EXIT_ERROR = 2
EXIT_INTERRUPTED = 130


class Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and where help is, and exit."""
        self.exit(EXIT_ERROR, f"ski: {message}; see `{self.prog} --help`\n")


def build_parser(verb: str | None) -> argparse.ArgumentParser:
    """Return the parser; only the verb that is asked for is imported, so that `ski --help` is quick."""
    parser = Parser(
        prog="ski",
        description="A blackboard that turns a mobile robot's readings into a model of its world, and says why.",
        epilog="`ski VERB --help` tells more. Start with: ski run explore-lab",
    )
    parser.add_argument("--version", action="store_true", help="print the version and exit")
    verbs = parser.add_subparsers(dest="verb", metavar="VERB")
    for name, text in VERBS.items():
        below = verbs.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
        if name == verb:
            module = importlib.import_module(f"blackboard.command.{name}")
            module.add_arguments(below)
            below.set_defaults(call=module.call)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit status."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # arrays here are small: threads would only wait for each other
    given = list(sys.argv[1:] if arguments is None else arguments)
    verb = next((word for word in given if not word.startswith("-")), None)
    if verb is not None and verb not in VERBS:
        from blackboard.errors import did_you_mean

        sys.stderr.write(f"ski: there is no verb '{verb}'{did_you_mean(verb, VERBS)}\n")
        return EXIT_ERROR
    from blackboard.errors import SkiError

    try:
        return _run(build_parser(verb), given)
    except SkiError as error:
        sys.stderr.write(f"ski: {error}\n")
        return EXIT_ERROR
    except KeyboardInterrupt:
        sys.stderr.write("ski: interrupted\n")
        return EXIT_INTERRUPTED
    except BrokenPipeError:  # the reader (head, less) has gone; keep the interpreter from complaining at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _run(parser: argparse.ArgumentParser, given: Sequence[str]) -> int:
    options = parser.parse_args(_joined(given))
    if options.version:
        from importlib.metadata import version

        sys.stdout.write(f"ski {version('sensory-knowledge-integrator')}\n")
        return 0
    if options.verb is None:
        parser.print_help()
        return 0
    return int(options.call(options) or 0)


def _joined(given: Sequence[str]) -> list[str]:
    """Return the arguments with a value such as -1,2 joined to its flag: on its own argparse takes it for a flag."""
    joined: list[str] = []
    for word in given:
        if joined and joined[-1].startswith("--") and "=" not in joined[-1] and word[:1] == "-" and "," in word:
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


if __name__ == "__main__":
    sys.exit(main())
