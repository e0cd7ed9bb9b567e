"""Addresses: what is taken, what is refused with one line, what only this machine can reach."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import LinkError
from blackboard.link.address import Address, parse_address


@pytest.mark.parametrize(
    ("text", "address", "loopback"),
    [
        ("tcp/127.0.0.1:7447", Address("127.0.0.1", 7447, "tcp"), True),
        ("127.3.2.1:1", Address("127.3.2.1", 1), True),
        ("localhost", Address("localhost", 7447), True),
        ("tls/[::1]:65535", Address("::1", 65535, "tls"), True),
        ("tls/robot-7.lan:7500", Address("robot-7.lan", 7500, "tls"), False),
        ("0.0.0.0", Address("0.0.0.0", 7447), False),
        ("[::]:7447", Address("::", 7447), False),
        ("128.0.0.1:7447", Address("128.0.0.1", 7447), False),
        ("localhost.example.org", Address("localhost.example.org", 7447), False),
    ],
)
def test_an_address_is_read(text, address, loopback):
    parsed = parse_address(text)
    assert parsed == address
    assert parsed.loopback is loopback


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "is not of the form tcp/HOST:PORT"),
        ("tcp/", "is not of the form tcp/HOST:PORT"),
        ("tcp/127.0.0.1:", "is not of the form tcp/HOST:PORT"),
        ("tcp/127.0.0.1:seven", "is not of the form tcp/HOST:PORT"),
        ("tcp/::1:7447", "is not of the form tcp/HOST:PORT"),
        ("127.0.0.1:7447;tcp/0.0.0.0:1", "is not of the form tcp/HOST:PORT"),
        ("127.0.0.1:7447#iface=eth0", "is not of the form tcp/HOST:PORT"),
        ("udp/127.0.0.1:7447", "'udp' is none of tcp, tls"),
        ("127.0.0.1:0", "the port 0 is outside 1..65535"),
        ("127.0.0.1:65536", "the port 65536 is outside 1..65535"),
        ("127.0.0.256", "neither a host name nor an IP address"),
        ("127.1", "neither a host name nor an IP address"),
        ("-x.org:7447", "neither a host name nor an IP address"),
        ("[robot]:7447", "no IPv6 address"),
        ("[127.0.0.1]:7447", "no IPv6 address"),
    ],
)
def test_a_malformed_address_is_refused(text, says):
    with pytest.raises(LinkError, match=r"^address") as caught:
        parse_address(text)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


@given(st.ip_addresses(), st.integers(1, 65535), st.sampled_from(["tcp", "tls"]))
def test_what_is_written_is_read(ip, port, protocol):
    address = Address(str(ip), port, protocol)
    assert parse_address(address.endpoint(protocol)) == address
    assert address.loopback is ip.is_loopback


@given(st.text(max_size=60))
def test_any_text_is_an_address_or_refused(text):
    try:
        parsed = parse_address(text)
    except LinkError:
        return
    assert parse_address(parsed.endpoint("tcp")).host == parsed.host
