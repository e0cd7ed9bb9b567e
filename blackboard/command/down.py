"""`ski down`: end what `ski up` or `ski agent` started on this machine, whoever of them still lives; nothing of it is left."""

import argparse
import signal
import sys

from blackboard.command.connection import add_connection_options, link_params
from blackboard.errors import LinkError
from blackboard.processes.identity import end_all, gone_within, is_alive, send
from blackboard.processes.protocol import KEEPER
from blackboard.processes.state_folder import AGENT, MANAGER, StateFolder, addresses_in_use, folder_name, state_root

ORDERLY_S = 90.0  # for a manager to stop everything and write its results
AGENT_S = 30.0  # for an executor to stop what it runs
GRACE_S = 5.0  # for what nobody holds any more


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    add_connection_options(parser)


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    address = link_params(options).address
    state = StateFolder(address)
    records = {record.name: record for record in state.records()}
    if not records:
        others = [name for name in addresses_in_use(state_root()) if name != folder_name(address)]
        state.clear()
        where = f"; there is something at {', '.join(others)}: name it with --connect" if others else ""
        sys.stderr.write(f"ski: nothing is up at {address} on this machine{where}\n")
        return 0
    ended = len(records)
    for name, patience_s in ((MANAGER, ORDERLY_S), (AGENT, AGENT_S)):
        record = records.get(name)
        if record is not None and send(record.who, signal.SIGTERM) and send(record.who, signal.SIGCONT):
            gone_within(record.who, patience_s)
    left = [record for record in records.values() if record.name != KEEPER] + list(state.records())
    end_all([record.who for record in left if record.name != KEEPER], GRACE_S)
    end_all(
        [record.who for record in [*records.values(), *state.records()]], GRACE_S
    )  # the keeper last: it hears their last words
    stubborn = [record for record in records.values() if is_alive(record.who)]
    if stubborn:
        names = ", ".join(f"{record.name} ({record.who.pid})" for record in stubborn)
        raise LinkError(f"the system does not end {names}; they may wait for a device, try again")
    state.clear()
    sys.stderr.write(f"ski: {ended} process{'es' if ended != 1 else ''} at {address} ended\n")
    return 0
