"""A keeper at work, and a link to it; an environment for programs that our plug-ins belong to."""

import os
import socket
import sys
import tomllib
from pathlib import Path
from threading import Thread

import pytest

from blackboard.keeper.service import Keeper
from blackboard.link.session import LinkParams, open_session
from blackboard.vocabulary import Vocabulary


@pytest.fixture
def address():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{free.getsockname()[1]}"


@pytest.fixture
def keeper(tmp_path, address):
    """A keeper at work in a thread of its own."""
    at_work = Keeper(LinkParams(address=address), tmp_path / "boards", Vocabulary())
    try:
        at_work.open()
        thread = Thread(target=at_work.run)
        thread.start()
        yield at_work
        at_work.stop()
        thread.join()
    finally:
        at_work.close()


@pytest.fixture
def client(keeper, address):
    with open_session(LinkParams(address=address)) as session:
        yield session


@pytest.fixture
def plugged_in(tmp_path: Path) -> dict[str, str]:
    """Return an environment in which pyproject's entry points count, however old those of the installed package are."""
    root = Path(__file__).resolve().parents[2]
    points = tomllib.loads((root / "pyproject.toml").read_text())["project"]["entry-points"]
    folder = tmp_path / "ski_points-0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: ski-points\nVersion: 0\n")
    lines = [f"[{group}]\n" + "".join(f"{k} = {v}\n" for k, v in named.items()) for group, named in points.items()]
    (folder / "entry_points.txt").write_text("\n".join(lines))
    return {
        **os.environ,
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]),
        "PYTHONPATH": f"{tmp_path}{os.pathsep}{root}",
        "MPLCONFIGDIR": str(tmp_path),
    }
