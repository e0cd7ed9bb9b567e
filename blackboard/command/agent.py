"""`ski agent`: the executor daemon of this machine: runs the parts of missions that a manager (`ski up`) orders."""

import argparse
import os
import socket
import sys
import threading
from importlib.metadata import version

from blackboard.command.connection import add_connection_options, link_params
from blackboard.command.ending import when_told_to_end
from blackboard.errors import LinkError, MissionError
from blackboard.key_expressions import is_chunk
from blackboard.processes.agent import Agent, AgentParams
from blackboard.processes.leash import LeashParams
from blackboard.processes.protocol import Order, decode, this_machine
from blackboard.processes.state_folder import StateFolder


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    add_connection_options(parser)
    parser.add_argument("--name", default=this_machine(), metavar="MACHINE", help="this machine (default: %(default)s)")
    parser.add_argument(
        "--lease",
        type=float,
        default=LeashParams().lease_s,
        metavar="S",
        help="seconds of a manager's silence after which everything is stopped (default: %(default)g)",
    )
    parser.add_argument(
        "--passing", action="store_true", help=argparse.SUPPRESS
    )  # `ski up` started it, and orders on stdin
    parser.add_argument("--nursery", type=int, help=argparse.SUPPRESS)  # an open socket that leads to one


def call(options: argparse.Namespace) -> int:
    """Run the verb until it is asked to end."""
    if not is_chunk(options.name):
        raise MissionError(f"--name {options.name}: letters, digits, '_', '-' and '.' only")
    link = link_params(options)
    params = AgentParams(
        machine=options.name,
        link=link,
        state=StateFolder(link.address),
        leash=LeashParams(lease_s=options.lease),
        passing=options.passing,
        nursery=socket.socket(fileno=options.nursery) if options.nursery is not None else None,
    )
    agent = Agent(params, version("sensory-knowledge-integrator"))
    if options.passing:
        threading.Thread(target=_read_orders, args=(agent,), name="orders", daemon=True).start()
    else:
        sys.stderr.write(f"ski: {options.name} waits for a manager at {link.address}; Ctrl-C ends it\n")
    with when_told_to_end(agent.end):
        agent.run()
    return 0


def _read_orders(agent: Agent) -> None:
    """Hand on the lines of standard input; read without Python's buffer, whose lock would keep this process from ending."""
    text = b""
    while come := os.read(0, 65_536):
        *lines, text = (text + come).split(b"\n")
        for line in lines:
            try:
                agent.order(decode(line, Order))
            except LinkError as error:
                sys.stderr.write(f"ski: {error}\n")
