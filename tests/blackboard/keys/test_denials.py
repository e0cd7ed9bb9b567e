"""zenoh's log lines, as zenoh 1.10 writes them, become denials."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.keys.denials import CONNECTIONS, KINDS, MESSAGES, Denial, LogReader
from blackboard.keys.rejections import Rejection, spoken

ZID = "d81216dbae28fed6cda91a4c7a4a7c20"
STAMP = "2026-11-22T10:31:10.274604Z"
ACL = "zenoh::net::routing::interceptor::access_control"


def line(text: str, thread: str = "rx-0 ThreadId(09)", level: str = "TRACE") -> str:
    return f"\x1b[2m{STAMP}\x1b[0m \x1b[35m{level}\x1b[0m  {thread} {text}\n"


def judged(what: str, key: str, verdict: str = "unauthorized", name: str = "eve.1") -> str:
    subject = f"Interface(lo)+CertCommonName({name})+Transport(Tls)+{ZID}"
    return f"\x1b[2m{ACL}\x1b[0m\x1b[2m:\x1b[0m {ZID} on {subject} is {verdict} to {what} on {key}"


INTERCEPTED = "zenoh::net::routing::interceptor: Msg intercepted!"


def read(*lines: str) -> list[Denial]:
    return LogReader().feed("".join(lines).encode())


def test_a_post_that_was_thrown_away():
    key = "ski/k2a/motivations/motivation/x"
    assert read(line(judged("Put (ingress)", key)), line(INTERCEPTED)) == [Denial(STAMP, "post", "eve.1", key)]


def test_what_was_allowed_or_only_considered_is_no_denial():
    assert read(line(judged("Put (ingress)", "ski/a", "authorized"))) == []
    assert (
        read(line(judged("Put (ingress)", "ski/a"))) == []
    )  # permissions are worked out ahead, for a key that was declared
    assert read(line(judged("Put (egress)", "ski/a")), line(INTERCEPTED)) == []
    assert read(line(judged("Undeclare Liveliness Token (ingress)", "ski/a")), line(INTERCEPTED)) == []


def test_one_that_was_allowed_and_thrown_away_was_too_large():
    assert [d.kind for d in read(line(judged("Put (ingress)", "ski/a", "authorized")), line(INTERCEPTED))] == [
        "oversized payload"
    ]


@pytest.mark.parametrize(
    ("what", "kind"),
    [
        ("Delete", "delete"),
        ("Query", "question"),
        ("Reply", "answer"),
        ("Declare Queryable", "offer to answer"),
        ("Liveliness Token", "liveliness"),
        ("Declare Liveliness Subscriber", "reading"),
        ("Liveliness Query", "reading"),
        ("Declare Subscriber", "reading"),
        ("Something New", "other"),
    ],
)
def test_kinds_of_messages(what, kind):
    assert [d.kind for d in read(line(judged(f"{what} (ingress)", "ski/a")), line(INTERCEPTED))] == [kind]


@pytest.mark.parametrize(
    ("what", "later"),
    [
        ("Query (ingress)", STAMP),
        ("Put (egress)", STAMP),
        ("Put (ingress)", STAMP.replace("10.27", "10.57")),
        ("Put (ingress)", STAMP.replace("10:31", "10:30")),
        ("Put (ingress)", "2026-99-99T99:99:99.999999Z"),
    ],
)
def test_what_zenoh_throws_away_by_itself_is_nobodys_attempt(what, later):
    assert (
        read(line(judged(what, "ski/k2a/@keeper/clock", "authorized")), line(INTERCEPTED).replace(STAMP, later)) == []
    )
    assert read(line(INTERCEPTED)) == []


def test_lines_of_two_threads_are_kept_apart():
    other = "rx-1 ThreadId(10)"
    found = read(
        line(judged("Put (ingress)", "ski/a", name="a.1")),
        line(judged("Query (ingress)", "ski/b", name="b.1"), other),
        line(INTERCEPTED),
        line(INTERCEPTED, other),
    )
    assert [(d.kind, d.common_name, d.detail) for d in found] == [
        ("post", "a.1", "ski/a"),
        ("question", "b.1", "ski/b"),
    ]


def test_a_session_that_connected_is_known_later():
    connected = (
        "zenoh::net::routing::interceptor::low_pass: New low-pass filter transport unicast Transport Unicast "
        f'{{ zid: {ZID}, links: [Link {{ auth_identifier: Tls(Some("eve.1")) }}] }}'
    )
    cached = f"{ACL}: Using cached result: {ZID} is unauthorized to Put (ingress) on ski/a"
    found = read(line(connected, level="DEBUG"), line(cached), line(INTERCEPTED))
    assert [(d.kind, d.common_name) for d in found] == [("post", "eve.1")]
    assert [d.common_name for d in read(line(cached), line(INTERCEPTED))] == [""]


@pytest.mark.parametrize(
    ("why", "kind"),
    [
        ("peer sent no certificates", "no certificate"),
        ("invalid peer certificate: BadSignature", "foreign authority"),
        ("invalid peer certificate: UnknownIssuer", "foreign authority"),
        ("invalid peer certificate: certificate expired: verification time 2", "expired certificate"),
        ("received corrupt message of type InvalidContentType", "plain connection"),
        ("something else", "other"),
    ],
)
def test_kinds_of_connections(why, kind):
    text = f"zenoh_link_tls::unicast: {why}. Hint: increase the system open file limit."
    assert read(line(text, "acc-0 ThreadId(06)", "WARN")) == [Denial(STAMP, kind, "", f"{why}.")]
    assert read(line(text, "acc-0 ThreadId(06)", "DEBUG")) == []
    assert read(line("zenoh_link_tls::unicast: tls handshake eof.", "acc-0 ThreadId(06)", "WARN")) == []


def test_what_a_key_says_cannot_disturb_a_terminal():
    found = read(line(judged("Put (ingress)", "ski/\x1b[31mred\x07")), line(INTERCEPTED))
    assert [d.detail.isprintable() for d in found] == [True]


@given(st.lists(st.integers(0, 1200), max_size=6))
def test_it_does_not_matter_how_the_log_is_cut(cuts):
    log = (line(judged("Put (ingress)", "ski/a")) + line(INTERCEPTED) * 2 + line("zenoh: other")).encode()
    reader, found, before = LogReader(), [], 0
    for cut in [*sorted(cuts), len(log)]:
        found += reader.feed(log[before:cut])
        before = max(before, cut)
    assert found == LogReader().feed(log)


@given(st.lists(st.one_of(st.binary(max_size=80), st.sampled_from([line(INTERCEPTED).encode(), b"auth_identifier\n"]))))
def test_whatever_the_log_holds_is_read(pieces):
    reader = LogReader()
    for piece in pieces:
        assert all(denial.kind in KINDS for denial in reader.feed(piece))


def test_all_kinds_are_told_apart():
    assert len(KINDS) == len(set(MESSAGES.values()) | set(CONNECTIONS.values())) + 2


def test_the_first_and_every_tenfold_are_spoken_of():
    rejection = Rejection(STAMP, "post", "eve", "ski/a")
    said = [often for often in range(1, 2000) if spoken(rejection, often) is not None]
    assert said == [1, 10, 100, 1000]
    assert spoken(rejection, 1) == "rejected: post by eve, ski/a"
    assert (
        spoken(Rejection(STAMP, "no certificate", "", "why"), 10) == "rejected: no certificate, why (10 times by now)"
    )
