"""From an entry down to the readings, out of `board.jsonl`."""

from pathlib import Path

import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.entry import Support
from blackboard.errors import BoardError, RecordingError
from blackboard.journal import FILE_NAME, JournalWriter, read_journal
from blackboard.kinds import DRIVE, ODOMETRY, RESPONSE, TRAP, VELOCITY
from blackboard.messages.geometry import IDENTITY, Point
from blackboard.messages.motion import Drive, Response, Velocity
from blackboard.messages.sensing import Odometry
from blackboard.messages.symbols import Trap
from blackboard.uncertainty.endorsements import standing
from blackboard.vocabulary import Vocabulary
from blackboard.why import Record, render


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    board = Board(Vocabulary(), robot="k2a")
    with JournalWriter(tmp_path / FILE_NAME) as journal:
        board.journal = journal
        for cycle in range(3):
            board.now_s = 0.1 * cycle
            reading = board.post(ODOMETRY, Odometry(pose=IDENTITY, forward_mps=0.1 * cycle), source="robot")
            response = board.post(
                RESPONSE,
                Response(forward=1.0),
                id="avoid",
                source="avoid",
                supports=(Support(reading.key, 1, cycle + 1),),
            )
            velocity = board.post(
                VELOCITY,
                Velocity(forward_mps=0.3, turn_radps=0.0, valid_until_s=1.0),
                source="sum",
                supports=(response.as_support(),),
            )
            board.post(
                DRIVE,
                Drive(forward_mps=0.2, turn_radps=0.0, limited_by="clearance", clearance_m=0.4),
                source="safety",
                supports=(velocity.as_support(), reading.as_support()),
            )
        board.endorse(velocity.key, who="test", verdict="for", why="the way is free")
    return tmp_path


def test_down_to_the_readings(folder: Path) -> None:
    record = Record(read_journal(folder))
    lines = list(render(record.explain(record.find("commands/drive"))))
    assert lines[0].startswith("commands/drive revision 3 at 0.20 s by safety: forward_mps 0.2")
    assert "limited_by clearance" in lines[0]
    assert lines[1].startswith("├─ commands/velocity revision 3")
    assert lines[2].startswith("│  └─ commands/response/avoid revision 3")
    assert "observations/signal/odometry, 3 revisions 1 to 3 (0.00 to 0.20 s)" in lines[3]
    assert lines[4].startswith("└─ observations/signal/odometry revision 3")
    assert len(lines) == 5


def test_as_of_an_earlier_time_and_with_endorsements(folder: Path) -> None:
    record = Record(read_journal(folder))
    assert record.find("ski/k2a/commands/drive", at_s=0.15).revision == 2
    assert record.find("**/drive").revision == 3
    assert "   for (test): the way is free" in render(record.explain(record.find("commands/velocity")))
    shallow = record.explain(record.find("commands/drive"), depth=1)
    assert [r.reasons for r in shallow.reasons] == [[], []]
    tree = shallow.as_dict()
    assert tree["key"] == "ski/k2a/commands/drive"


def test_separate_reasons_and_how_long_they_stood(tmp_path: Path) -> None:
    board = Board(Vocabulary())
    access = Access(board, "mug_detector", (), (TRAP,))
    with JournalWriter(tmp_path / FILE_NAME) as journal:
        board.journal = journal
        mug = access.post(TRAP, Trap(trap="u-shape", place=Point(x_m=0.0, y_m=0.0), size_m=1.0), id="1")
        access.endorse(mug, "for", "a body of that size", about="body")
        access.endorse(mug, "against", "no handle", about="handle")
        board.now_s = 9.0
        access.endorse(mug, "for", "seen from behind", about="handle", strength="strong")
        access.endorse(mug, "against", "somebody stands before it")
        access.withdraw(mug, "body", "it is in doubt again")
    record = Record(read_journal(tmp_path))
    assert list(record.explain(record.find("**/trap/1")).said) == [
        "for (mug_detector, body, until 9.00 s): a body of that size",
        "against (mug_detector, handle, until 9.00 s): no handle",
        "for (mug_detector, handle): seen from behind",
        "against (mug_detector): somebody stands before it",
        "withdrawn (mug_detector, body): it is in doubt again",
    ]
    entry = board.entries(TRAP)[0]
    assert [(e.verdict, e.about, e.strength) for e in standing(entry.endorsements)] == [
        ("against", "", "fair"),
        ("for", "handle", "strong"),
    ]


def test_what_is_not_there(folder: Path) -> None:
    record = Record(read_journal(folder))
    with pytest.raises(BoardError, match="nothing stood at 'commands/drove'; did you mean 'commands/drive'"):
        record.find("commands/drove")
    with pytest.raises(BoardError, match=r"matches 3 keys \(commands/drive, .*name one"):
        record.find("commands/**")
    with pytest.raises(BoardError, match=r"first posted at 0\.000 s"):
        record.find("commands/drive", at_s=-1.0)


def test_a_damaged_journal(folder: Path, tmp_path: Path) -> None:
    path = folder / FILE_NAME
    whole = path.read_bytes()
    path.write_bytes(whole[:-20])  # killed while writing: what came before is there
    assert len(list(read_journal(folder))) == 12
    path.write_bytes(b'{"key": 3}\n' + whole)
    with pytest.raises(RecordingError, match=r"board\.jsonl:1: not an entry of a board"):
        list(read_journal(folder))
    with pytest.raises(RecordingError, match="there is no such file; name the output folder of a run"):
        list(read_journal(tmp_path / "nowhere"))
