"""Two machines in one: network namespaces with a cable between them that can be pulled. As root, with iproute2."""

import os
import shutil
import subprocess
from types import TracebackType
from typing import Self

NEAR_ADDRESS, FAR_ADDRESS = "10.77.85.1", "10.77.85.2"


def why_not() -> str:
    """Return why namespaces cannot be had here; empty where they can."""
    if os.geteuid() != 0:
        return "network namespaces take root"
    if shutil.which("ip") is None:
        return "network namespaces take iproute2, which is not installed"
    name = f"ski-try-{os.getpid()}"
    tried = _ip("netns", "add", name)
    if tried.returncode == 0:
        pair = _ip("-n", name, "link", "add", "name", "near", "type", "veth", "peer", "name", "far")
        _ip("netns", "delete", name)
        return f"no pair of network devices can be made: {pair.stderr.strip()}" if pair.returncode else ""
    return f"no network namespace can be made: {tried.stderr.strip()}"


class Cable:
    """The namespaces `near` and `far`, with a cable between them. Use it in `with`: both are taken away after it."""

    def __init__(self) -> None:
        self.near, self.far = f"ski-near-{os.getpid()}", f"ski-far-{os.getpid()}"

    def __enter__(self) -> Self:
        for name in (self.near, self.far):
            _must("netns", "add", name)
            _must("-n", name, "link", "set", "lo", "up")
        _must("-n", self.near, "link", "add", "name", "near", "type", "veth", "peer", "name", "far", "netns", self.far)
        for name, device, address in ((self.near, "near", NEAR_ADDRESS), (self.far, "far", FAR_ADDRESS)):
            _must("-n", name, "address", "add", f"{address}/24", "dev", device)
            _must("-n", name, "link", "set", device, "up")
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for name in (self.near, self.far):
            _ip("netns", "delete", name)


def pull(namespace: str) -> None:
    """Pull the cable at its near end."""
    _must("-n", namespace, "link", "set", "near", "down")


def plug(namespace: str) -> None:
    """Put it in again."""
    _must("-n", namespace, "link", "set", "near", "up")


def _ip(*words: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(["ip", *words], capture_output=True, text=True, check=False)


def _must(*words: str) -> None:
    done = _ip(*words)
    if done.returncode:
        raise RuntimeError(f"ip {' '.join(words)}: {done.stderr.strip()}")
