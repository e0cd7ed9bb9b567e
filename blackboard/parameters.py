"""Parameters of components: frozen dataclasses whose defaults live once, and the one place that fills them from a file."""

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from blackboard.errors import MissionError, did_you_mean
from blackboard.toml_file import Place

P = TypeVar("P")


def require(holds: bool, name: str, value: object, limit: str) -> None:
    """Raise MissionError naming the parameter, its value and the limit unless `holds`."""
    if not holds:
        raise MissionError(f"{name} = {value!r} is outside {limit}")


def parse_parameters(type_: type[P], table: Mapping[str, Any], where: str | Place, base: Path | None = None) -> P:
    """Build the parameters dataclass `type_` from a TOML table; `where` names file, line and table in errors.

    An angle `x_rad` may be written `x_deg`, and a rate `x_radps` as `x_degps`. A field of type Path holds either a bare name of
    something shipped ("lab") or a file, found relative to the folder `base`. Raises MissionError for an unknown key (with the
    nearest name), a wrong type, a value given twice, or one that the dataclass refuses.
    """
    fields = {f.name: f for f in dataclasses.fields(type_) if f.init}  # type: ignore[arg-type]
    hints = get_type_hints(type_)
    values: dict[str, Any] = {}
    for key, raw in table.items():
        name, value = key, raw
        if key not in fields:
            name, value = _from_degrees(key, raw)
        if name not in fields:
            known = [_file_name(n) for n in fields]
            raise MissionError(f"{_at(where, key)}: unknown key '{key}'{did_you_mean(key, [*fields, *known])}")
        if name in values:
            raise MissionError(f"{_at(where, key)}: '{name}' is given twice (in degrees and in radians); keep one")
        values[name] = _convert(value, hints[name], f"{_at(where, key)}: {key}", base)
    missing = [n for n, f in fields.items() if n not in values and _required(f)]
    if missing:
        raise MissionError(f"{_at(where)}: '{missing[0]}' is missing; add it")
    try:
        return type_(**values)
    except MissionError as error:
        named = str(error).split(" ", 1)[0]
        written = next((key for key in table if key == named or _from_degrees(key, 0)[0] == named), None)
        raise MissionError(f"{_at(where, written)}: {error}") from None


def _at(where: str | Place, key: str | None = None) -> str:
    return where.at(key) if isinstance(where, Place) else where


def _required(field: "dataclasses.Field[Any]") -> bool:
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


def _file_name(name: str) -> str:
    return name.removesuffix("_rad") + "_deg" if name.endswith("_rad") else name


def _from_degrees(key: str, raw: Any) -> tuple[str, Any]:
    for degrees, radians in (("_deg", "_rad"), ("_degps", "_radps")):
        if key.endswith(degrees) and isinstance(raw, int | float) and not isinstance(raw, bool):
            try:
                return key.removesuffix(degrees) + radians, math.radians(raw)
            except OverflowError:
                return key.removesuffix(degrees) + radians, math.inf  # which is beyond every limit
    return key, raw


def _convert(value: Any, hint: Any, where: str, base: Path | None) -> Any:
    if Path in (get_args(hint) or (hint,)) and isinstance(value, str):
        path = Path(value)
        bare = len(path.parts) == 1 and not path.suffix
        return path if bare or base is None else base / path
    if hint is float and isinstance(value, int) and not isinstance(value, bool):
        try:
            value = float(value)
        except OverflowError:
            raise MissionError(f"{where}: a number of {len(str(value))} digits is too large") from None
    if get_origin(hint) is tuple:
        item = get_args(hint)[0]
        if not isinstance(value, list):
            raise MissionError(f"{where} = {value!r} must be a list")
        return tuple(_convert(v, item, where, base) for v in value)
    options = [o for o in (get_args(hint) or (hint,)) if isinstance(o, type)]
    if float in options and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if (isinstance(value, bool) and bool not in options) or not isinstance(value, tuple(options)):
        if str in map(type, get_args(hint)):  # Literal of strings
            if value in get_args(hint):
                return value
            raise MissionError(f"{where} = {value!r} must be one of {', '.join(map(repr, get_args(hint)))}")
        names = " or ".join(o.__name__ for o in options if o is not type(None))
        raise MissionError(f"{where} = {value!r} must be {names}, not {type(value).__name__}")
    if isinstance(value, float) and not math.isfinite(value):
        raise MissionError(f"{where} = {value!r} must be finite")
    return value
