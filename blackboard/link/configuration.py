"""zenoh's configuration of the keeper's router and of its clients, as plain tables for `zenoh.Config.from_json5`.

zenoh's defaults listen on every interface, look for others by multicast and let them connect to each other behind the router's
back. Here one router listens where it is told, everyone else is a client of it that does not listen.
"""

from pathlib import Path
from typing import Any

from blackboard.errors import LinkError
from blackboard.link.address import parse_address

LEASE_MS = (
    2000  # so long after its last sign of life a process counts as gone (kill -9 shows at once, a cut cable does not)
)
KEEP_ALIVE = 4  # signs of life in a lease
RETRY_FIRST_MS = 100
RETRY_LONGEST_MS = 500
CONNECT_MS = 3000  # so long a client tries before it gives up at its start; once connected it tries for ever
WAIT_BEFORE_CLOSE_US = (
    200_000  # a reader that takes nothing for so long is cut off: it may come back, others never wait for it
)
WAIT_BEFORE_DROP_US = 50_000  # a burst waits for its turn; what does not get it in time is dropped, and repaired later
MAX_PAYLOAD_BYTES = 40_000_000  # an entry of MAX_MESSAGE_BYTES with its supports and endorsements
MAX_ANSWER_BYTES = 400_000_000  # what a client takes: the whole board in one answer
BOARD_KEYS = (
    "ski/**",
    *(f"ski/*/@{name}/**" for name in ("keeper", "late", "hosts")),
    "ski/@agents/**",
    "ski/@manager/**",
)


def client_configuration(address: str, keys: Path | None = None) -> dict[str, Any]:
    """Return the configuration of a process that speaks with the keeper at `address`, and with nobody else.

    Raises LinkError where the address is malformed, or lies on another machine and there are no keys.
    """
    endpoint = _endpoint(address, keys)
    return {
        "mode": "client",
        "scouting": _no_scouting(),
        "connect": {
            "endpoints": [endpoint],
            "timeout_ms": CONNECT_MS,
            "exit_on_failure": True,
            "retry": {
                "period_init_ms": RETRY_FIRST_MS,
                "period_max_ms": RETRY_LONGEST_MS,
                "period_increase_factor": 1.5,
            },
        },
        "listen": {"endpoints": []},
        "transport": _transport(endpoint, MAX_ANSWER_BYTES),
    }


def router_configuration(address: str, keys: Path | None = None) -> dict[str, Any]:
    """Return the configuration of the keeper's router, listening at `address`.

    Raises LinkError where the address is malformed, or can be reached from other machines and there are no keys.
    """
    endpoint = _endpoint(address, keys)
    return {
        "mode": "router",
        "scouting": _no_scouting(),
        "connect": {"endpoints": []},
        "listen": {"endpoints": [endpoint], "exit_on_failure": True},
        "transport": _transport(endpoint, MAX_PAYLOAD_BYTES * 2),
        "low_pass_filter": [
            {
                "id": "oversized",
                "flows": ["ingress"],
                "messages": ["put", "delete", "query", "reply"],
                "key_exprs": list(BOARD_KEYS),
                "size_limit": MAX_PAYLOAD_BYTES,
            }
        ],
    }


def _endpoint(address: str, keys: Path | None) -> str:
    parsed = parse_address(address)
    if keys is not None:
        raise LinkError("keys cannot be used yet; leave them out and stay on 127.0.0.1")
    if not parsed.loopback:
        raise LinkError(
            f"address '{address}' can be reached from other machines, which takes keys: `ski keys init DIR --host NAME`"
        )
    if parsed.protocol == "tls":
        raise LinkError(f"address '{address}' takes keys: `ski keys init DIR --host NAME`")
    return parsed.endpoint("tcp")


def _no_scouting() -> dict[str, Any]:
    return {"delay": 0, "multicast": {"enabled": False}, "gossip": {"enabled": False}}


def _transport(endpoint: str, max_message_bytes: int) -> dict[str, Any]:
    return {
        "shared_memory": {"enabled": False},  # it can lose large payloads without a word
        "link": {
            "protocols": [endpoint.split("/", 1)[0]],
            "tx": {
                "lease": LEASE_MS,
                "keep_alive": KEEP_ALIVE,
                "queue": {
                    "congestion_control": {
                        "drop": {"wait_before_drop": WAIT_BEFORE_DROP_US},
                        "block": {"wait_before_close": WAIT_BEFORE_CLOSE_US},
                    }
                },
            },
            "rx": {"max_message_size": max_message_bytes},
        },
    }
