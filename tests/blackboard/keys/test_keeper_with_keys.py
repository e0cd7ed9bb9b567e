"""`ski board serve --keys` as a process: who is let in, what it tells of who is not, and that it listens nowhere without keys."""

import re
import shlex
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from blackboard.command.main import main
from blackboard.errors import LinkError
from blackboard.keys.members import ROLES
from blackboard.keys.roles import POSTS
from blackboard.link.session import LinkParams, open_session

pytest.importorskip("zenoh")

DOCUMENT = Path(__file__).parents[3] / "docs" / "access.md"
MOTIVATION = "ski/k2a/motivations/motivation/wander"


@pytest.fixture
def port():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


@pytest.fixture
def serve(tmp_path):
    """Start `ski board serve`; every process ends with the test."""
    started = []

    def start(listen, *more):
        command = [sys.executable, "-m", "blackboard.command.main", "board", "serve", "--listen", listen, *more]
        process = subprocess.Popen(
            [*command, "--out", str(tmp_path / "boards")], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        started.append(process)
        return process

    try:
        yield start
    finally:
        for process in started:
            process.kill()
            process.communicate()


def test_what_is_rejected_is_told_and_counted(serve, keys, port, capsys):
    keeper = serve(f"127.0.0.1:{port}", "--keys", str(keys))
    assert keeper.stdout.readline().startswith(f"listening at tls/127.0.0.1:{port}, journals in ")
    address = f"tls/127.0.0.1:{port}"
    with open_session(LinkParams(address=address, keys=keys / "members" / "eve")) as session:
        for _ in range(10):
            session.put(MOTIVATION, b"{}")
        told = [keeper.stderr.readline() for _ in range(2)]
    assert [line.split(" ", 1)[1] for line in told] == [
        f"rejected: post by eve, {MOTIVATION}\n",
        f"rejected: post by eve, {MOTIVATION} (10 times by now)\n",
    ]
    assert main(["board", "status", "--connect", address, "--keys", str(keys / "members" / "olga")]) == 0
    assert "rejected by access control: 10 (post by eve)\n" in capsys.readouterr().out
    with pytest.raises(LinkError, match=r"no keeper answers at tls/.* and takes these keys; `ski doctor`"):
        open_session(LinkParams(address=f"tls/127.0.0.2:{port}", keys=keys / "members" / "eve"))


@pytest.mark.parametrize(
    ("listen", "says"),
    [
        ("0.0.0.0", "can be reached from other machines, which takes keys: `ski keys init DIR --host NAME`"),
        ("tcp/[::]:{port}", "can be reached from other machines, which takes keys"),
        ("tls/127.0.0.1:{port}", "takes keys: `ski keys init DIR --host NAME`"),
        ("127.0.0.1:port", "is not of the form tcp/HOST:PORT"),
        ("127.0.0.1:0", "the port 0 is outside 1..65535"),
    ],
)
def test_without_keys_it_listens_on_this_machine_only(serve, port, listen, says):
    keeper = serve(listen.format(port=port))
    said = keeper.communicate()[1]
    assert (keeper.returncode, said.count("\n")) == (2, 1)
    assert says in said


def test_making_keys_takes_a_package(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "cryptography", None)
    monkeypatch.delitem(sys.modules, "blackboard.keys.folder", raising=False)
    monkeypatch.delitem(sys.modules, "blackboard.keys.certificates", raising=False)
    assert main(["keys", "init", str(tmp_path / "keys"), "--host", "h"]) == 2
    said = capsys.readouterr().err
    assert said == (
        "ski: making keys takes the package cryptography: pip install 'sensory-knowledge-integrator[access]'\n"
    )


def test_the_commands_of_the_document_make_keys(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lines = [
        shlex.split(line, comments=True) for line in DOCUMENT.read_text().splitlines() if line.startswith("ski keys ")
    ]
    assert len(lines) >= 4
    for words in lines:
        assert main(words[1:]) == 0, words
    made = {path.name for path in (tmp_path / "keys" / "members").iterdir()}
    assert made == {words[5] for words in lines if words[2] == "add"}


def test_the_document_tells_what_each_role_posts():
    rows = dict(re.findall(r"^\| (\w+) \| (.*) \|$", DOCUMENT.read_text(), flags=re.MULTILINE))
    for role in ROLES:
        names = {path.removesuffix("/**").split("/")[-1] for path in POSTS[role]} - {"feature", "symbol"}
        told = set(re.findall(r"[a-z_]+", rows[role]))
        assert names <= told, (role, names - told)
