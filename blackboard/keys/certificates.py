"""Certificates in PEM: an authority, and what it signs for the keeper and for members.

The only module that needs the package `cryptography`; using keys does not take it, making them does.
"""

import datetime
import ipaddress
from collections.abc import Sequence
from dataclasses import dataclass

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID, ObjectIdentifier

from blackboard.errors import KeysError

KEEPER_NAME = "keeper"  # no member's common name: those end in a number
BEFORE = datetime.timedelta(hours=1)  # clocks differ: a certificate counts from a little before it was made


@dataclass(frozen=True, slots=True)
class Pair:
    """A certificate and its private key, in PEM."""

    certificate: bytes
    key: bytes


def make_authority(now: datetime.datetime, days: int) -> Pair:
    """Make an authority that signs certificates, and no other authorities."""
    key = ec.generate_private_key(ec.SECP256R1())
    name = _name("ski authority")
    builder = (
        _builder(name, name, key, now, now + datetime.timedelta(days=days))
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .add_extension(_usage(signs_certificates=True), critical=True)
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False)
    )
    return _signed(builder, key, key)


def make_keeper(authority: Pair, hosts: Sequence[str], now: datetime.datetime, days: int) -> Pair:
    """Make the certificate that the keeper shows, good for the host names and addresses under which it is reached."""
    names = x509.SubjectAlternativeName([_alternative_name(host) for host in hosts])
    return _leaf(authority, KEEPER_NAME, ExtendedKeyUsageOID.SERVER_AUTH, now, days, names)


def make_member(authority: Pair, common_name: str, now: datetime.datetime, days: int) -> Pair:
    """Make the certificate that a member shows to the keeper; nobody can pass for a keeper with it."""
    return _leaf(authority, common_name, ExtendedKeyUsageOID.CLIENT_AUTH, now, days)


def expiry(certificate: bytes) -> datetime.datetime:
    """Return until when a certificate counts."""
    return _load(certificate).not_valid_after_utc


def hosts_of(certificate: bytes) -> tuple[str, ...]:
    """Return the host names and addresses that a keeper's certificate is good for."""
    try:
        names = _load(certificate).extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return ()
    return tuple(str(name.value) for name in names)


def _leaf(
    authority: Pair,
    common_name: str,
    purpose: ObjectIdentifier,
    now: datetime.datetime,
    days: int,
    names: x509.SubjectAlternativeName | None = None,
) -> Pair:
    issuer = _load(authority.certificate)
    try:
        signing_key = serialization.load_pem_private_key(authority.key, None)
    except (ValueError, TypeError) as error:
        raise KeysError(f"the authority's key is spoiled ({error})") from None
    if not isinstance(signing_key, ec.EllipticCurvePrivateKey):
        raise KeysError("the authority's key is not one that `ski keys init` made")
    until = min(now + datetime.timedelta(days=days), issuer.not_valid_after_utc)
    if until <= now:
        raise KeysError("the authority has expired; make new keys with `ski keys init` in another folder")
    key = ec.generate_private_key(ec.SECP256R1())
    builder = (
        _builder(_name(common_name), issuer.subject, key, now, until)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(_usage(signs_certificates=False), critical=True)
        .add_extension(x509.ExtendedKeyUsage([purpose]), critical=False)
        .add_extension(x509.AuthorityKeyIdentifier.from_issuer_public_key(signing_key.public_key()), critical=False)
    )
    return _signed(builder if names is None else builder.add_extension(names, critical=False), key, signing_key)


def _load(certificate: bytes) -> x509.Certificate:
    try:
        return x509.load_pem_x509_certificate(certificate)
    except ValueError as error:
        raise KeysError(f"this is no certificate ({error})") from None


def _builder(
    subject: x509.Name,
    issuer: x509.Name,
    key: ec.EllipticCurvePrivateKey,
    now: datetime.datetime,
    until: datetime.datetime,
) -> x509.CertificateBuilder:
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(min(now, until) - BEFORE)
        .not_valid_after(until)
    )


def _signed(
    builder: x509.CertificateBuilder, key: ec.EllipticCurvePrivateKey, signing_key: ec.EllipticCurvePrivateKey
) -> Pair:
    certificate = builder.sign(signing_key, hashes.SHA256())
    return Pair(
        certificate.public_bytes(serialization.Encoding.PEM),
        key.private_bytes(serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()),
    )


def _name(common_name: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, common_name)])


def _alternative_name(host: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ipaddress.ip_address(host))
    except ValueError:
        return x509.DNSName(host)


def _usage(*, signs_certificates: bool) -> x509.KeyUsage:
    return x509.KeyUsage(
        digital_signature=not signs_certificates,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        key_cert_sign=signs_certificates,
        crl_sign=signs_certificates,
        encipher_only=False,
        decipher_only=False,
    )
