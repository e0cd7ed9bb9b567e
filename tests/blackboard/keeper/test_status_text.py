from msgspec.structs import replace

from blackboard.keeper.status import BoardStatus, HostLine, KeeperStatus, LaneStatus, told

BOARD = BoardStatus(
    robot="k2a",
    now_s=12.34,
    standing=3,
    taken=70,
    duplicates=1,
    refused={"kind": 2},
    refusals={"kind": "no kind has the path 'x'"},
    strange_lines=0,
    journal="boards/k2a/board.jsonl",
    journal_bytes=1_250_000,
    trouble="",
    lanes=[
        LaneStatus(host="knowledge_sources", boot="b1", lane="signal", posted=7, held=7, missing=0),
        LaneStatus(host="robot", boot="b22", lane="control", posted=1234, held=1200, missing=30),
    ],
    hosts=[HostLine(host="robot", state="hung", boot="b22", offset_s=1.5, detail="its clock is off")],
)
STATUS = KeeperStatus(
    boot="k1",
    version="0.1.0",
    pid=7,
    machine="barn",
    address="tcp/127.0.0.1:7447",
    folder="boards",
    uptime_s=3700.0,
    clients=2,
    overflowed=0,
    refused={},
    rejected={"put": 4},
    boards=[BOARD],
)


def test_a_status_in_words():
    assert list(told(STATUS)) == [
        "keeper k1 (process 7 on barn, ski 0.1.0) at tcp/127.0.0.1:7447, up 1 h 1 min, 2 hosts linked",
        "journals in boards",
        "rejected by access control: 4 (put)",
        "",
        "board of k2a: 3 entries stand, 70 taken, clock 12.3 s",
        "  journal boards/k2a/board.jsonl (1.2 MB)",
        "  refused: 2 (kind, such as no kind has the path 'x')",
        "  host robot hung (boot b22, clock +1.500 s): its clock is off",
        "  host               boot  lane     posted  held  missing",
        "  knowledge_sources  b1    signal        7     7        0",
        "  robot              b22   control    1234  1200       30",
        "",
        "30 envelopes are MISSING",
    ]
    assert STATUS.missing == 30


def test_a_journal_that_cannot_be_written_is_told():
    board = replace(
        BOARD, trouble="No space left on device", lanes=[], hosts=[], refused={}, now_s=None, strange_lines=2
    )
    status = replace(STATUS, boards=[board], rejected={}, overflowed=9, uptime_s=59.0)
    assert status.troubled == ["k2a"]
    assert list(told(status)) == [
        "keeper k1 (process 7 on barn, ski 0.1.0) at tcp/127.0.0.1:7447, up 59 s, 2 hosts linked",
        "journals in boards",
        "9 envelopes came faster than they could be taken; their posters hand them in again",
        "",
        "board of k2a: 3 entries stand, 70 taken, clock not begun",
        "  journal boards/k2a/board.jsonl (1.2 MB)",
        "  NOT WRITTEN: No space left on device; nothing is acknowledged until the journal can be written again",
        "  2 lines of the journal could not be brought back (another mission's kinds?)",
        "",
        "what comes now cannot be written down: k2a",
        "nothing is missing",
    ]
