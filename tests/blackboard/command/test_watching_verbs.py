"""`ski echo`, `ski get` and `ski watch` at a router, with a person's arguments."""

import json
import socket
import threading
from collections.abc import Iterator

import pytest

from blackboard.command.main import main
from blackboard.link.session import LinkParams, Question, Session, open_router

DRIVE = "ski/k2a/commands/drive"
ODD = "ski/k2a/status/odd"


def entry(key: str, revision: int) -> bytes:
    value = {"forward_mps": 0.5, "turn_radps": 0.0, "limited_by": "nothing"}
    line = {"key": key, "revision": revision, "event": "revised", "stamp_s": 1.0, "source": "safety", "value": value}
    return json.dumps(line, indent=1).encode()


def answer(question: Question) -> None:
    if question.key == "ski/*/refused/**":
        question.fail("no\nway")
    elif question.key in ("ski/**", "ski/*/commands/drive/**"):
        question.reply(DRIVE, entry(DRIVE, 7), b"robot boot command 7")
    if question.key == "ski/**":
        question.reply(ODD, b"\xff")
    question.finish()


@pytest.fixture
def address() -> Iterator[str]:
    """A keeper's address where entries come all the time: revisions of one slot, and what is no entry."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp/127.0.0.1:{free.getsockname()[1]}"
    over = threading.Event()

    def post(session: Session) -> None:
        revision = 8
        while not over.wait(0.01):
            session.put(DRIVE, entry(DRIVE, revision), b"robot boot command %d" % revision, lane="command")
            session.put(ODD, b"\xff", b"")
            revision += 1

    with open_router(LinkParams(address=address)) as session:
        session.serve("ski/**", answer)
        poster = threading.Thread(target=post, args=(session,))
        poster.start()
        try:
            yield address
        finally:
            over.set()
            poster.join()


def test_echo(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["echo", "commands/drive", "--count", "3", "--connect", address]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 3
    revisions = [int(line.split(" ")[1].removeprefix("r")) for line in lines]
    assert revisions == list(range(revisions[0], revisions[0] + 3))
    assert lines[0] == (
        f"{DRIVE} r{revisions[0]} at 1.00 s by safety: forward_mps 0.5, turn_radps 0, limited_by nothing"
    )


def test_echo_as_json_gives_lines_of_a_journal(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["echo", "--json", "--count", "4", "--connect", address]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert len(lines) == 4
    whole = [line for line in lines if line["key"] == DRIVE]
    assert whole[0]["value"]["forward_mps"] == 0.5
    assert {"key": ODD, "bytes": 1, "problem": "no JSON"} in lines


def test_get(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["get", "--connect", address]) == 0
    assert capsys.readouterr().out.splitlines() == [
        f"{DRIVE} r7 at 1.00 s by safety: forward_mps 0.5, turn_radps 0, limited_by nothing",
        f"{ODD} 1 bytes that are no JSON",
    ]
    assert main(["get", "commands/drive", "--json", "--connect", address]) == 0
    assert [found["revision"] for found in json.loads(capsys.readouterr().out)] == [7]


def test_get_where_nothing_stands_or_the_keeper_refuses(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["get", "status/robot", "--json", "--connect", address]) == 1
    out, err = capsys.readouterr()
    assert json.loads(out) == []
    assert err.startswith("ski: nothing stands at ski/*/status/robot/**; ")
    assert main(["get", "refused", "--connect", address]) == 2
    assert capsys.readouterr().err == "ski: the keeper refused to answer: no\\nway\n"


def test_watch_once(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["watch", "--json", "--for", "0.5", "--connect", address]) == 0
    table = json.loads(capsys.readouterr().out)
    drive, odd = table["rows"]
    assert (drive["key"], drive["type"], drive["source"], drive["host"]) == (DRIVE, "Drive", "safety", "robot")
    assert drive["rate_hz"] > 0
    assert drive["size_bytes"] > 100
    assert (odd["key"], odd["type"], odd["age_s"], odd["size_bytes"]) == (ODD, "", None, 1)
    assert main(["watch", "commands/drive", "--once", "--for", "0.1", "--connect", address]) == 0
    assert capsys.readouterr().out.splitlines()[2].split()[:4] == ["k2a/commands/drive", "Drive", "safety", "robot"]


def test_watch_until_the_time_is_up(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["watch", "--for", "0.1", "--sort", "rate", "--connect", address]) == 0
    assert "k2a/commands/drive" in capsys.readouterr().out


@pytest.mark.parametrize("verb", ["echo", "get", "watch"])
def test_faults_are_one_line(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        nobody = f"tcp/127.0.0.1:{free.getsockname()[1]}"
    assert main([verb, "a//b", "--connect", nobody]) == 2
    assert "empty chunk" in capsys.readouterr().err
    assert main([verb, "--connect", "udp/x:1"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_numbers_are_checked(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (["--count", "0"], ["--count", "-1"], ["--for", "nan"], ["--for", "0"]):
        with pytest.raises(SystemExit) as ended:
            main(["echo", *arguments])
        assert ended.value.code == 2
        assert "above 0" in capsys.readouterr().err


def test_nobody_there_is_one_line(capfd: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        nobody = f"tcp/127.0.0.1:{free.getsockname()[1]}"
    assert main(["get", "--connect", nobody]) == 2
    assert capfd.readouterr().err == (
        f"ski: no keeper answers at {nobody}; start one with `ski board serve` or name another --connect\n"
    )
