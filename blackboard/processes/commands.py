"""The commands that executors run: `ski host` for a part of a mission, `ski board serve` for the keeper, and nothing else."""

import sys
from pathlib import Path

from blackboard.link.session import LinkParams
from blackboard.processes.executor import ProcessPlan
from blackboard.processes.protocol import KEEPER, HostOrder

SKI = (sys.executable, "-m", "blackboard.command.main")

KEEPER_HANGS_S = 20.0  # its heartbeats come 5 times a second; writing down a large board holds them up


def host_plan(order: HostOrder, link: LinkParams, machine: str, state: Path) -> ProcessPlan:
    """Return how the host of an order is run; `state` is the folder for what must outlive a kill of it."""
    command = [*SKI, "host", order.mission, "--name", order.name, *_link(link)]
    command += ["--seed", str(order.seed), "--pace", repr(order.pace), "--state", str(state)]
    command += ["--machine", machine]
    for setting in order.settings:
        command += ["--set", setting]
    return ProcessPlan(
        name=order.name,
        robot=order.robot,
        command=(*command, "--leashed"),
        restart=order.restart,
        restarts=order.restarts,
        within_s=order.within_s,
        hang_s=order.hang_s,
        stop_s=order.stop_s,
    )


def host_arguments(command: tuple[str, ...]) -> tuple[str, ...] | None:
    """Return the arguments of `ski` where a command is a host's; None for any other."""
    return command[len(SKI) :] if command[: len(SKI) + 1] == (*SKI, "host") else None


def agent_command(link: LinkParams, machine: str) -> tuple[str, ...]:
    """Return how an executor is run that takes its first orders on standard input and goes with its manager."""
    return (*SKI, "agent", "--name", machine, *_link(link), "--passing")


def keeper_plan(link: LinkParams, folder: Path, mission: str = "") -> ProcessPlan:
    """Return how the keeper is run: always there, since everything goes through it."""
    command = (*SKI, "board", "serve", *([mission] if mission else []), *_link(link), "--out", str(folder), "--leashed")
    return ProcessPlan(
        name=KEEPER, command=command, restart="always", restarts=100, hang_s=KEEPER_HANGS_S, stop_s=10.0, source=True
    )


def _link(link: LinkParams) -> list[str]:
    return ["--connect", link.address, *(["--keys", str(link.keys)] if link.keys is not None else [])]
