"""What `ski up` finds at an address: nothing, a keeper, or something else; and whether a keeper may be started there."""

import socket
import time
from collections.abc import Callable
from contextlib import suppress
from queue import Empty, SimpleQueue

import msgspec

from blackboard.errors import LinkError
from blackboard.keeper.status import KeeperStatus
from blackboard.link.address import parse_address
from blackboard.link.addresses import KEEPER_STATUS
from blackboard.link.session import LinkParams, Session
from blackboard.processes.protocol import AGENTS, AgentReport, decode

LOOK_S = 1.0
AGAIN_S = 0.02
FIRST_S, NEXT_S = 1.0, 0.2  # for the tokens of executors: all that there are come at once
ANSWER_S = 3.0


def keeper_may_be(link: LinkParams) -> bool:
    """Say whether a keeper may be found: with keys it is for the link to find out, since a mere knock counts as rejected there."""
    return link.keys is not None or listening(link.address)


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


def agents_at(session: Session) -> list[AgentReport]:
    """Return how the executors that a keeper reaches fare; each is asked by its own name, the only one that it may answer to."""
    shown: SimpleQueue[str] = SimpleQueue()
    session.watch(f"{AGENTS}/*/alive/*", lambda key, alive: shown.put(key) if alive else None)
    machines: set[str] = set()
    with suppress(Empty):
        while True:
            machines.add(shown.get(timeout=NEXT_S if machines else FIRST_S).split("/")[2])
    return [report for machine in sorted(machines) for report in agent_at(session, machine)]


def agent_at(session: Session, machine: str) -> list[AgentReport]:
    """Return how the executor of a machine fares; nothing where none answers."""
    answers = session.ask(f"{AGENTS}/{machine}/state", timeout_s=ANSWER_S)
    return [decode(answer.payload, AgentReport) for answer in answers if not answer.error]
