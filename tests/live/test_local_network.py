"""Live sessions on other machines of the local network: certificate, addresses, and who is refused."""

from __future__ import annotations

import hashlib
import ipaddress
import socket
import ssl
import stat
import subprocess
import sys
import urllib.request
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from urllib.error import HTTPError, URLError

import pytest
from live_client import ScriptedPerson
from websockets.exceptions import InvalidStatus

from hthor.errors import HthorError, MissingExtra
from hthor.eval.config.options import EvalOptions
from hthor.live import local_network
from hthor.live.certificate import LIFE, certificate
from hthor.live.run import LiveRun
from hthor.types import HUMAN

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")
x509 = pytest.importorskip("cryptography.x509", reason="--lan needs an optional dependency: pip install 'hthor[live]'")

ADDRESS = "127.0.0.2"
"""Another address of this machine, which Linux has without any network."""
HOSTS = ("192.0.2.7", "lab-pc", "localhost")
NOW = datetime(2030, 5, 1, tzinfo=UTC)


def test_a_certificate_has_all_names_and_only_its_owner_can_read_its_key(tmp_path: Path) -> None:
    made = certificate(HOSTS, tmp_path / "tls", NOW)
    read = x509.load_pem_x509_certificate(made.path.read_bytes())
    names = read.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    assert names.get_values_for_type(x509.IPAddress) == [ipaddress.ip_address("192.0.2.7")]
    assert names.get_values_for_type(x509.DNSName) == ["lab-pc", "localhost"]
    assert stat.S_IMODE(made.path.stat().st_mode) == 0o600
    assert [path.name for path in made.path.parent.iterdir()] == [made.path.name]
    _, begin, rest = made.path.read_text().partition("-----BEGIN CERTIFICATE")
    shown = hashlib.sha256(ssl.PEM_cert_to_DER_cert(begin + rest))
    assert made.fingerprint.replace(":", "").lower() == shown.hexdigest()


def test_a_certificate_is_kept_as_long_as_it_fits(tmp_path: Path) -> None:
    made = certificate(HOSTS, tmp_path, NOW)
    assert certificate(HOSTS, tmp_path, NOW + timedelta(days=300)) == made
    assert certificate(HOSTS[:2], tmp_path, NOW) == made, "an address less is no reason for another warning"
    moved = certificate(("192.0.2.8", *HOSTS[1:]), tmp_path, NOW)
    assert moved.fingerprint != made.fingerprint
    renewed = certificate(("192.0.2.8", *HOSTS[1:]), tmp_path, NOW + LIFE - timedelta(days=1))
    assert renewed.fingerprint != moved.fingerprint


@pytest.mark.parametrize("harm", [lambda path: path.chmod(0o644), lambda path: path.write_text("nothing")])
def test_a_key_that_others_could_read_or_that_is_damaged_is_made_again(tmp_path: Path, harm: object) -> None:
    made = certificate(HOSTS, tmp_path, NOW)
    harm(made.path)  # type: ignore[operator]
    again = certificate(HOSTS, tmp_path, NOW)
    assert again.fingerprint != made.fingerprint
    assert stat.S_IMODE(again.path.stat().st_mode) == 0o600


def test_a_missing_library_is_one_sentence_that_names_the_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "cryptography", None)
    with pytest.raises(MissingExtra, match=r"hthor\[live\]"):
        certificate(HOSTS, tmp_path, NOW)


def test_the_addresses_are_those_of_this_machine() -> None:
    for address in local_network.addresses():
        with socket.create_server((address, 0)):
            assert not ipaddress.ip_address(address).is_loopback


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveRun]:
    """A run that other machines may join."""
    folder = tmp_path_factory.mktemp("lan")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        patch.setattr(local_network, "addresses", lambda: (ADDRESS,))
        options = EvalOptions(agent=("none",), humans=("live",), limit=1, suite="smoke", out=folder / "run")
        with LiveRun(options, page=False, lan=True) as made:
            yield made


def test_a_person_joins_from_another_machine_with_the_certificate_trusted(run: LiveRun) -> None:
    assert run.certificate is not None
    url, _, token = run.server.url(HUMAN, run.hosts[0]).partition("/#")
    assert url.startswith(f"https://{ADDRESS}:")
    with ScriptedPerson(url, token, trusts=run.certificate.path) as person:
        assert person.wait_for("welcome")["seat"] == HUMAN
    with pytest.raises(ssl.SSLCertVerificationError), ScriptedPerson(url, token):
        pass


def test_nothing_is_served_without_encryption(run: LiveRun) -> None:
    plain = run.server.address_at(ADDRESS).replace("https", "http")
    with pytest.raises((OSError, URLError)):
        urllib.request.urlopen(plain, timeout=60)


def test_only_this_machine_s_names_are_answered(run: LiveRun) -> None:
    assert run.certificate is not None
    context = ssl.create_default_context(cafile=run.certificate.path)

    def ask(host: str) -> int:
        request = urllib.request.Request(run.server.address_at(ADDRESS) + "/", headers={"Host": host})
        try:
            with urllib.request.urlopen(request, timeout=60, context=context) as answer:
                return int(answer.status)
        except HTTPError as error:
            return error.code

    port = run.server.address_at(ADDRESS).rpartition(":")[2]
    own = [f"{name}:{port}" for name in (ADDRESS, local_network.host_name(), "localhost")]
    assert {host: run.server._is_ours(host) for host in own} == dict.fromkeys(own, True)
    for host in ("evil.example", f"evil.example:{port}", f"192.0.2.9:{port}", f"{ADDRESS}:1", ADDRESS):
        assert not run.server._is_ours(host)
        assert ask(host) == 404


@pytest.mark.parametrize("origin", ["https://evil.example", "http://{own}", "null"])
def test_pages_of_other_sites_are_refused(run: LiveRun, origin: str) -> None:
    assert run.certificate is not None
    url, own = run.server.address_at(ADDRESS), run.server.address_at(ADDRESS).partition("://")[2]
    origin, trusts = origin.format(own=own), run.certificate.path
    with (
        pytest.raises(InvalidStatus, match="403"),
        ScriptedPerson(url, run.server.tokens[HUMAN], origin=origin, trusts=trusts),
    ):
        pass


def test_a_machine_without_a_network_is_not_offered_to_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(local_network, "addresses", lambda: ())
    options = EvalOptions(agent=("none",), humans=("live",), limit=1, suite="smoke", out=tmp_path / "run")
    with pytest.raises(HthorError, match="leave out --lan"):
        LiveRun(options, page=False, lan=True)


def test_no_private_key_is_in_the_repository() -> None:
    root = Path(__file__).resolve().parents[2]
    if not (root / ".git").exists():
        pytest.skip("this is no clone of the repository")
    found = subprocess.run(
        ["git", "grep", "-lE", "-e", "-----BEGIN [A-Z ]*PRIVATE KEY"], cwd=root, capture_output=True, text=True
    )
    assert (found.returncode, found.stdout) == (1, ""), found.stderr
