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
