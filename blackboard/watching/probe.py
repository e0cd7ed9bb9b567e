"""Who listens at an address, found out with plain sockets: nobody, something, something that wants certificates."""

import contextlib
import socket
import ssl
from pathlib import Path

from blackboard.link.address import Address

WAIT_S = 2.0


def connects(address: Address) -> str:
    """Return why nothing can be connected to at the address; empty where something can."""
    try:
        with socket.create_connection((address.host, address.port), WAIT_S):
            return ""
    except OSError as error:
        return error.strerror or str(error)


def tls_trouble(address: Address, keys: Path | None) -> str | None:
    """Return why what listens at the address, which speaks TLS, does not take these keys; None where it speaks no TLS."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    if keys is not None:
        try:
            context.load_verify_locations(keys / "ca.pem")
            context.verify_mode = ssl.CERT_REQUIRED
            context.load_cert_chain(keys / "cert.pem", keys / "key.pem")
        except OSError as error:
            return f"{keys}: {_reason(error)}"
    try:
        with (
            socket.create_connection((address.host, address.port), WAIT_S) as plain,
            context.wrap_socket(plain, server_hostname=address.host) as secured,
        ):
            with contextlib.suppress(TimeoutError):
                secured.recv(1)  # what TLS 1.3 thinks of our certificate comes after the handshake
            return ""
    except ssl.SSLError as error:
        return None if error.reason in ("WRONG_VERSION_NUMBER", "RECORD_LAYER_FAILURE") else _reason(error)
    except OSError:
        return None


def _reason(error: OSError) -> str:
    words = error.reason if isinstance(error, ssl.SSLError) and error.reason else error.strerror or str(error)
    return str(words).replace("_", " ").lower()
