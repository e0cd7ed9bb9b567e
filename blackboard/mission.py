"""Mission files: which robot, knowledge sources, behaviours and coordinator make up a run, and their parameters."""

import importlib.resources
import tomllib
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from blackboard.component import (
    UNNAMED,
    Behaviour,
    Component,
    Coordinator,
    KnowledgeSource,
    Planner,
    Robot,
    SafetyLayer,
)
from blackboard.control import ControlParams
from blackboard.errors import MissionError, did_you_mean
from blackboard.files import is_file
from blackboard.history import HistoryParams
from blackboard.key_expressions import is_chunk
from blackboard.loading import component_name, load_class
from blackboard.mission_names import check_names
from blackboard.parameters import parse_parameters, require
from blackboard.placement import PREFIX, HostTable, placement, read_hosts
from blackboard.toml_file import Place, TomlFile, read_toml

PLANNER = "rules.planning:PlanningModule"
SAFETY = "behaviours.safety:ReflexSafety"  # always there: a mission may set its parameters, never leave it out


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionParams:
    """The `[mission]` table."""

    description: str = ""
    duration_s: float = 600.0  # of a simulated run; a recording ends by itself
    step_s: float = 0.1  # one control cycle: behaviours answer at 10 Hz

    def __post_init__(self) -> None:
        require(0 < self.duration_s <= 1e7, "duration_s", self.duration_s, "(0, 1e7] seconds")
        require(0.001 <= self.step_s <= 10, "step_s", self.step_s, "[0.001, 10] seconds")


@dataclass(frozen=True, slots=True, kw_only=True)
class Wiring:
    """How a behaviour is wired into the arbitration: what it silences while it answers, whether it is selected at the start
    (None: as its class says), its competence level, and its switch there.
    """

    inhibits: tuple[str, ...] = ()
    selected: bool | None = None
    level: str = ""
    gain: float = 1.0
    threshold: float = 0.0

    def __post_init__(self) -> None:
        require(0.0 <= self.gain <= 100.0, "gain", self.gain, "[0, 100]")
        require(0.0 <= self.threshold <= 1000.0, "threshold", self.threshold, "[0, 1000]")


@dataclass(frozen=True)
class Spec:
    """A component as its mission describes it: class, name, parameters, and what the mission says about it."""

    type: type[Component[Any]]
    name: str
    params: Any
    place: Place
    rating: float | None = None
    wiring: "Wiring" = field(default_factory=lambda: Wiring())
    of: str = ""  # the robot whose component it is, where a mission has several

    def build(self, seed: int) -> Any:
        """Construct the component with random numbers of its own; raise MissionError where it cannot be."""
        if not self.of:
            return self.type(self.params, name=self.name, seed=seed)
        try:
            return self.type(self.params, name=self.name, seed=zlib.crc32(f"{seed} {self.of}".encode()))
        except MissionError as error:
            raise self.refused(error) from None

    def refused(self, error: MissionError) -> MissionError:
        """Return an error that also names file and line: of the parameter that it begins with, else of the table."""
        return MissionError(f"{self.place.at(str(error).partition(' ')[0])}: {error}")


@dataclass(frozen=True)
class Mission:
    """A mission file, read and checked; nothing runs yet."""

    name: str
    path: Path
    params: MissionParams
    robot: Spec
    knowledge_sources: tuple[Spec, ...] = ()
    behaviours: tuple[Spec, ...] = ()
    coordinator: Spec | None = None
    rules: Spec | None = None
    safety: Spec | None = None
    control: ControlParams = field(default_factory=ControlParams)
    history: HistoryParams = field(default_factory=HistoryParams)
    hosts: tuple[HostTable, ...] = ()  # what runs in which process; `placement` makes it whole
    team: tuple[Spec, ...] = ()  # all robots, where there are several; `robot` is the first


TABLES = (
    "mission",
    "robot",
    "knowledge_source",
    "behaviour",
    "coordinator",
    "rules",
    "safety",
    "control",
    "history",
    "hosts",
)


def shipped_missions() -> dict[str, Path]:
    """Return the missions that come with the project, by name."""
    folder = Path(str(importlib.resources.files("rules"))) / "missions"
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}


def find_mission(name: str) -> Path:
    """Return the file of a mission given by name or by path; raise MissionError where there is none."""
    shipped = shipped_missions()
    if name in shipped:
        return shipped[name]
    path = Path(name)
    if path.suffix == ".toml" or len(path.parts) > 1:
        if is_file(path):
            return path
        raise MissionError(f"there is no mission file '{name}'")
    raise MissionError(f"there is no mission '{name}'{did_you_mean(name, shipped)}")


def parse_settings(settings: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Turn `table.key=value` strings into tables; a value is read as TOML, or else as a string."""
    tables: dict[str, dict[str, Any]] = {}
    for setting in settings:
        left, equals, text = setting.partition("=")
        table, _, key = left.strip().rpartition(".")
        if not equals or not table or not key:
            raise MissionError(f"--set '{setting}' must be of the form component.parameter=value")
        try:
            value = tomllib.loads(f"value = {text}")["value"]
        except (ValueError, RecursionError):  # TOMLDecodeError among them
            value = text
        tables.setdefault(table, {})[key] = value
    return tables


def load_mission(path: Path, settings: Mapping[str, Mapping[str, Any]] | None = None) -> Mission:
    """Read a mission file, with `settings` (by table or component name) over what it says.

    Raises MissionError with file and line for anything unknown, missing, of the wrong type or out of range.
    """
    file = read_toml(path)
    for table in file.data:
        if table not in TABLES:
            place = file.place(table) if isinstance(file.data[table], dict | list) else file.place()
            raise MissionError(f"{place.at(table)}: unknown table '{table}'{did_you_mean(table, TABLES)}")
    reader = _Reader(file, {name: dict(table) for name, table in (settings or {}).items()})
    params = parse_parameters(MissionParams, reader.table("mission"), file.place("mission"))
    robots = reader.robots()
    if not robots:
        raise MissionError(f"{path}: there is no [robot] table; add one with use = 'sim.simulated:SimulatedRobot'")
    mission = Mission(
        name=path.stem,
        path=path,
        params=params,
        robot=robots[0],
        team=robots if len(robots) > 1 else (),
        knowledge_sources=reader.components("knowledge_source", KnowledgeSource),
        behaviours=reader.components("behaviour", Behaviour),
        coordinator=reader.component("coordinator", Coordinator),
        rules=reader.component("rules", Planner, default_use=PLANNER),
        safety=reader.component("safety", SafetyLayer, only_use=SAFETY),
        control=parse_parameters(ControlParams, reader.table("control"), file.place("control")),
        history=parse_parameters(HistoryParams, reader.table("history"), file.place("history")),
        hosts=read_hosts(file, settings or {}),
    )
    reader.check_all_used()
    check_names(mission, TABLES)
    placement(mission)
    return mission


class _Reader:
    """Reads a mission's tables, laying settings over them."""

    def __init__(self, file: TomlFile, settings: dict[str, dict[str, Any]]) -> None:
        self._file = file
        self._settings = settings
        self._names: list[str] = ["mission", "control", "history"]

    def table(self, name: str) -> dict[str, Any]:
        found = self._file.data.get(name, {})
        if not isinstance(found, dict):
            raise MissionError(f"{self._file.place(name).at()}: write [{name}], there is only one")
        return {**found, **self._settings.get(name, {})}

    def component(
        self,
        table: str,
        base: type[Component[Any]],
        *,
        default_name: str | None = None,
        default_use: str | None = None,
        only_use: str | None = None,
    ) -> Spec | None:
        """Read a table's component: None where there is no table, but for what `only_use` says is always there."""
        if table not in self._file.data and only_use is None:
            return None
        raw = self.table(table)
        if default_use is not None:
            raw.setdefault("use", default_use)
        if only_use is not None and raw.setdefault("use", only_use) != only_use:
            raise MissionError(f"{self._file.place(table).at('use')}: the safety layer cannot be replaced; drop 'use'")
        self._names.append(table)
        return self._spec(raw, base, self._file.place(table), default_name or table)

    def robots(self) -> tuple[Spec, ...]:
        """Read [robot], or each [[robot]]: settings of `robot` go for all of them, those of a name for that one."""
        found = self._file.data.get("robot")
        if not isinstance(found, list):
            robot = self.component("robot", Robot, default_name=UNNAMED)
            return (robot,) if robot is not None else ()
        self._names.append("robot")
        specs = []
        for index, raw in enumerate(found):
            place = self._file.place("robot", index)
            name = raw.get("name") if isinstance(raw, dict) else None
            if not isinstance(name, str) or not is_chunk(name) or "." in name:
                raise MissionError(f"{place.at('name')}: each robot needs a name of letters, digits, '_' and '-'")
            self._names.append(name)
            settings = {**self._settings.get("robot", {}), **self._settings.get(name, {})}
            specs.append(self._spec({**raw, **settings}, Robot, place, name))
        return tuple(specs)

    def components(self, table: str, base: type[Component[Any]]) -> tuple[Spec, ...]:
        found = self._file.data.get(table, [])
        if not isinstance(found, list):
            raise MissionError(f"{self._file.place(table).at()}: write [[{table}]], there may be several")
        specs = []
        for index, raw in enumerate(found):
            place = self._file.place(table, index)
            name = raw.get("name") or (component_name(raw["use"]) if isinstance(raw.get("use"), str) else "")
            self._names.append(name)
            specs.append(self._spec({**raw, **self._settings.get(name, {})}, base, place, name))
        return tuple(specs)

    def check_all_used(self) -> None:
        """Raise MissionError for a setting that belongs to nothing in the mission."""
        for name in self._settings:
            if name not in self._names and not name.startswith(PREFIX):
                raise MissionError(
                    f"--set {name}...: the mission has no component '{name}'{did_you_mean(name, self._names)}"
                )

    def _spec(self, raw: dict[str, Any], base: type[Component[Any]], place: Place, name: str) -> Spec:
        use = raw.pop("use", None)
        if not isinstance(use, str):
            raise MissionError(f"{place.at('use')}: 'use' is missing; add use = 'package.module:Class'")
        found = load_class(use, base, where=place.at("use"), folder=self._file.path.parent)
        name = raw.pop("name", name)
        if not isinstance(name, str) or not is_chunk(name):
            raise MissionError(f"{place.at('name')}: name = {name!r}: letters, digits, '_', '-' and '.' only")
        rating = raw.pop("rating", None) if issubclass(found, KnowledgeSource) else None
        if rating is not None and (isinstance(rating, bool) or not isinstance(rating, int | float)):
            raise MissionError(f"{place.at('rating')}: rating = {rating!r} must be a number")
        wiring = _wiring(raw, place) if issubclass(found, Behaviour) else Wiring()
        params = parse_parameters(found.Params, raw, place, self._file.path.parent)
        return Spec(found, name, params, place, rating, wiring)


def _wiring(raw: dict[str, Any], place: Place) -> Wiring:
    """Take a behaviour's wiring out of its table."""
    names = [f.name for f in fields(Wiring)]
    return parse_parameters(Wiring, {name: raw.pop(name) for name in names if name in raw}, place)
