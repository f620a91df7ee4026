"""The certificate with which a live session is served to other machines: made here, for this machine, and kept.

It is signed by itself, so a browser warns of it once; whoever compares its fingerprint with the one that hthor prints
may go on. It stays the same from session to session, so that the browser remembers.
"""

from __future__ import annotations

import contextlib
import ipaddress
import os
import tempfile
from collections.abc import Collection
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from hthor import installation, jsonio
from hthor.errors import HthorError, MissingExtra

if TYPE_CHECKING:
    from cryptography import x509

LIFE = timedelta(days=397)
"""For how long a certificate holds; some browsers accept none that holds for longer."""
_SPARE = timedelta(days=2)
"""A certificate that ends so soon is renewed, so that it outlasts the session. Our choice."""
_EARLIER = timedelta(hours=1)
"""A certificate holds from a little before it was made, for machines whose clocks are late. Our choice."""
_NAME = "certificate.pem"


class Certificate(NamedTuple):
    """A certificate and its private key, in one file that only this user can read.

    Attributes:
        path: the PEM file, as `ssl.SSLContext.load_cert_chain` takes it.
        fingerprint: SHA-256, as browsers show it: pairs of digits, with colons.
    """

    path: Path
    fingerprint: str


def certificate(hosts: Collection[str], folder: Path | None = None, now: datetime | None = None) -> Certificate:
    """The certificate for these names and addresses: the one that is kept, or a new one if that does not fit.

    Args:
        hosts: names and IP addresses. folder: where it is kept; by default in hthor's cache.
        now: the time, with its time zone.

    Raises:
        MissingExtra: without the library that makes certificates.
        HthorError: when the file cannot be written.
    """
    try:
        from cryptography import x509
        from cryptography.hazmat.primitives.hashes import SHA256
    except ImportError:
        raise MissingExtra("--lan, which encrypts what other machines see,", "live") from None
    path = (folder or installation.cache() / "live" / "tls") / _NAME
    now = now or datetime.now(UTC)
    made = _read(path)
    if made is None or not _fits(made, hosts, now):
        _write(path, _make(hosts, now))
        made = x509.load_pem_x509_certificate(path.read_bytes())
    return Certificate(path, made.fingerprint(SHA256()).hex(":").upper())


def _read(path: Path) -> x509.Certificate | None:
    """The certificate in a file; None if there is none, or others could have read its key."""
    from cryptography import x509
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    try:
        if path.stat().st_mode & 0o077 or path.stat().st_uid != os.geteuid():
            return None
        data = path.read_bytes()
        made = x509.load_pem_x509_certificate(data)
        key = load_pem_private_key(data, password=None)
    except (OSError, ValueError):
        return None
    return made if key.public_key() == made.public_key() else None


def _fits(made: x509.Certificate, hosts: Collection[str], now: datetime) -> bool:
    """Whether a certificate holds for some time, for all of these names and addresses."""
    from cryptography import x509

    try:
        names = made.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return False
    holds = made.not_valid_before_utc <= now and now + _SPARE <= made.not_valid_after_utc
    return holds and {_alternative(host) for host in hosts} <= set(names)


def _make(hosts: Collection[str], now: datetime) -> bytes:
    """A new key and its certificate, as a PEM file."""
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes, serialization
    from cryptography.hazmat.primitives.asymmetric import ec
    from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "hthor live")])
    builder = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - _EARLIER)
        .not_valid_after(now + LIFE - _EARLIER)
        .add_extension(x509.SubjectAlternativeName([_alternative(host) for host in hosts]), critical=False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
    )
    made = builder.sign(key, hashes.SHA256())
    pem, form = serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8
    return key.private_bytes(pem, form, serialization.NoEncryption()) + made.public_bytes(pem)


def _alternative(host: str) -> x509.GeneralName:
    """A name or an address as certificates have it."""
    from cryptography import x509

    try:
        return x509.IPAddress(ipaddress.ip_address(host))
    except ValueError:
        return x509.DNSName(host)


def _write(path: Path, data: bytes) -> None:
    """Replace the file in one step; at no time can anybody else read it."""
    try:
        jsonio.make_folder(path.parent)
        handle, name = tempfile.mkstemp(dir=path.parent)  # which only this user can read and write
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(data)
            os.replace(name, path)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(name)
            raise
    except OSError as error:
        raise HthorError(
            f"{path}: {error.strerror}. The certificate for --lan is kept there; make that folder writable, or name "
            "another place for caches in XDG_CACHE_HOME."
        ) from None
