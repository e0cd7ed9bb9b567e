"""`ski post` at a keeper: what goes through, and what is refused before anything is sent."""

import io
import json
from collections.abc import Callable
from typing import Any

import pytest

from blackboard.board import Board
from blackboard.command.main import main
from blackboard.errors import BoardError
from blackboard.keeper.service import Keeper
from blackboard.kinds import BEHAVIOUR, HOST, MOTIVATION
from blackboard.messages.hosts import HostStatus
from blackboard.messages.motion import BehaviourStatus, Motivation
from blackboard.vocabulary import Vocabulary
from blackboard.watching.saying import check_speaker, read_value, whole_key

NAV = "ski/k2a/motivations/motivation/target_nav"
Post = Callable[..., tuple[int, str, str]]


@pytest.fixture
def post(keeper: Keeper, address: str, capsys: pytest.CaptureFixture[str]) -> Post:
    def run(*arguments: str) -> tuple[int, str, str]:
        status = main(["post", *arguments, "--connect", address])
        out, err = capsys.readouterr()
        return status, out, err

    return run


def standing(address: str, capsys: pytest.CaptureFixture[str]) -> list[dict[str, Any]]:
    main(["get", "--json", "--connect", address])
    found: list[dict[str, Any]] = json.loads(capsys.readouterr().out)
    return found


def test_a_motivation_is_numbered_and_revised_and_retracted(
    post: Post, address: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert post(NAV, '{"on": true, "parameters": [1.0, 2.0]}') == (
        0,
        f"{NAV} r1 at 0.00 s by operator: on yes, number 1, parameters [1 2]\n",
        "",
    )
    status, out, _ = post("motivations/motivation/target_nav", '{"on": false}', "--json")  # there is one robot now
    posted = json.loads(out)
    assert (status, posted["revision"], posted["event"], posted["value"]["number"]) == (0, 2, "revised", 2)
    assert standing(address, capsys) == [posted]
    assert "r3 retracted" in post(NAV, "--retract")[1]
    assert standing(address, capsys) == []
    assert "r4 at" in post(NAV, '{"on": true}')[1]


def test_reasons_for_and_against(post: Post, address: str, capsys: pytest.CaptureFixture[str]) -> None:
    post(NAV, '{"on": true}')
    assert post(NAV, "--for", "it is near", "--as", "me", "--about", "place")[0] == 0
    assert post(NAV, "--against", "it is far", "--as", "me", "--about", "time")[0] == 0
    (entry,) = standing(address, capsys)
    assert entry["revision"] == 3
    assert [(e["who"], e["verdict"], e["why"], e["about"]) for e in entry["endorsements"]] == [
        ("me", "for", "it is near", "place"),
        ("me", "against", "it is far", "time"),
    ]
    assert entry["value_from"] == [1, 0.0]
    status, _, err = post(NAV, "--for", "x" * 5000)
    assert (status, "why" in err, len(err.splitlines())) == (2, True, 1)


def test_what_is_refused_leaves_the_board_as_it_was(
    post: Post, address: str, capsys: pytest.CaptureFixture[str]
) -> None:
    post(NAV, '{"on": true}')
    before = standing(address, capsys)
    for arguments, said in [
        ((NAV, '{"on": 1}'), f"{NAV}: on = 1: Expected bool, got int"),
        ((NAV, '{"on": true, "speed": 3}'), f"{NAV}: Object contains unknown field speed"),
        ((NAV, '{"on": tru'), f"{NAV}: not JSON"),
        ((NAV, "[1]"), f"{NAV}: Expected object, got array"),
        (
            ("commands/velocity", '{"forward_mps": 900, "turn_radps": 0, "valid_until_s": 1}'),
            "forward_mps = 900: Expected",
        ),
        (("commands/velocty", "{}"), "did you mean 'commands/velocity'"),
        (("motivations/motivation", "{}"), "needs an id: ski/k2a/motivations/motivation/<id>"),
        ((NAV, '{"on": true}', "--as", "somebody"), f"{NAV} belongs to operator; somebody may endorse it, not post it"),
        ((NAV, "--retract", "--as", "somebody"), "somebody may endorse it, not retract it"),
        ((NAV, '{"on": true}', "--as", "a b"), "--as 'a b': letters, digits"),
        (("status/robot", "--for", "good"), "nothing stands there to be endorsed"),
        ((NAV,), "give either a JSON value to post, or one of --retract"),
        ((NAV, '{"on": true}', "--retract"), "give either a JSON value"),
        (("ski/k2a/nothing/here", "{}"), "names no kind of this vocabulary"),
        ((NAV, '{"on": true}', "--mission", "no-such"), "there is no mission 'no-such'"),
    ]:
        status, out, err = post(*arguments)
        assert (status, out) == (2, ""), arguments
        assert said in err
        assert len(err.splitlines()) == 1
    assert standing(address, capsys) == before


def test_the_value_may_come_from_standard_input(post: Post, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b'{"on": true}')))
    assert post(NAV, "-")[0] == 0


def test_which_robot() -> None:
    assert whole_key("ski/a/commands/drive", []) == "ski/a/commands/drive"
    assert whole_key("commands/drive", ["a"]) == "ski/a/commands/drive"
    with pytest.raises(BoardError, match="there are a, b"):
        whole_key("commands/drive", ["b", "a"])
    with pytest.raises(BoardError, match="there are none yet"):
        whole_key("commands/drive", [])


def test_a_person_speaks_under_a_name_of_their_own() -> None:
    board = Board(Vocabulary())
    alive = HostStatus(state="alive", boot="b", components=("eou_grid",))
    board.post(HOST, alive, id="maps", source="keeper")
    with pytest.raises(BoardError, match="eou_grid is a component that runs in maps"):
        check_speaker(board, "eou_grid")
    check_speaker(board, "operator")
    board.post(HOST, HostStatus(state="dead", boot="b", components=("eou_grid",)), id="maps", source="keeper")
    check_speaker(board, "eou_grid")


def test_a_motivations_number_follows_on_what_was_asked_and_on_what_was_taken_up() -> None:
    board = Board(Vocabulary())
    assert read_value(board, MOTIVATION, "nav", b'{"on": true}') == Motivation(on=True, number=1)
    board.post(MOTIVATION, Motivation(on=True, number=4), id="nav", source="rules")
    assert read_value(board, MOTIVATION, "nav", b'{"on": true}').number == 5
    board.post(BEHAVIOUR, BehaviourStatus(state="idle", acknowledged=7), id="nav", source="nav")
    assert read_value(board, MOTIVATION, "nav", b'{"on": true}').number == 8
    assert read_value(board, MOTIVATION, "nav", b'{"on": true, "number": 2}').number == 2
    with pytest.raises(BoardError, match="there is no behaviour 'nva'; did you mean 'nav'"):
        read_value(board, MOTIVATION, "nva", b'{"on": true}')
