"""The built page: how large it is, and that it names no other site and no key."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from hthor.live import server

pytestmark = pytest.mark.skipif(not (server.FOLDER / server.PAGE).exists(), reason="the page is not built: make page")
PAGE_BYTES = 2_000_000
_URL = re.compile(rb"(?:https?|wss?)://[\w.\-]+")
_NAMES = {b"http://www.w3.org", b"http://localhost"}
"""A name of XML's, which nobody fetches, and what the page of `hthor watch` tells people to open on their machine."""


def files() -> list[Path]:
    """What the server gives out, without the licences of the libraries in it."""
    return [path for path in sorted(server.FOLDER.glob("*")) if not path.name.endswith(".LEGAL.txt")]


@pytest.mark.parametrize("path", files(), ids=lambda path: path.name)
def test_no_other_site_is_named(path: Path) -> None:
    assert set(_URL.findall(path.read_bytes())) <= _NAMES


def test_no_key_is_given_out() -> None:
    assert not [path for path in files() if b"PRIVATE KEY" in path.read_bytes()]


def test_all_that_somebody_with_an_emulated_headset_loads_is_small() -> None:
    loaded = [path for path in files() if not path.name.startswith(("experimenter", "watch"))]
    assert 500_000 < sum(path.stat().st_size for path in loaded) < PAGE_BYTES
