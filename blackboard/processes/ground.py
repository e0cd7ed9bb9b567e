"""What `ski up` finds at an address: nothing, a keeper, or something else; and whether a keeper may be started there."""

import socket
import time
from collections.abc import Callable

import msgspec

from blackboard.errors import LinkError
from blackboard.keeper.status import KeeperStatus
from blackboard.link.address import parse_address
from blackboard.link.addresses import KEEPER_STATUS
from blackboard.link.session import Session
from blackboard.processes.protocol import AGENTS, AgentReport, decode

LOOK_S = 1.0
AGAIN_S = 0.02


def listening(address: str) -> bool:
    """Say whether anything listens at an address."""
    place = parse_address(address)
    try:
        with socket.create_connection((place.host, place.port), timeout=LOOK_S):
            return True
    except OSError:
        return False


def ours(address: str) -> bool:
    """Say whether an address is one of this machine, so that a keeper can listen there."""
    place = parse_address(address)
    if place.loopback:
        return True
    family = socket.AF_INET6 if ":" in place.host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as attempt:
        try:
            attempt.bind((place.host, 0))
        except OSError:
            return False
    return True


def wait_until_listening(address: str, timeout_s: float, tend: Callable[[], None], why_not: Callable[[], str]) -> None:
    """Wait for a keeper that is starting; raise LinkError with the reason where it does not come."""
    until_s = time.monotonic() + timeout_s
    while not listening(address):
        tend()
        if time.monotonic() >= until_s:
            raise LinkError(f"the keeper does not listen at {address}: {why_not() or 'it said nothing'}")
        time.sleep(AGAIN_S)


def keeper_status(session: Session, address: str) -> KeeperStatus:
    """Return how the keeper at an address is doing; raise LinkError where it is none of ours."""
    for answer in session.ask(KEEPER_STATUS, timeout_s=3.0):
        if not answer.error:
            try:
                return msgspec.json.decode(answer.payload, type=KeeperStatus)
            except msgspec.DecodeError:
                break
    raise LinkError(f"what listens at {address} is no board keeper of this version; choose another --connect")


def check_free(status: KeeperStatus, robot: str, address: str) -> None:
    """Raise LinkError where a keeper's board for a robot is in use, or is not empty."""
    for board in status.boards:
        if board.robot != robot:
            continue
        hosts = [host.host for host in board.hosts if host.state in ("alive", "hung")]
        if hosts:
            raise LinkError(
                f"'{robot}' is up already at {address} ({', '.join(hosts)}); end that with `ski down` first"
            )
        if board.standing:
            raise LinkError(
                f"the keeper at {address} still has the board of an earlier '{robot}'; start it with `ski board serve --fresh`, "
                "or take another --connect, where `ski up` starts a keeper of its own"
            )


def agents_at(session: Session, machine: str = "*", timeout_s: float = 2.0) -> list[AgentReport]:
    """Return how the executors that a keeper reaches fare."""
    reports = []
    for answer in session.ask(f"{AGENTS}/{machine}/state", timeout_s=timeout_s):
        if not answer.error:
            reports.append(decode(answer.payload, AgentReport))
    return sorted(reports, key=lambda report: report.machine)
