"""What a browser says of a server with `--lan`: ``python -m benchmarks.page_certificate [--out PICTURE]``.

Chromium's warning of its certificate, and beside it the same once *Advanced* is pressed. The script goes on until the
page behind the warning is connected.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from benchmarks import page_browser
from hthor.live.certificate import certificate
from hthor.live.control import SessionControl
from hthor.live.desk import Desk
from hthor.live.run_book import RunBook
from hthor.live.seat import LiveSeat
from hthor.live.server import LiveServer
from hthor.types import HUMAN

CERTIFICATE = "live_certificate.jpg"
_HOST = "192.0.2.2"
"""An address for documentation (RFC 5737), which this browser takes for its own machine."""
_WINDOW = (760, 610)
_ADVANCED, _PROCEED = "#details-button", "#proceed-link"
_GAP, _PAPER, _QUALITY = 8, 225, 86
_PATIENCE_MS, _CALM_MS, _POLL_MS = 30_000, 500, 50


def write(path: Path) -> None:
    """Write both states of the warning side by side."""
    from playwright import sync_api

    if page_browser.CHROMIUM is None:
        raise SystemExit("a picture of a browser's warning needs Chromium, which is not installed.")
    arguments = ["--no-sandbox", f"--host-resolver-rules=MAP {_HOST} 127.0.0.1"]
    with _server() as server, sync_api.sync_playwright() as playwright:
        page = playwright.chromium.launch(executable_path=page_browser.CHROMIUM, args=arguments).new_page(
            viewport=dict(zip(("width", "height"), _WINDOW, strict=True))
        )
        page.set_default_timeout(_PATIENCE_MS)
        try:
            page.goto(server.url(HUMAN, _HOST))
        except sync_api.Error as error:
            if "ERR_CERT_AUTHORITY_INVALID" not in str(error):
                raise
        page.wait_for_selector(_ADVANCED)
        shots = [_screenshot(page)]
        page.click(_ADVANCED)
        page.wait_for_selector(_PROCEED)
        shots.append(_screenshot(page))
        page.click(_PROCEED)
        end = time.monotonic() + _PATIENCE_MS / 1000.0
        while not page.evaluate("globalThis.page?.seat"):
            if time.monotonic() > end:
                raise SystemExit("the page behind the warning does not connect.")
            page.wait_for_timeout(_POLL_MS)
    rule = np.full((_WINDOW[1], _GAP, 3), _PAPER, np.uint8)
    cv2.imwrite(str(path), np.concatenate([shots[0], rule, shots[1]], axis=1), [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])


@contextmanager
def _server() -> Iterator[LiveServer]:
    seats = {HUMAN: LiveSeat(HUMAN)}
    with tempfile.TemporaryDirectory() as folder:
        made = certificate([_HOST], Path(folder))
        server = LiveServer(seats, Desk(SessionControl(), seats, RunBook()), certificate=made, hosts=[_HOST])
        server.start()
        try:
            yield server
        finally:
            server.close()


def _screenshot(page: Any) -> Any:
    page.wait_for_timeout(_CALM_MS)
    return cv2.imdecode(np.frombuffer(page.screenshot(), np.uint8), cv2.IMREAD_COLOR)


def main() -> None:
    """Make the picture."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.page_certificate", description=__doc__.splitlines()[0])
    options.add_argument("--out", type=Path, default=Path("docs/images") / CERTIFICATE, help="picture")
    write(options.parse_args().out)


if __name__ == "__main__":
    main()
