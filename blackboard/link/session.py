"""The only module that touches zenoh: putting, subscribing, asking, answering, liveliness.

Sinks are called on zenoh's own threads and must only take note (put on a queue): no call of this module inside a sink, but for
`Question.reply`, `fail` and `finish`.
"""

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from blackboard.errors import LinkError
from blackboard.link.configuration import client_configuration, router_configuration
from blackboard.link.lanes import LANES, QUALITY, Lane

if TYPE_CHECKING:
    import zenoh

DEFAULT_ADDRESS = "tcp/127.0.0.1:7447"


@dataclass(frozen=True, kw_only=True)
class LinkParams:
    """Where the keeper is, and the folder with this member's certificates (None: none, loopback only)."""

    address: str = DEFAULT_ADDRESS
    keys: Path | None = None


@dataclass(frozen=True, slots=True)
class Arrived:
    """A message as it came."""

    key: str
    payload: bytes
    attachment: bytes


@dataclass(frozen=True, slots=True)
class Answer:
    """One reply to a question; `error` says why there is none."""

    key: str
    payload: bytes
    attachment: bytes = b""
    error: str = ""


class Question:
    """A question that somebody asked. Reply any number of times, then `finish`, on whatever thread."""

    def __init__(self, query: "zenoh.Query") -> None:
        self._query = query
        self.key = str(query.key_expr)
        self.payload = query.payload.to_bytes() if query.payload is not None else b""

    def reply(self, key: str, payload: bytes, attachment: bytes = b"") -> None:
        """Send an answer, under a key that the question's expression matches."""
        import zenoh

        try:
            self._query.reply(
                key, payload, attachment=attachment or None, encoding=zenoh.Encoding.APPLICATION_JSON, express=True
            )
        except zenoh.ZError as error:
            raise LinkError(f"{key}: the answer could not be sent ({error})") from None

    def fail(self, text: str) -> None:
        """Say why there is no answer."""
        import zenoh

        try:
            self._query.reply_err(text.encode())
        except zenoh.ZError as error:
            raise LinkError(f"{self.key}: the answer could not be sent ({error})") from None

    def finish(self) -> None:
        """Let the asker know that this was all."""
        self._query.drop()  # type: ignore[no-untyped-call]


class Session:
    """An open link; close it (or use it in `with`), or the interpreter would hang at its end."""

    def __init__(self, session: "zenoh.Session") -> None:
        import zenoh

        self._zenoh = zenoh
        self._session = session
        self._declared: list[Any] = []
        self._quality = {
            lane: (getattr(zenoh.Priority, QUALITY[lane].priority), QUALITY[lane].express) for lane in LANES
        }

    def put(self, key: str, payload: bytes, attachment: bytes = b"", lane: Lane = "knowledge") -> None:
        """Send; what cannot be sent just now is dropped without a word."""
        priority, express = self._quality[lane]
        self._session.put(
            key,
            payload,
            attachment=attachment,
            priority=priority,
            express=express,
            encoding=self._zenoh.Encoding.APPLICATION_JSON,
            congestion_control=self._zenoh.CongestionControl.DROP,
            allowed_destination=self._zenoh.Locality.REMOTE,
        )

    def subscribe(self, expression: str, sink: Callable[[Arrived], None]) -> None:
        """Call `sink` with what comes under the expression; deletions are no messages of ours and are passed over."""
        put = self._zenoh.SampleKind.PUT

        def take(sample: "zenoh.Sample") -> None:
            if sample.kind == put:
                attachment = sample.attachment
                sink(
                    Arrived(
                        str(sample.key_expr),
                        sample.payload.to_bytes(),
                        attachment.to_bytes() if attachment is not None else b"",
                    )
                )

        self._declared.append(self._session.declare_subscriber(expression, take))

    def ask(self, expression: str, payload: bytes = b"", timeout_s: float = 5.0) -> list[Answer]:
        """Return all answers to a question, none where nobody answers in time. Not for loops that must not wait."""
        replies = self._session.get(expression, **self._asking(payload, timeout_s))
        return [_answer(reply) for reply in replies]

    def must_answer(self, key: str, payload: bytes, end_s: float) -> bytes:
        """Ask again and again until somebody answers; raise LinkError where nobody has by `end_s` (monotonic), or was refused."""
        while True:
            for answer in self.ask(key, payload, timeout_s=max(0.1, min(2.0, end_s - time.monotonic()))):
                if not answer.error:
                    return answer.payload
                raise LinkError(f"the keeper refused {key}: {answer.error}")
            if time.monotonic() >= end_s:
                robot = key.split("/")[1]
                raise LinkError(f"no keeper answers for the board of '{robot}'; start one with `ski board serve`")

    def ask_later(
        self, expression: str, payload: bytes, sink: Callable[[Sequence[Answer]], None], timeout_s: float = 5.0
    ) -> None:
        """Ask, and call `sink` once with all answers when the last one has come, or with those that came in time."""
        answers: list[Answer] = []
        handler: Any = self._zenoh.handlers.Callback(
            lambda reply: answers.append(_answer(reply)), lambda: sink(answers)
        )
        self._session.get(expression, handler, **self._asking(payload, timeout_s))

    def serve(self, expression: str, sink: Callable[[Question], None]) -> None:
        """Call `sink` with the questions that are asked under the expression."""
        self._declared.append(
            self._session.declare_queryable(expression, lambda query: sink(Question(query)), complete=True)
        )

    def announce(self, key: str) -> None:
        """Show under `key` that this process lives, until the session closes."""
        self._declared.append(self._session.liveliness().declare_token(key))

    def watch(self, expression: str, sink: Callable[[str, bool], None]) -> None:
        """Call `sink` with each announced key and whether it lives: those there are, then every change."""
        put = self._zenoh.SampleKind.PUT
        self._declared.append(
            self._session.liveliness().declare_subscriber(
                expression, lambda sample: sink(str(sample.key_expr), sample.kind == put), history=True
            )
        )

    @property
    def connected(self) -> bool:
        """Say whether the keeper's router is reached at this moment (of a router: always)."""
        return any(True for _ in self._session.info.routers_zid())

    def close(self) -> None:
        """End what was declared and close the link."""
        for declared in reversed(self._declared):
            declared.undeclare()
        self._declared.clear()
        self._session.close()  # type: ignore[no-untyped-call]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _asking(self, payload: bytes, timeout_s: float) -> dict[str, Any]:
        return {
            "payload": payload,
            "timeout": timeout_s,
            "target": self._zenoh.QueryTarget.ALL,
            "consolidation": self._zenoh.ConsolidationMode.NONE,
            "congestion_control": self._zenoh.CongestionControl.BLOCK,
        }


def open_session(params: LinkParams) -> Session:
    """Open a client's link to the keeper; raise LinkError where it cannot be reached."""
    return _open(client_configuration(params.address, params.keys), params.address)


def open_router(params: LinkParams) -> Session:
    """Open the keeper's own session, which is the router; raise LinkError where the address cannot be listened on."""
    return _open(router_configuration(params.address, params.keys), params.address)


def start_log(directives: str) -> None:
    """Have zenoh log to standard output's descriptor, once in a process's life; RUST_LOG goes before `directives`."""
    import zenoh

    zenoh.init_log_from_env_or(directives)


def _open(configuration: dict[str, Any], address: str) -> Session:
    import zenoh

    try:
        return Session(zenoh.open(zenoh.Config.from_json5(json.dumps(configuration))))
    except zenoh.ZError as error:
        if configuration["mode"] == "router":
            raise LinkError(f"{address}: cannot be listened on ({error}); is a keeper running there already?") from None
        endpoint = configuration["connect"]["endpoints"][0]
        if endpoint.startswith("tls/"):
            raise LinkError(
                f"no keeper answers at {endpoint} and takes these keys; `ski doctor` with the same --keys finds out which"
            ) from None
        raise LinkError(
            f"no keeper answers at {address}; start one with `ski board serve` or name another --connect"
        ) from None


def _answer(reply: "zenoh.Reply") -> Answer:
    sample = reply.ok
    if sample is None:
        error = reply.err
        return Answer("", b"", error=error.payload.to_string() if error is not None else "no answer")
    attachment = sample.attachment
    return Answer(
        str(sample.key_expr), sample.payload.to_bytes(), attachment.to_bytes() if attachment is not None else b""
    )
