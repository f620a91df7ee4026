"""How a headset joins a laboratory: addresses as QR codes, and what `hthor doctor` says of what it needs."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from hthor.live import session_checks
from hthor.live.qr_code import qr_code


@pytest.mark.parametrize("host", ["192.0.2.2:8765", "a-rather-long-name-of-a-machine.laboratory.example:8765"])
def test_a_qr_code_says_the_address(host: str) -> None:
    pytest.importorskip("segno", reason="QR codes need an optional dependency: pip install 'hthor[live]'")
    address = f"https://{host}/#NJF733Cpnki1lIgyNwU_6w"
    rows = [
        [255 * (" ▄▀█".index(sign) >> half & 1) for sign in line]
        for line in qr_code(address).splitlines()
        for half in (1, 0)
    ]
    picture = np.kron(np.array(rows, np.uint8), np.ones((8, 8), np.uint8))
    assert cv2.QRCodeDetector().detectAndDecode(picture)[0] == address


def test_a_page_that_is_not_built_is_built(tmp_path: Path) -> None:
    assert session_checks.check_page(tmp_path).fix == "make page"
    (tmp_path / "index.html").touch()
    assert session_checks.check_page(tmp_path).status == "ok"


def test_a_machine_without_an_address_is_reached_by_no_other() -> None:
    assert session_checks.check_network(()).status == "warn"
    found = session_checks.check_network(("192.0.2.2", "198.51.100.7"))
    assert found.status == "ok"
    assert "192.0.2.2, 198.51.100.7" in found.says


@pytest.mark.parametrize(
    ("maker", "adb", "status", "words"),
    [
        ("2833", "/usr/bin/adb", "ok", "Quest 3 at USB; 'adb reverse tcp:8765 tcp:8765'"),
        ("2833", None, "warn", "Quest 3 at USB, but adb is not installed"),
        ("046d", "/usr/bin/adb", "ok", "none at USB (adb is installed)"),
        ("046d", None, "ok", "none at USB (that needs adb"),
    ],
)
def test_a_headset_at_usb_needs_adb(maker: str, adb: str | None, status: str, words: str, tmp_path: Path) -> None:
    device = tmp_path / "1-4"
    device.mkdir()
    (device / "idVendor").write_text(f"{maker}\n", encoding="utf-8")
    (device / "product").write_text("Quest 3\n", encoding="utf-8")
    (tmp_path / "usb1").mkdir()
    found = session_checks.check_headset(tmp_path, adb)
    assert found.status == status
    assert found.says.startswith(words)
    assert bool(found.fix) == (status != "ok")
