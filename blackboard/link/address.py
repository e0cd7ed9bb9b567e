"""Where a keeper listens: `tcp/127.0.0.1:7447`, read with or without its protocol, and whether it lies on this machine."""

import ipaddress
import re
from dataclasses import dataclass

from blackboard.errors import LinkError

DEFAULT_PORT = 7447
DEFAULT_ADDRESS = f"tcp/127.0.0.1:{DEFAULT_PORT}"
PROTOCOLS = ("tcp", "tls")

_ADDRESS = re.compile(r"(?:(?P<protocol>[a-z0-9]+)/)?(?P<host>\[[^\[\]]+\]|[^\[\]/:]+)(?::(?P<port>[0-9]{1,5}))?")
_HOST_NAME = re.compile(r"(?!-)[A-Za-z0-9-]{1,63}(?<!-)(?:\.(?!-)[A-Za-z0-9-]{1,63}(?<!-))*\.?")


@dataclass(frozen=True, slots=True)
class Address:
    """A host and a port, and the protocol where it was named."""

    host: str  # a name or an IP address, IPv6 without brackets
    port: int
    protocol: str | None = None

    @property
    def loopback(self) -> bool:
        """Say whether only processes of this machine can reach it."""
        if self.host == "localhost":
            return True
        address = ip_address(self.host)
        return address is not None and address.is_loopback

    def endpoint(self, protocol: str) -> str:
        """Return it as zenoh writes it."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{protocol}/{host}:{self.port}"


def parse_address(text: str) -> Address:
    """Read `[PROTOCOL/]HOST[:PORT]`; raise LinkError for anything else."""
    match = _ADDRESS.fullmatch(text)
    if match is None:
        raise LinkError(f"address '{text}' is not of the form tcp/HOST:PORT, e.g. {DEFAULT_ADDRESS}")
    protocol, host, port = match["protocol"], match["host"], int(match["port"] or DEFAULT_PORT)
    if protocol is not None and protocol not in PROTOCOLS:
        raise LinkError(f"address '{text}': the protocol '{protocol}' is none of {', '.join(PROTOCOLS)}")
    if not 1 <= port <= 65535:
        raise LinkError(f"address '{text}': the port {port} is outside 1..65535")
    bare = host.strip("[]")
    if host.startswith("["):
        if ":" not in bare or ip_address(bare) is None:
            raise LinkError(f"address '{text}': '{bare}' is no IPv6 address")
    elif ip_address(bare) is None and (_HOST_NAME.fullmatch(bare) is None or re.fullmatch(r"[0-9.]+", bare)):
        raise LinkError(f"address '{text}': '{bare}' is neither a host name nor an IP address")
    return Address(bare, port, protocol)


def ip_address(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    """Return the IP address that `host` is; None for a name."""
    try:
        return ipaddress.ip_address(host)
    except ValueError:
        return None
