"""Loading components by name: the project's only dynamic import.

`use = "package.module:Class"` names a class of any installed package; `use = "mug.py:MugDetector"` one in a single file, found
relative to the mission file.
"""

import importlib
import importlib.util
import pkgutil
import sys
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar

from blackboard.component import Component
from blackboard.errors import MissionError, did_you_mean
from blackboard.files import is_file

C = TypeVar("C", bound=Component[Any])


def load_class(use: str, base: type[C], *, where: str, folder: Path) -> type[C]:
    """Return the class that `use` names; raise MissionError where it is none, or no subclass of `base`."""
    module_name, _, class_name = use.partition(":")
    if not module_name or not class_name:
        raise MissionError(f"{where}: use = '{use}' must be 'package.module:Class' or 'file.py:Class'")
    module = (
        _load_file(folder / module_name, where) if module_name.endswith(".py") else _load_module(module_name, where)
    )
    found = getattr(module, class_name, None)
    if found is None:
        names = [n for n, v in vars(module).items() if isinstance(v, type) and issubclass(v, base) and v is not base]
        raise MissionError(
            f"{where}: use = '{use}': '{module_name}' has no '{class_name}'{did_you_mean(class_name, names)}"
        )
    if not (isinstance(found, type) and issubclass(found, base)):
        raise MissionError(
            f"{where}: use = '{use}': {class_name} is no {base.__name__}; derive it from blackboard's class"
        )
    return found


def component_name(use: str) -> str:
    """Return the name that a component has unless its mission gives one: the module's."""
    return Path(use.partition(":")[0].removesuffix(".py")).name.rpartition(".")[2]


def _load_module(name: str, where: str) -> ModuleType:
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name is None or not (name == error.name or name.startswith(error.name + ".")):
            raise MissionError(f"{where}: '{name}' needs the package '{error.name}'; install it") from None
        raise MissionError(f"{where}: there is no module '{name}'{did_you_mean(name, _siblings(name))}") from None
    except Exception as error:
        raise MissionError(f"{where}: '{name}' cannot be imported ({type(error).__name__}: {error})") from error


def _siblings(name: str) -> list[str]:
    package = name.rpartition(".")[0]
    try:
        path = importlib.import_module(package).__path__ if package else None
    except (ImportError, AttributeError):
        return []
    return [f"{package}.{m.name}" for m in pkgutil.iter_modules(path)] if path is not None else []


def _load_file(path: Path, where: str) -> ModuleType:
    if not is_file(path):
        raise MissionError(f"{where}: there is no file '{path}'; the path is relative to the mission file")
    name = f"ski_component_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise MissionError(f"{where}: '{path}' is no Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their own module up
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise MissionError(f"{where}: '{path}' cannot be imported ({type(error).__name__}: {error})") from error
    return module
