"""Checkpoints: what components must remember when their process is killed, in a file that is always whole.

A file holds the states of the components of one process, each pickled by itself, with the mission's clock, the process' boot and a
checksum. It is written aside and renamed, so that a kill at any moment leaves the last one or the new one. Pickles can run code,
so a file is read only where it belongs to this user, nobody else may write it, and it names classes of components' packages alone.
"""

import hashlib
import io
import os
import pickle
import stat
from collections.abc import Iterable, Mapping
from copyreg import dispatch_table
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import msgspec

from blackboard.errors import BoardError, CheckpointError
from blackboard.kinds import Kind
from blackboard.messages.base import Count, Name, Seconds
from blackboard.mission import Mission, Spec
from blackboard.vocabulary import Vocabulary

MAGIC = b"ski checkpoint 1\n"  # the number counts forms of this file
SUFFIX = ".checkpoint"
MAX_BYTES = 256_000_000  # a whole building's state is some megabytes
MAX_HEADER_BYTES = 1_000_000
SHARED_PACKAGES = ("blackboard", "knowledge_sources", "behaviours", "rules", "sim")
PLAIN = {  # what else a state may be made of
    "builtins": {"set", "frozenset", "bytearray", "complex", "range", "slice", "object"}
    | {"bool", "int", "float", "str", "bytes", "tuple", "list", "dict"},
    "collections": {"deque", "OrderedDict", "defaultdict", "Counter"},
    "copyreg": {"_reconstructor", "__newobj__"},
    "msgspec._utils": {"rebuild"},
    "numpy": {"ndarray", "dtype"},
    "pathlib": {"Path", "PosixPath", "PurePosixPath"},
}
NUMPY = {"_reconstruct", "scalar", "_frombuffer", "__generator_ctor", "__bit_generator_ctor", "PCG64", "Generator"}
NUMPY |= {"SeedSequence", "__pyx_unpickle_SeedSequence"}


class _Part(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    name: Name
    size: Count
    lost: str = ""  # why the component begins anew


class _Header(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    identity: Name
    boot: Name
    now_s: Seconds
    run_s: Seconds | None  # when the mission's clock was 0: tells a run from another
    sha256: str
    parts: tuple[_Part, ...]


def mission_identity(mission: Mission, seed: int) -> str:
    """Return what tells this mission, with its settings and seed, from every other: a checkpoint of another is not taken.

    So does another release of ours: what its components kept may not be what these understand.
    """
    said: list[object] = [version("sensory-knowledge-integrator"), mission.params, mission.control, seed]
    specs = _specs(mission)
    said += [(s.type.__module__, s.type.__qualname__, s.name, s.params, s.rating, s.wiring) for s in specs]
    return f"{mission.name}-{hashlib.sha256(repr(said).encode()).hexdigest()[:16]}"


def packages_of(mission: Mission) -> set[str]:
    """Return the packages, or the files, that a mission's components come from: states may be made of their classes."""
    return {spec.type.__module__.partition(".")[0] for spec in _specs(mission)}


def _specs(mission: Mission) -> list[Spec]:
    some = (mission.coordinator, mission.rules, mission.safety)
    return [
        mission.robot,
        *mission.knowledge_sources,
        *mission.behaviours,
        *(spec for spec in some if spec is not None),
    ]


class Checkpointer:
    """Writes the states of one process' components, every so often on the mission's clock."""

    def __init__(self, path: Path, identity: str, *, boot: str, every_s: float = 1.0) -> None:
        self.path = path
        self._identity = identity
        self._boot = boot
        self._every_s = every_s
        self._written_s: float | None = None
        self._told: set[str] = set()
        try:
            path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        except OSError as error:
            raise CheckpointError(f"{path.parent}: cannot be made ({error.strerror}); name another folder") from None

    def is_due(self, now_s: float) -> bool:
        """Say whether the next one should be written."""
        return self._written_s is None or now_s - self._written_s >= self._every_s - 1e-9

    def write(self, now_s: float, states: Mapping[str, object], run_s: float | None = None) -> dict[str, str]:
        """Write a checkpoint of the run that began at `run_s`.

        Return which components' states could not be kept, and why: each once, however often that is so.
        Raises CheckpointError where the file cannot be written; the one before it stays.
        """
        self._written_s = now_s
        parts, bodies = [], []
        for name, state in states.items():
            lost, body = "", b""
            try:
                body = dumped(state)
            except Exception as error:  # whatever a component holds
                lost = f"{type(error).__name__}: {error}"[:1000]
            parts.append(_Part(name, len(body), lost))
            bodies.append(body)
        body = b"".join(bodies)
        header = _Header(
            identity=self._identity,
            boot=self._boot,
            now_s=now_s,
            run_s=run_s,
            sha256=hashlib.sha256(body).hexdigest(),
            parts=tuple(parts),
        )
        self._replace(MAGIC + msgspec.json.encode(header) + b"\n" + body)
        news = {part.name: part.lost for part in parts if part.lost and part.name not in self._told}
        self._told |= news.keys()
        return news

    def _replace(self, data: bytes) -> None:
        aside = self.path.with_name(f"{self.path.name}.new")
        try:
            file = os.open(aside, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_NOFOLLOW, 0o600)
            try:
                os.fchmod(file, 0o600)
                view = memoryview(data)
                while view:
                    view = view[os.write(file, view) :]
            finally:
                os.close(file)
            aside.replace(self.path)
        except OSError as error:
            raise CheckpointError(
                f"{self.path}: cannot be written ({error.strerror}); after a restart its components begin anew"
            ) from None


@dataclass(frozen=True)
class Checkpoint:
    """A checkpoint as it was read: when, of which run, by which boot, and each component's state, still pickled."""

    path: Path
    boot: str
    now_s: float
    run_s: float | None
    pickled: Mapping[str, bytes]
    lost: Mapping[str, str]

    def state(self, name: str, vocabulary: Vocabulary, packages: Iterable[str] = ()) -> object:
        """Return a component's state. Raises CheckpointError where there is none, or none that can be read."""
        if name in self.lost:
            raise CheckpointError(f"the state of {name} could not be kept ({self.lost[name]})")
        if name not in self.pickled:
            raise CheckpointError(f"{self.path}: holds no state of {name}")
        try:
            return loaded(self.pickled[name], vocabulary, packages)
        except Exception as error:  # of any class' own making
            raise CheckpointError(
                f"{self.path}: the state of {name} cannot be read ({type(error).__name__}: {error})"
            ) from None

    def states(self, vocabulary: Vocabulary, packages: Iterable[str] = ()) -> tuple[dict[str, object], dict[str, str]]:
        """Return all states that can be read, by component, and of the others why not."""
        states, lost = {}, dict(self.lost)
        for name in self.pickled:
            try:
                states[name] = self.state(name, vocabulary, packages)
            except CheckpointError as error:
                lost[name] = str(error)
        return states, lost


def read_checkpoint(path: Path, identity: str) -> Checkpoint | None:
    """Read a file; None where there is none.

    Raises CheckpointError for one that is torn, of another form or mission, not this user's, or open to others for writing.
    """
    data = _read(path)
    if data is None:
        return None
    start, _, rest = data.partition(b"\n")
    if start + b"\n" != MAGIC:
        raise CheckpointError(f"{path}: not a checkpoint of this version; its components begin anew")
    text, newline, body = rest.partition(b"\n")
    if not newline or len(text) > MAX_HEADER_BYTES:
        raise CheckpointError(f"{path}: torn; its components begin anew")
    try:
        header = msgspec.json.decode(text, type=_Header)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise CheckpointError(f"{path}: not a checkpoint ({error}); its components begin anew") from None
    if header.identity != identity:
        raise CheckpointError(
            f"{path}: of another mission ({header.identity}), this one is {identity}; its components begin anew"
        )
    whole = sum(part.size for part in header.parts) == len(body)
    if not whole or hashlib.sha256(body).hexdigest() != header.sha256:
        raise CheckpointError(f"{path}: torn; its components begin anew")
    pickled, at = {}, 0
    for part in header.parts:
        if not part.lost:
            pickled[part.name] = body[at : at + part.size]
        at += part.size
    lost = {part.name: part.lost for part in header.parts if part.lost}
    return Checkpoint(path, header.boot, header.now_s, header.run_s, pickled, lost)


def _read(path: Path) -> bytes | None:
    try:
        file = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise CheckpointError(f"{path}: cannot be read ({error.strerror}); its components begin anew") from None
    with os.fdopen(file, "rb") as opened:
        found = os.fstat(file)
        if not stat.S_ISREG(found.st_mode) or found.st_uid != os.getuid() or found.st_mode & 0o022:
            raise CheckpointError(f"{path}: not a file that this user alone may write; its components begin anew")
        if found.st_size > MAX_BYTES:
            raise CheckpointError(f"{path}: {found.st_size} bytes, the limit is {MAX_BYTES}; its components begin anew")
        return opened.read()


def dumped(state: object) -> bytes:
    """Pickle a state; kinds are named by their paths, since each mission has its own."""
    buffer = io.BytesIO()
    pickler = pickle.Pickler(buffer, protocol=5)
    pickler.dispatch_table = {**dispatch_table, Kind: _by_path}
    pickler.dump(state)
    return buffer.getvalue()


def loaded(data: bytes, vocabulary: Vocabulary, packages: Iterable[str] = ()) -> object:
    """Return a pickled state; `packages` are those of components beside our own. Raises whatever pickle raises."""
    return _Loader(io.BytesIO(data), vocabulary, packages).load()


def _by_path(kind: Kind[Any]) -> tuple[Any, tuple[str]]:
    return kind_at, (kind.path,)


def kind_at(path: str) -> Kind[Any]:
    """Stand for a kind in a pickle; the mission's vocabulary is asked where it is read."""
    raise BoardError(f"kind '{path}' was asked for outside a mission")


class _Loader(pickle.Unpickler):
    def __init__(self, file: io.BytesIO, vocabulary: Vocabulary, packages: Iterable[str]) -> None:
        super().__init__(file)
        self._vocabulary = vocabulary
        self._packages = {*SHARED_PACKAGES, *packages}

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) == (__name__, kind_at.__name__):
            return self._vocabulary.at
        package = module.partition(".")[0]
        if name in PLAIN.get(module, ()) or (package == "numpy" and name in NUMPY):
            return super().find_class(module, name)
        found = super().find_class(module, name) if package in self._packages else None
        if getattr(found, "__module__", None) != module:  # also what a module of ours has imported
            raise pickle.UnpicklingError(f"{module}.{name} is no part of a state")
        return found
