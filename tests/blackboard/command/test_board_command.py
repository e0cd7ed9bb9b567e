"""`ski board serve` as a process, killed and started again, and `ski board status`."""

import json
import signal
import socket
import subprocess
import sys
from queue import SimpleQueue

import pytest

from blackboard.board import Board
from blackboard.command.main import main
from blackboard.journal import line_of
from blackboard.kinds import BATTERY
from blackboard.link.envelope import Origin, attachment_of, split_snapshot
from blackboard.link.session import LinkParams, open_session
from blackboard.messages.sensing import Battery
from blackboard.vocabulary import Vocabulary

WAIT_S = 20.0


@pytest.fixture
def address():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{free.getsockname()[1]}"


@pytest.fixture
def serve(tmp_path, address):
    """Start `ski board serve`; every process ends with the test."""
    started = []

    def start(*more, at=address, limit_kb=None):
        limit = [] if limit_kb is None else ["bash", "-c", f'ulimit -f {limit_kb}; exec "$@"', "limited"]
        command = [*limit, sys.executable, "-m", "blackboard.command.main", "board", "serve", "--listen", at]
        process = subprocess.Popen(
            [*command, "--out", str(tmp_path / "boards"), *more],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        return process

    try:
        yield start
    finally:
        for process in started:
            process.kill()
            process.communicate()


def listening(process):
    lines = []
    for line in process.stdout:
        lines.append(line)
        if line.startswith("listening"):
            return lines
    raise AssertionError(process.stderr.read())


def entries(first, last):
    """Return keys and payloads of readings."""
    board = Board(Vocabulary(), robot="k2a")
    sent = []
    board.outgoing = lambda kind, entry, raw: sent.append((entry.key, line_of(entry, raw)))
    for n in range(1, last + 1):
        board.post(BATTERY, Battery(charge_fraction=n / 1000), source="robot", stamp_s=float(n))
    return sent[first - 1 :]


def post(address, first, last):
    """Post and return once the keeper has acknowledged."""
    sent = entries(1, last)
    with open_session(LinkParams(address=address)) as session:
        heard = SimpleQueue()
        session.subscribe("ski/k2a/@keeper/beat", lambda a: heard.put(json.loads(a.payload)))
        up_to = first - 1
        while up_to < last:  # what is dropped on the way is sent again
            for n in range(up_to + 1, last + 1):
                session.put(*sent[n - 1], attachment_of(Origin("robot", "b1", "signal", n)), "signal")
            up_to = heard.get(timeout=WAIT_S)["lanes"].get("robot", {}).get("b1", {}).get("signal", up_to)


def board_of(address):
    with open_session(LinkParams(address=address)) as session:
        clock = json.loads(session.ask("ski/k2a/@keeper/begin", b'{"begin": 50.0}', timeout_s=WAIT_S)[0].payload)
        header, envelopes = split_snapshot(session.ask("ski/k2a/@keeper/snapshot", timeout_s=WAIT_S)[0].payload)
        return header.lanes, envelopes, clock["now_s"]


def test_killed_in_the_middle_it_comes_back_with_everything(serve, address, tmp_path, capsys):
    first = serve()
    assert listening(first) == [f"listening at {address}, journals in {tmp_path / 'boards'}\n"]
    post(address, 1, 200)
    before = board_of(address)
    first.send_signal(signal.SIGKILL)
    first.wait()
    with (tmp_path / "boards" / "k2a" / "board.jsonl").open("ab") as file:
        file.write(b'{"key":"ski/k2a/observ')  # torn
    second = serve()
    assert "board of k2a: 1 entries stand again" in listening(second)[0]
    after = board_of(address)
    assert after[:2] == before[:2]
    assert after[2] >= before[2] >= 50.0
    post(address, 201, 210)
    assert main(["board", "status", "--connect", address]) == 0
    out = capsys.readouterr().out
    assert "nothing is missing" in out
    assert ["robot", "b1", "signal", "210", "210", "0"] in [line.split() for line in out.splitlines()]
    assert main(["board", "status", "--connect", address, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["boards"][0]["journal_bytes"] == (tmp_path / "boards" / "k2a" / "board.jsonl").stat().st_size
    second.send_signal(signal.SIGTERM)
    assert second.wait(timeout=WAIT_S) == 0
    assert second.stderr.read() == ""
    assert main(["why", "observations/signal/battery", "--in", str(tmp_path / "boards")]) == 0
    third = serve("--fresh")
    listening(third)
    assert board_of(address)[:2] == ({}, [])
    assert len(list((tmp_path / "boards" / "earlier").glob("*/k2a/board.jsonl"))) == 1


def test_on_a_full_disk_nothing_is_acknowledged_that_is_not_written(serve, address, tmp_path, capsys):
    full = serve(limit_kb=20)
    listening(full)
    with open_session(LinkParams(address=address)) as session:
        said = ""
        while "File too large" not in said:  # what is dropped on the way is sent again
            for n, (key, payload) in enumerate(entries(1, 500), 1):
                session.put(key, payload, attachment_of(Origin("robot", "b1", "signal", n)), "signal")
            assert main(["board", "status", "--connect", address]) in (0, 1)
            said = capsys.readouterr().out
        assert main(["board", "status", "--connect", address]) == 1
    acknowledged = board_of(address)[0]["robot"]["b1"]["signal"]
    full.send_signal(signal.SIGKILL)
    full.wait()
    written = (tmp_path / "boards" / "k2a" / "board.jsonl").read_bytes().count(b"\n")
    assert 0 < acknowledged <= written < 500
    listening(serve())
    post(address, 1, 500)
    assert main(["board", "status", "--connect", address]) == 0


def test_a_gap_is_told_and_the_exit_status_says_so(serve, address, capsys):
    listening(serve())
    with open_session(LinkParams(address=address)) as session:
        payload = (
            b'{"key":"ski/k2a/observations/signal/battery","revision":2,"event":"revised","stamp_s":1,"source":"r",'
        )
        payload += b'"value":{"charge_fraction":1}}'
        status = 0
        while status != 1:  # it is given time to arrive
            session.put("ski/k2a/observations/signal/battery", payload, b"robot b1 signal 2", "signal")
            status = main(["board", "status", "--connect", address])
    assert "1 envelopes are MISSING" in capsys.readouterr().out


def test_refusals_are_one_line(serve, address, tmp_path, capsys):
    first = serve()
    listening(first)
    second = serve("--out", str(tmp_path / "other"))
    said = second.communicate(timeout=WAIT_S)[1]
    assert (second.returncode, len(said.splitlines())) == (2, 1)
    assert f"{address}: cannot be listened on" in said
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        elsewhere = f"tcp/127.0.0.1:{free.getsockname()[1]}"
    third = serve(at=elsewhere)
    said = third.communicate(timeout=WAIT_S)[1]
    assert (third.returncode, len(said.splitlines())) == (2, 1)
    assert f"another keeper (process {first.pid}) uses it" in said
    assert main(["board", "serve", "--listen", "tcp/0.0.0.0:7510"]) == 2
    assert main(["board", "serve", "--listen", "nonsense:x"]) == 2
    assert main(["board", "serve", "no-such-mission"]) == 2
    assert main(["board", "status", "--connect", elsewhere]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 4
    assert "keys" in lines[0]
    assert "no keeper answers" in lines[3]
