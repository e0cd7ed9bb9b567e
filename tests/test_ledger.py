"""The ledger of the trials finds what is missing: a proof that nothing was lost must be able to fail."""

import msgspec
import pytest
from ledger import Ledger

from blackboard.keeper.journal_file import journalled
from blackboard.link.envelope import Origin, attachment_of
from blackboard.messages.hosts import HostBeat

PAYLOAD = b'{"key":"ski/k2a/status/mission","value":{}}'
STREAM = ("rules", "b1", "knowledge")


def origin(number):
    return Origin("rules", "b1", "knowledge", number)


@pytest.fixture
def journal(tmp_path):
    """Write a journal with these numbers of one lane."""

    def write(*numbers):
        path = tmp_path / "board.jsonl"
        path.write_bytes(b"".join(journalled(origin(n), PAYLOAD) for n in numbers))
        return path

    return write


def beat(lanes, missed=0):
    said = HostBeat(boot="b1", pid=1, machine="here", version="1", components=(), lanes=lanes, missed=missed)
    return "ski/k2a/@hosts/rules/beat", msgspec.json.encode(said)


def test_all_that_was_posted_is_there(journal):
    ledger = Ledger()
    ledger.note_beat(*beat({"knowledge": 3}))
    account = ledger.account(journal(1, 3, 2))
    assert (account.posted, account.written, account.lost, account.twice) == (3, 3, 0, 0)


def test_a_gap_is_found(journal):
    account = Ledger().account(journal(1, 2, 5))
    assert account.missing == {STREAM: [3, 4]}
    assert account.lost == 2


def test_what_a_beat_told_and_nobody_wrote_down_is_missing(journal):
    ledger = Ledger()
    ledger.note_beat(*beat({"knowledge": 4, "control": 1}, missed=2))
    account = ledger.account(journal(1, 2))
    assert account.missing == {("rules", "b1", "control"): [1], STREAM: [3, 4]}
    assert account.missed == 2


def test_what_stood_in_an_outbox_when_its_host_was_killed_is_missing(journal, tmp_path):
    outbox = tmp_path / "outbox"
    outbox.mkdir()
    whole = b"".join(b"%s\t%s\n" % (attachment_of(origin(n)), PAYLOAD) for n in (6, 7))
    (outbox / "00000001.outbox").write_bytes(whole + attachment_of(origin(8)))  # cut off: it was not posted
    ledger = Ledger()
    assert ledger.note_outbox(outbox) == 2
    account = ledger.account(journal(1, 2, 3, 4, 5, 6), [outbox])
    assert account.missing == {STREAM: [7]}
    assert account.in_outboxes == 2


def test_what_was_refused_has_come_and_what_stands_twice_is_told(journal):
    path = journal(1, 2, 2, 4)
    path.with_name("refused.jsonl").write_bytes(
        b'{"origin":["rules","b1","knowledge",3],"reason":"kind","text":"\\"origin\\":[\\"x\\"]"}\n'
    )
    account = Ledger().account(path)
    assert (account.lost, account.refused, account.twice) == (0, 1, 1)


def test_a_line_that_does_not_say_where_it_came_from_is_no_proof(tmp_path):
    path = tmp_path / "board.jsonl"
    path.write_bytes(PAYLOAD + b"\n")
    with pytest.raises(ValueError, match="without an origin"):
        Ledger().account(path)
