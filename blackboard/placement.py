"""Which process runs what: the `[hosts]` tables of a mission.

A mission that says nothing has a host each for the robot, the behaviours, the knowledge sources and the rules. A table
`[hosts.NAME]` takes what its `runs` names: the words of those four, or single knowledge sources. What no table names goes
to the host that bears the word's name, declared or not.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

from blackboard.errors import MissionError, did_you_mean
from blackboard.key_expressions import is_chunk
from blackboard.parameters import parse_parameters, require
from blackboard.toml_file import Place, TomlFile

if TYPE_CHECKING:
    from blackboard.mission import Mission

WORDS = ("robot", "behaviours", "knowledge_sources", "rules")
TAKEN = ("keeper", "agent", "manager")  # names of processes that are no hosts
PREFIX = "hosts."


@dataclass(frozen=True, slots=True, kw_only=True)
class HostParams:
    """A `[hosts.NAME]` table."""

    runs: tuple[str, ...] = ()
    on: str = ""  # a machine by its agent's name; empty: the one where `ski up` is called
    restart: Literal["always", "on-failure", "never"] = "on-failure"
    restarts: int = 5  # so many within `within_s`, then it stays down: a host that cannot run would spin for ever
    within_s: float = 60.0
    hang_s: float = 5.0  # heartbeats come 5 times a second, but a long activation holds them back
    stop_s: float = 5.0  # from SIGTERM to SIGKILL: time to post what is held back

    def __post_init__(self) -> None:
        require(0 <= self.restarts <= 1000, "restarts", self.restarts, "[0, 1000]")
        require(0 < self.within_s <= 86_400, "within_s", self.within_s, "(0, 86400] seconds")
        require(1.0 <= self.hang_s <= 3600, "hang_s", self.hang_s, "[1, 3600] seconds")
        require(0 <= self.stop_s <= 600, "stop_s", self.stop_s, "[0, 600] seconds")
        require(
            self.on == "" or is_chunk(self.on), "on", self.on, "the names of machines: letters, digits, '_', '-', '.'"
        )


@dataclass(frozen=True)
class HostTable:
    """A `[hosts.NAME]` table as it was read."""

    name: str
    params: HostParams
    place: Place


@dataclass(frozen=True, kw_only=True)
class HostPlan:
    """What one host process runs. With the robot comes the safety layer, with the behaviours the coordinator."""

    name: str
    robot: bool = False
    behaviours: bool = False
    rules: bool = False
    sources: tuple[str, ...] = ()  # knowledge sources by name, in the mission's order
    params: HostParams = field(default_factory=HostParams)
    of: str = ""  # the robot that it works for; empty: for all of the mission

    def words(self) -> list[str]:
        """Return what it runs, for people."""
        named = {"robot": self.robot, "behaviours": self.behaviours, "rules": self.rules}
        return [*(word for word, here in named.items() if here), *self.sources]


def read_hosts(file: TomlFile, settings: Mapping[str, Mapping[str, Any]]) -> tuple[HostTable, ...]:
    """Read the `[hosts]` tables with `settings` over them; raise MissionError with file and line for what is not right."""
    tables = file.data.get("hosts", {})
    if not isinstance(tables, dict):
        raise MissionError(f"{file.place('hosts').at()}: write [hosts.NAME], one table for each process")
    laid_over = {name.removeprefix(PREFIX): values for name, values in settings.items() if name.startswith(PREFIX)}
    read = []
    for name in [*tables, *(name for name in laid_over if name not in tables)]:
        place = file.place(PREFIX + name)
        table = tables.get(name, {})
        if not isinstance(table, dict):
            raise MissionError(
                f"{file.place('hosts').at(name)}: write it in a table [hosts.NAME], one for each process"
            )
        if not is_chunk(name) or name in TAKEN:
            raise MissionError(f"{place.at()}: a host cannot be named '{name}'; choose another name")
        read.append(HostTable(name, parse_parameters(HostParams, {**table, **laid_over.get(name, {})}, place), place))
    return tuple(read)


def placement(mission: "Mission") -> tuple[HostPlan, ...]:
    """Return the hosts of a mission: every component in exactly one. Of several robots each has its own, `<robot>.<host>`.

    Raises MissionError with file and line for what is named twice or nowhere in the mission, and for a host without work.
    """
    sources = [spec.name for spec in mission.knowledge_sources]
    there = {
        "robot": True,
        "behaviours": bool(mission.behaviours),
        "knowledge_sources": bool(sources),
        "rules": mission.rules is not None,
    }
    taken: dict[str, str] = {}  # word or source: its host
    for table in mission.hosts:
        for word in table.params.runs:
            _check(word, table, mission, there, sources, taken)
            taken[word] = table.name
    hosts = list(dict.fromkeys([*(table.name for table in mission.hosts), *(word for word in WORDS if there[word])]))
    params = {table.name: table.params for table in mission.hosts}
    at = {word: taken.get(word, word) for word in WORDS if there[word]}
    plans = []
    for name in hosts:
        plan = HostPlan(
            name=name,
            robot=at["robot"] == name,
            behaviours=at.get("behaviours") == name,
            rules=at.get("rules") == name,
            sources=tuple(source for source in sources if taken.get(source, at["knowledge_sources"]) == name),
            params=params.get(name, HostParams()),
        )
        if plan.words():
            plans.append(plan)
        elif name in params:
            table = next(table for table in mission.hosts if table.name == name)
            raise MissionError(f"{table.place.at('runs')}: the host '{name}' runs nothing; add runs = [...] or drop it")
    return tuple(each for plan in plans for each in _for_robots(plan, mission))


def _for_robots(plan: HostPlan, mission: "Mission") -> list[HostPlan]:
    """Return a host for each of several robots; all that runs with the robots stays in one, since their world is one."""
    if plan.robot or not mission.team:
        return [plan]
    return [replace(plan, name=f"{robot.name}.{plan.name}", of=robot.name) for robot in mission.team]


def _check(
    word: str,
    table: HostTable,
    mission: "Mission",
    there: Mapping[str, bool],
    sources: Sequence[str],
    taken: Mapping[str, str],
) -> None:
    """Raise MissionError where a word of `runs` cannot be placed."""
    at = table.place.at("runs")
    behaviours = [spec.name for spec in mission.behaviours]
    if word in behaviours or word == "coordinator":
        raise MissionError(
            f"{at}: behaviours and coordinator answer together, in one process; write 'behaviours', not '{word}'"
        )
    if word == "safety":
        raise MissionError(f"{at}: the safety layer always runs beside the robot; drop 'safety'")
    if word not in (*WORDS, *sources):
        raise MissionError(f"{at}: the mission has no '{word}'{did_you_mean(word, [*WORDS, *sources])}")
    if not there.get(word, True):
        raise MissionError(f"{at}: the mission has no {word}; drop the word")
    if word in taken:
        raise MissionError(f"{at}: '{word}' runs in the host '{taken[word]}' already; name it once")
