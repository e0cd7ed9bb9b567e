"""`ski new knowledge-source NAME`: write a knowledge source to start from, in a file of its own, with a mission that runs it."""

import argparse
import sys
from pathlib import Path

from blackboard.errors import MissionError, OutputError
from blackboard.key_expressions import is_chunk

TEMPLATE = '''"""{title}: how near the nearest sonar echo is.

Triggered by  observations/signal/sonar_scan    SonarScan
Posts         observations/feature/{name}    {klass}
"""

from dataclasses import dataclass

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry
from blackboard.kinds import SONAR_SCAN, slot
from blackboard.messages.base import Length, Message
from blackboard.messages.sensing import SonarScan
from blackboard.parameters import require


class {klass}(Message, frozen=True, kw_only=True):
    """What this source finds out; limits stand in the annotations."""

    nearest_m: Length


{constant} = slot("observations/feature/{name}", {klass}, "the nearest sonar echo")


@dataclass(frozen=True, slots=True, kw_only=True)
class {klass}Params:
    """What a mission may set."""

    max_range_m: float = 10.0  # echoes from further away do not count

    def __post_init__(self) -> None:
        require(self.max_range_m > 0, "max_range_m", self.max_range_m, "(0, inf) metres")


def nearest(scan: SonarScan, params: {klass}Params) -> {klass} | None:
    """Return the smallest range of a scan; None where nothing was heard."""
    heard = [r for r in scan.ranges_m if r is not None and r <= params.max_range_m]
    return {klass}(nearest_m=min(heard)) if heard else None


class {klass}Source(KnowledgeSource[{klass}Params]):
    """Posts what it found whenever a scan arrives."""

    Params = {klass}Params
    triggers = (SONAR_SCAN,)
    posts = ({constant},)

    def activate(self, trigger: Entry[SonarScan], board: Access) -> None:
        found = nearest(trigger.value, self.params)
        if found is not None:
            board.post({constant}, found, supports=[trigger])
'''

COMPONENTS = ("knowledge-source",)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("component", choices=COMPONENTS, help="what to write")
    parser.add_argument("name", help="its name, e.g. nearest_echo; becomes NAME.py in the current folder")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    name = options.name.removesuffix(".py").replace("-", "_")
    if not is_chunk(name) or not name.isidentifier() or not name.islower():
        raise MissionError(f"'{options.name}' is no module name; use small letters, digits and '_', e.g. nearest_echo")
    path = Path(f"{name}.py")
    klass = "".join(part.capitalize() for part in name.split("_"))
    text = TEMPLATE.format(title=name.replace("_", " ").capitalize(), name=name, klass=klass, constant=name.upper())
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise OutputError(f"{path} exists already; choose another name") from None
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}); change to a folder of yours") from None
    sys.stdout.write(
        f"wrote {path}\nTo run it, copy a mission (`ski check explore-lab` says where it lies) beside it and add:\n\n"
        f'[[knowledge_source]]\nuse = "{path}:{klass}Source"\n'
    )
    return 0
