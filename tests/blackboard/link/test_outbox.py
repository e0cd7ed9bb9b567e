import pytest

from blackboard.errors import LinkError
from blackboard.link import outbox as module
from blackboard.link.envelope import Envelope, Origin
from blackboard.link.outbox import Outbox


def envelope(number, lane="knowledge", text=b'{"key":"ski/k2a/status/x"}'):
    return Envelope(Origin("mapper", "b1", lane, number), text)


def numbers(envelopes):
    return [e.origin.number for e in envelopes]


def test_what_is_acknowledged_goes(tmp_path):
    outbox = Outbox(tmp_path)
    for number in (1, 2, 3):
        outbox.add(envelope(number))
    outbox.acknowledge("knowledge", 2)
    assert numbers(outbox.waiting("knowledge")) == [3]
    assert len(outbox) == 1


def test_a_killed_process_leaves_what_was_not_acknowledged(tmp_path):
    killed = Outbox(tmp_path)
    for number in (1, 2):
        killed.add(envelope(number))
    after = Outbox(tmp_path)
    assert numbers(after.left) == [1, 2]
    after.acknowledge_left()
    assert Outbox(tmp_path).left == []


def test_a_line_that_was_cut_off_is_left_out(tmp_path):
    killed = Outbox(tmp_path)
    killed.add(envelope(1))
    (path,) = tmp_path.iterdir()
    path.write_bytes(path.read_bytes() + b'mapper b1 knowledge 2\t{"key')
    assert numbers(Outbox(tmp_path).left) == [1]


def test_segments_go_once_all_in_them_is_acknowledged(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "SEGMENT_BYTES", 100)
    outbox = Outbox(tmp_path)
    for number in range(1, 11):
        outbox.add(envelope(number, "knowledge" if number % 2 else "large"))
    before = len(list(tmp_path.iterdir()))
    outbox.acknowledge("knowledge", 9)
    assert len(list(tmp_path.iterdir())) == before  # the other lane still needs them
    outbox.acknowledge("large", 10)
    assert len(list(tmp_path.iterdir())) == 1


def test_an_orderly_end_leaves_no_file(tmp_path):
    outbox = Outbox(tmp_path)
    outbox.add(envelope(1))
    outbox.acknowledge("knowledge", 1)
    outbox.close()
    assert list(tmp_path.iterdir()) == []


def test_a_foreign_file_is_refused(tmp_path):
    (tmp_path / "00000001.outbox").write_bytes(b"hello\n")
    with pytest.raises(LinkError, match="not an outbox"):
        Outbox(tmp_path)


def test_a_full_disk_keeps_what_is_posted_in_memory_and_the_file_whole(tmp_path, monkeypatch):
    outbox = Outbox(tmp_path)
    outbox.add(envelope(1))
    write = module.os.write
    monkeypatch.setattr(module.os, "write", lambda file, line: write(file, line[:7]))  # as a disk that fills up does
    outbox.add(envelope(2))
    assert outbox.trouble == "no space left on device"
    monkeypatch.undo()
    outbox.add(envelope(3))
    assert outbox.trouble == ""
    assert numbers(outbox.waiting("knowledge")) == [1, 2, 3]
    assert numbers(Outbox(tmp_path).left) == [1, 3]


def test_where_memory_would_run_out_the_oldest_of_the_fullest_lane_goes(tmp_path):
    outbox = Outbox(limit_bytes=100)
    outbox.add(envelope(1, "command"))
    for number in range(1, 9):
        outbox.add(envelope(number, text=b"x" * 20))
    assert outbox.dropped == 5
    assert numbers(outbox.waiting("command")) == [1]
    assert numbers(outbox.waiting("knowledge")) == [6, 7, 8]
