"""zenoh's configuration of the keeper's router and of its clients, as plain tables for `zenoh.Config.from_json5`.

zenoh's defaults listen on every interface, look for others by multicast and let them connect to each other behind the router's
back. Here one router listens where it is told, everyone else is a client of it that does not listen.
"""

import datetime
from pathlib import Path
from typing import Any

from blackboard.errors import LinkError
from blackboard.keys.material import Material, keeper_material, member_material
from blackboard.keys.roles import READABLE
from blackboard.keys.rules import access_control
from blackboard.link.address import Address, parse_address
from blackboard.vocabulary import MAX_MESSAGE_BYTES

LEASE_MS = 2000  # so long after its last sign of life a process counts as gone (kill -9 shows at once)
KEEP_ALIVE = 4  # signs of life in a lease
RETRY_FIRST_MS = 100
RETRY_LONGEST_MS = 500
CONNECT_MS = 3000  # so long a client tries before it gives up at its start; once connected it tries for ever
WAIT_BEFORE_CLOSE_US = 200_000  # a reader that takes nothing for so long is cut off; others never wait for it
WAIT_BEFORE_DROP_US = 50_000  # a burst waits for its turn; what does not get it in time is dropped, and repaired later
MAX_PAYLOAD_BYTES = MAX_MESSAGE_BYTES
MAX_ANSWER_BYTES = 400_000_000  # what a client takes from the keeper: the whole board in one answer
BOARD_KEYS = (*READABLE, "ski/*/@late/**")


def client_configuration(address: str, keys: Path | None = None) -> dict[str, Any]:
    """Return the configuration of a process that speaks with the keeper at `address`, and with nobody else.

    `keys` is a member's folder. Raises LinkError where the address is malformed or takes keys, KeysError where they are no good.
    """
    parsed = parse_address(address)
    material = None if keys is None else member_material(keys, datetime.datetime.now(datetime.UTC))[0]
    endpoint = _endpoint(parsed, keys)
    transport = _transport(endpoint, MAX_ANSWER_BYTES)
    if material is not None:
        transport["link"]["tls"] = _tls(material, "connect")
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
        "transport": transport,
    }


def router_configuration(address: str, keys: Path | None = None) -> dict[str, Any]:
    """Return the configuration of the keeper's router, listening at `address`.

    `keys` is the folder that `ski keys init` made: with it, only its members get in, and each does what its roles allow.
    Raises LinkError where the address is malformed or takes keys, KeysError where they are no good.
    """
    parsed = parse_address(address)
    material, members = (None, []) if keys is None else keeper_material(keys, datetime.datetime.now(datetime.UTC))
    endpoint = _endpoint(parsed, keys)
    transport = _transport(endpoint, MAX_PAYLOAD_BYTES * 2)
    access: dict[str, Any] = {}
    if material is not None:
        transport["link"]["tls"] = _tls(material, "listen")
        access = {"access_control": access_control(members)}
    return {
        "mode": "router",
        "scouting": _no_scouting(),
        "connect": {"endpoints": []},
        "listen": {"endpoints": [endpoint], "exit_on_failure": True},
        "transport": transport,
        "low_pass_filter": [
            {
                "id": "oversized",
                "flows": ["ingress"],
                "messages": ["put", "delete", "query", "reply"],
                "key_exprs": list(BOARD_KEYS),
                "size_limit": MAX_PAYLOAD_BYTES,
            }
        ],
        **access,
    }


def listening_at(address: str, keys: Path | None = None) -> str:
    """Return an address as zenoh takes it; raise LinkError where it is malformed, or takes keys."""
    return _endpoint(parse_address(address), keys)


def _endpoint(address: Address, keys: Path | None) -> str:
    if keys is not None:
        return address.endpoint("tls")  # with keys nothing ever goes in the clear, whatever the address says
    if not address.loopback:
        raise LinkError(
            f"{address.endpoint('tcp')} can be reached from other machines, which takes keys: "
            "`ski keys init DIR --host NAME`, then --keys"
        )
    if address.protocol == "tls":
        raise LinkError(f"{address.endpoint('tls')} takes keys: `ski keys init DIR --host NAME`, then --keys")
    return address.endpoint("tcp")


def _tls(material: Material, side: str) -> dict[str, Any]:
    return {
        "root_ca_certificate": str(material.authority),
        f"{side}_certificate": str(material.certificate),
        f"{side}_private_key": str(material.key),
        "enable_mtls": True,
        "verify_name_on_connect": True,
        "close_link_on_expiration": True,
    }


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
