import os

import msgspec
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from blackboard.errors import OutputError
from blackboard.folder_lock import FolderLock
from blackboard.journal import in_stamp_order, read_journal
from blackboard.keeper.checking import Checker
from blackboard.keeper.kept_board import KeptBoard
from blackboard.keeper.params import KeeperParams
from blackboard.link.envelope import Envelope, LostQuestion, read_origin
from blackboard.vocabulary import Vocabulary


def board(folder, **params):
    return KeptBoard(folder, Checker(Vocabulary(), 100_000), KeeperParams(**params))


def known(kept):
    """Return all that must outlive a restart."""
    return kept.board(), kept.positions.told(), {name: p.beyond for name, p in kept.positions}


def lost(first, last, lane="signal"):
    return LostQuestion(host="robot", boot="b1", lane=lane, first=first, last=last)


def numbers(envelopes):
    return [e.origin.number for e in envelopes]


def test_what_comes_is_journalled_and_can_be_read_as_a_run(tmp_path, battery):
    kept = board(tmp_path)
    took = kept.take([battery(1), battery(2), battery(2)])
    assert (took.taken, took.written, kept.duplicates) == (2, True, 1)
    lines = list(read_journal(tmp_path))
    assert [(line.revision, line.origin) for line in lines] == [
        (1, ("robot", "b1", "signal", 1)),
        (2, ("robot", "b1", "signal", 2)),
    ]
    assert [e.payload for e in kept.board()] == [battery(2).payload]


def test_what_came_late_is_read_in_the_order_of_its_stamps(tmp_path, battery):
    kept = board(tmp_path)
    kept.take([battery(n) for n in (1, 4, 3)])
    kept.take([battery(2)])
    assert [line.revision for line in read_journal(tmp_path)] == [1, 4, 3, 2]
    assert [line.revision for line in in_stamp_order(read_journal(tmp_path))] == [1, 2, 3, 4]
    assert list(in_stamp_order([])) == []


REFUSED = [
    ("attachment", {"attachment": b""}),
    ("attachment", {"attachment": b"robot b1 signal 0"}),
    ("attachment", {"attachment": b"robot b1 fast 1"}),
    ("attachment", {"attachment": b"ro/bot b1 signal 1"}),
    ("attachment", {"attachment": b"robot b1 signal " + b"9" * 40}),
    ("attachment", {"attachment": "robot b1 signal ²".encode()}),
    ("lane", {"attachment": b"robot b1 control 1"}),
    ("form", {"payload": b""}),
    ("form", {"payload": b"{"}),
    ("form", {"payload": b"[]"}),
    ("form", {"payload": b"\xff\xfe}"}),
    ("form", {"payload": b'{"a":' * 10_000 + b"1" + b"}" * 10_000}),
    ("form", {"key": "ski/k2a/observations/signal/odometry"}),
    ("size", {"payload": b" " * 100_001}),
]


@pytest.mark.parametrize(("reason", "changes"), REFUSED)
def test_what_is_no_entry_is_refused_and_told_once(tmp_path, battery, reason, changes):
    kept = board(tmp_path)
    tell = [line for _ in range(3) for line in kept.take([battery(1, **changes)]).tell]
    assert len(tell) == 1
    assert f"refused ({reason})" in tell[0]
    assert kept.journal.size_bytes == 0
    assert kept.board() == []


def test_more_that_is_refused(tmp_path, battery):
    kept = board(tmp_path)
    payload = battery(1).payload
    bad = {
        "kind": payload.replace(b"signal/battery", b"signal/butter"),
        "value": payload.replace(b"0.01", b"1.01"),
        "form": payload[:-1] + b',"origin":["a","b","signal",1]}',
    }
    for number, (reason, text) in enumerate(bad.items(), 1):
        key = msgspec.json.decode(text)["key"]
        kept.take([battery(number, key=key, payload=text)])
        assert kept.refusals.by_reason[reason] == 1
    kept.take([battery(4, payload=payload.replace(b",", b",\n"))])
    assert kept.refusals.by_reason["form"] == 2
    assert kept.positions.told() == {"robot": {"b1": {"signal": 4}}}  # nobody needs to send them again
    kept.close()
    assert board(tmp_path).positions.told() == {"robot": {"b1": {"signal": 4}}}


def test_a_refusal_under_another_panel_moves_no_position(tmp_path, battery):
    kept = board(tmp_path)
    kept.take([battery(1, key="ski/k2a/control/switch/x", payload=b"{}")])
    assert kept.positions.told() == {}


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=50)
@given(data=st.data())
def test_any_order_any_repetition_any_restart_ends_the_same(tmp_path_factory, battery, data):
    sent = [battery(n, host=host) for host in ("robot", "other") for n in range(1, 8)]
    order = data.draw(st.permutations(sent * 2))
    batches = [order[i : i + 5] for i in range(0, len(order), 5)]
    folder = tmp_path_factory.mktemp("kept")
    kept = board(folder)
    for batch in batches:
        kept.take(batch)
        how = data.draw(st.sampled_from(["goes on", "killed", "closed", "torn"]))
        if how == "goes on":
            continue
        before = known(kept)
        if how == "closed":
            kept.close()
        if how == "torn":
            with (folder / "board.jsonl").open("ab") as file:
                file.write(b'{"key":"ski/k2a/obs')
        kept = board(folder)
        assert known(kept) == before
    assert kept.positions.told() == {host: {"b1": {"signal": 7}} for host in ("robot", "other")}
    assert len(list(read_journal(folder))) == 14
    assert numbers(kept.board()) == [7]


def test_a_restart_brings_back_what_was_missed_and_goes_on_from_a_checkpoint(tmp_path, battery):
    kept = board(tmp_path)
    kept.take([battery(n) for n in range(1, 11)])
    kept.checkpoint()
    kept.take([battery(n) for n in (11, 12, 15)])
    again = board(tmp_path)
    assert known(again) == known(kept)
    assert numbers(again.lost(lost(9, 20))) == [9, 10, 11, 12, 15]
    assert again.take([battery(15)]).taken == 0


@pytest.mark.parametrize("damage", ["other journal", "cut", "garbage"])
def test_a_checkpoint_that_does_not_fit_is_left_alone(tmp_path, battery, damage):
    kept = board(tmp_path)
    kept.take([battery(n) for n in range(1, 4)])
    kept.close()
    if damage == "garbage":
        (tmp_path / "checkpoint.jsonl").write_bytes(b"\xff{")
    else:
        lines = (tmp_path / "board.jsonl").read_bytes().splitlines(keepends=True)
        changed = lines[:2] if damage == "cut" else [lines[0], lines[1], lines[2].replace(b'"b1"', b'"b2"')]
        (tmp_path / "board.jsonl").write_bytes(b"".join(changed))
    again = board(tmp_path)
    expected = {"garbage": {"b1": {"signal": 3}}, "cut": {"b1": {"signal": 2}}}
    expected["other journal"] = {"b1": {"signal": 2}, "b2": {"signal": 0}}
    assert again.positions.told() == {"robot": expected[damage]}


def test_nothing_is_acknowledged_that_could_not_be_written(tmp_path, battery, monkeypatch):
    kept = board(tmp_path)
    kept.take([battery(1)])
    os_pwrite = os.pwrite
    disk = (tmp_path / "board.jsonl").stat().st_size + 10  # where it is full

    def full(file, text, offset):
        return os_pwrite(file, bytes(text)[: disk - offset], offset) if offset < disk else _no_space()

    monkeypatch.setattr(os, "pwrite", full)
    took = kept.take([battery(2)])
    assert (took.taken, took.written) == (0, False)
    assert "space" in kept.journal.trouble
    assert kept.positions.told() == {"robot": {"b1": {"signal": 1}}}
    monkeypatch.undo()
    assert kept.take([battery(2)]).written
    assert kept.journal.trouble == ""
    assert len(list(read_journal(tmp_path))) == 2


def test_without_room_for_a_checkpoint_the_journal_has_everything(tmp_path, battery, monkeypatch):
    kept = board(tmp_path)
    kept.take([battery(1)])
    monkeypatch.setattr(os, "replace", lambda *paths: _no_space())
    kept.checkpoint()
    monkeypatch.undo()
    assert not (tmp_path / "checkpoint.jsonl").exists()
    assert kept.journal.trouble == ""
    assert known(board(tmp_path)) == known(kept)


def _no_space():
    raise OSError(28, "No space left on device")


def test_late_ones_must_be_of_their_place(tmp_path, battery):
    kept = board(tmp_path)
    late = [Envelope(read_origin(battery(n).attachment), battery(n).payload) for n in (1, 2)]
    assert kept.take_late("k2a", "observations/feature", late).taken == 0
    assert kept.refusals.by_reason["place"] == 2
    assert kept.positions.told() == {}
    assert kept.take_late("other", "observations/signal", late).taken == 0
    assert kept.take_late("k2a", "observations/signal", [*late, late[0]._replace(payload=b"{}")]).taken == 2
    assert kept.positions.told() == {"robot": {"b1": {"signal": 2}}}


def test_who_sends_again_is_told_again(tmp_path, battery):
    kept = board(tmp_path)
    kept.take([battery(1)], now_s=10.0)
    assert kept.positions.told(since_s=10.0) == {"robot": {"b1": {"signal": 1}}}
    assert kept.positions.told(since_s=11.0) == {}
    kept.take([battery(1)], now_s=11.0)
    assert kept.positions.told(since_s=11.0) == {"robot": {"b1": {"signal": 1}}}
    again = board(tmp_path)
    assert again.positions.told(since_s=0.0) == {}
    again.positions.hear_newest(1, 0.0)
    assert again.positions.told(since_s=0.0) == {"robot": {"b1": {"signal": 1}}}


def test_what_was_missed_is_read_from_the_journal_and_commands_are_never_handed_on(tmp_path, battery):
    kept = board(tmp_path)
    sent = {n: battery(n) for n in (2, 1, 5, 4)}
    kept.take(sent.values())
    assert {e.origin.number: e.payload for e in kept.lost(lost(1, 2**53))} == {n: m.payload for n, m in sent.items()}
    assert numbers(kept.lost(lost(2, 4))) == [2, 4]
    assert kept.lost(lost(1, 5, lane="command")) == []
    assert kept.lost(lost(1, 5, lane="large")) == []
    kept.close()
    assert numbers(board(tmp_path).lost(lost(1, 9))) == [1, 2, 4, 5]


def test_answers_and_what_can_be_found_are_bounded(tmp_path, battery):
    kept = board(tmp_path, findable_envelopes=10, answer_bytes=1000)
    kept.take([battery(n) for n in range(1, 12)])
    size = len(battery(1).payload)
    assert numbers(kept.lost(lost(1, 11))) == list(range(7, 12))
    kept = board(tmp_path, answer_bytes=1000)
    assert len(kept.lost(lost(1, 11))) == 1000 // size


def test_one_keeper_for_one_folder(tmp_path):
    lock = FolderLock(tmp_path, "keeper", "--out")
    with pytest.raises(OutputError, match=f"another keeper .process {os.getpid()}. uses it"):
        FolderLock(tmp_path, "keeper", "--out")
    lock.release()
    FolderLock(tmp_path, "keeper", "--out").release()
