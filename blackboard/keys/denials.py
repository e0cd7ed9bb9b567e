"""What zenoh's log says of rejected messages and connections: a reader of its lines, for zenoh 1.10.

zenoh tells nobody whom it rejects but its own log. At level trace its access control writes a line for every message that it looks
at ("... is unauthorized to Put (ingress) on KEY") and then, on the same thread, "Msg intercepted!" where the message was thrown
away. One that was authorized and is intercepted all the same, at once, was too large. Connections that fail are warnings of TLS.
A key may hold a line's end, so a member can write lines of its own into that log: what it says is evidence, not proof.
It also intercepts, without a word before, some ends of declarations that it would have passed on: those are nobody's attempts.
"""

import datetime
import re
from collections import deque
from dataclasses import dataclass

DIRECTIVES = "warn,zenoh::net::routing::interceptor=trace"  # what zenoh must log for this
CONNECTIONS = {  # why zenoh says that a connection failed, and what we call it
    b"peer sent no certificates": "no certificate",
    b"BadSignature": "foreign authority",
    b"UnknownIssuer": "foreign authority",
    b"certificate expired": "expired certificate",
    b"key usage": "wrong certificate",
    b"InvalidContentType": "plain connection",
}
MESSAGES = {  # what zenoh calls a message (the first of these words that it holds), and what we call it
    b"Token": "liveliness",
    b"Liveliness": "reading",
    b"Subscriber": "reading",
    b"Queryable": "offer to answer",
    b"Query": "question",
    b"Reply": "answer",
    b"Put": "post",
    b"Delete": "delete",
}
OVERSIZED = "oversized payload"
OTHER = "other"
KINDS = tuple(dict.fromkeys([*MESSAGES.values(), OVERSIZED, *CONNECTIONS.values(), OTHER]))
MAX_LINE_BYTES = 1_000_000
AT_ONCE_S = 0.2  # a busy machine may stop the thread between the two
LOOK_BACK = 64  # so many lines of other threads may stand between the two lines of one message

_COLOUR = re.compile(rb"\x1b\[[0-9;]*m")
_START = re.compile(rb"(?P<stamp>[0-9TZ:.-]{20,40}) +(?P<level>[A-Z]+) +(?P<thread>[^{]{0,60}?ThreadId\([0-9]+\)) ")
_JUDGED = re.compile(
    rb"zenoh::net::routing::interceptor::access_control: (?:Using cached result: )?(?P<zid>[0-9a-f]+)(?: on (?P<subject>\S+))?"
    rb" is (?P<un>un)?authorized to (?P<what>[A-Za-z ]+) \((?P<flow>ingress|egress)\) on (?P<key>.*)"
)
_KNOCK = b"tls handshake eof"  # somebody saw that there is something, and went: `ski doctor`, for one
_INTERCEPTED = b"zenoh::net::routing::interceptor: Msg intercepted!"
_REFUSED = re.compile(rb"zenoh_link_tls::\w+: (?P<why>.*)")
_CONNECTED = re.compile(rb'zid: (?P<zid>[0-9a-f]+),.*auth_identifier: \w+\(Some\("(?P<name>[^"]*)"\)\)')
_COMMON_NAME = re.compile(rb"CertCommonName\(([^)]*)\)")


@dataclass(frozen=True, slots=True)
class Denial:
    """Something that was rejected: when, what kind of attempt, whose (a certificate's common name), under which key or why."""

    stamp: str
    kind: str
    common_name: str
    detail: str


class LogReader:
    """Turns zenoh's log, as it comes, into denials."""

    def __init__(self) -> None:
        self._rest = b""
        self._before: deque[bytes] = deque(maxlen=LOOK_BACK)
        self._names: dict[bytes, str] = {}  # the common name of each session, by zenoh's identifier

    def feed(self, log: bytes) -> list[Denial]:
        """Take the next stretch of the log, whatever it holds; return what was denied in it."""
        lines = (self._rest + log).split(b"\n")
        self._rest = lines.pop()[-MAX_LINE_BYTES:]
        found = []
        for line in lines:
            if _INTERCEPTED in line or b"intercepted!" in line:
                denial = self._intercepted(_COLOUR.sub(b"", line))
            elif b"zenoh_link_tls" in line:
                denial = _refused(_COLOUR.sub(b"", line))
            else:
                denial = None
                if b"auth_identifier" in line:
                    self._connected(line)
            self._before.append(line)
            if denial is not None:
                found.append(denial)
        return found

    def _connected(self, line: bytes) -> None:
        match = _CONNECTED.search(_COLOUR.sub(b"", line))
        if match is not None:
            if len(self._names) > 10_000:  # sessions that come and go
                self._names.clear()
            self._names[match["zid"]] = _text(match["name"])

    def _intercepted(self, line: bytes) -> Denial | None:
        start = _START.match(line)
        if start is None or _INTERCEPTED not in line:
            return None
        for earlier in reversed(self._before):
            before = _COLOUR.sub(b"", earlier)
            other = _START.match(before)
            if other is None or other["thread"] != start["thread"]:
                continue
            judged = _JUDGED.search(before)
            if judged is None or not (judged["un"] or _too_large(judged, _text(other["stamp"]), _text(start["stamp"]))):
                return None
            return self._judged(_text(start["stamp"]), judged)
        return None

    def _judged(self, stamp: str, judged: "re.Match[bytes]") -> Denial | None:
        if judged["flow"] == b"egress" or judged["what"].startswith(b"Undeclare"):
            return None  # no attempt: something that a member is not told, or the end of what was rejected
        name = _COMMON_NAME.search(judged["subject"] or b"")
        common_name = self._names.get(judged["zid"], "") if name is None else _text(name[1])
        kind = next((kind for word, kind in MESSAGES.items() if word in judged["what"]), OTHER)
        if not judged["un"]:
            kind = OVERSIZED
        return Denial(stamp, kind, common_name, _text(judged["key"]))


def _too_large(judged: "re.Match[bytes]", judged_at: str, intercepted_at: str) -> bool:
    try:
        at, then = (datetime.datetime.fromisoformat(stamp) for stamp in (judged_at, intercepted_at))
        at_once = 0.0 <= (then - at).total_seconds() < AT_ONCE_S
    except (ValueError, TypeError):
        return False
    return at_once and (judged["what"] == b"Put" or (judged["what"] == b"Query" and b"/@late/" in judged["key"]))


def _refused(line: bytes) -> Denial | None:
    start = _START.match(line)
    match = _REFUSED.search(line)
    if start is None or match is None or start["level"] != b"WARN" or _KNOCK in line:
        return None
    kind = next((kind for words, kind in CONNECTIONS.items() if words in match["why"]), OTHER)
    return Denial(_text(start["stamp"]), kind, "", _text(match["why"].partition(b" Hint:")[0]))


def _text(raw: bytes) -> str:
    text = raw[:400].decode("utf-8", "replace")
    return "".join(letter if letter.isprintable() else "?" for letter in text)
