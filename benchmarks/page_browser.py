"""The page of `hthor live` in a browser without a screen: Chromium, which draws on the processor."""

from __future__ import annotations

import base64
import shutil
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from hthor.live import server
from hthor.live.gltf.house_file import HouseFile
from hthor.types import BodySpec, Pose

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
_GRAPHICS = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
_TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml"}
_HOUSE = "/house.glb"
_FINE = 2
"""Pictures are drawn in this many times their size and averaged, as the renderer of `nice` does."""

_LOAD = """async ({own, eye}) => {
  page.renderer.setAnimationLoop(null);
  await page.on_trial({
    type: "trial", trial: 0, trials: 1, instruction: "", time_limit: 60, file: "/house.glb", own,
    bodies: [{ seat: page.seat, eye, speed: 1 }],
  });
}"""
_DRAW = """({place, yaw, pitch, fov, width, height, moved}) => {
  page.renderer.setPixelRatio(1);
  page.renderer.setSize(width, height, false);
  page.camera.fov = fov;
  page.camera.aspect = width / height;
  page.camera.updateProjectionMatrix();
  [page.motion.x, page.motion.y] = place;
  [page.keys.yaw, page.keys.pitch] = [yaw, pitch];
  page.house.move(moved);
  page.house.step(1);
  page.aim();
  page.renderer.render(page.scene, page.camera);
  return page.renderer.domElement.toDataURL("image/png");
}"""


@contextmanager
def browser() -> Iterator[Any]:
    """A browser; raises SystemExit where there is none, or where the page is not built."""
    if CHROMIUM is None:
        raise SystemExit("pictures of the page need Chromium, which is not installed.")
    if not (server.FOLDER / server.PAGE).exists():
        raise SystemExit("the page is not built: make page")
    from playwright import sync_api

    with sync_api.sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=CHROMIUM, args=list(_GRAPHICS))
        try:
            yield made
        finally:
            made.close()


class HousePage:
    """The page with a house in it and without a session.

    Args:
        browser: see `browser`. file: the house. own: the parts of the person's own body, which are not drawn.
    """

    def __init__(self, browser: Any, file: HouseFile, own: Sequence[int]) -> None:
        self._server = _serve(file)
        host, port = self._server.server_address[:2]
        self._page = browser.new_page(viewport={"width": 320, "height": 240})
        self._page.goto(f"http://{host!s}:{port}/")
        self._own = list(own)

    def picture(self, pose: Pose, body: BodySpec, size: tuple[int, int], poses: Any) -> NDArray[np.uint8]:
        """What the page shows to a body at a pose, (H, W, 3) uint8, of ``size`` (width, height).

        Args:
            poses: for each number of a part where it is, (7,) position [m] and quaternion (w, x, y, z).
        """
        if not self._page.evaluate("page.house !== null"):
            self._page.evaluate(_LOAD, {"own": self._own, "eye": body.eye})
        moved = [
            {"number": number, "position": [*map(float, row[:3])], "turn": [*map(float, (*row[4:], row[3]))]}
            for number, row in poses.items()
        ]
        width, height = size
        view = {"place": [pose.x, pose.y], "yaw": pose.gaze, "pitch": pose.pitch, "fov": float(np.degrees(body.fov[1]))}
        url = self._page.evaluate(_DRAW, {**view, "width": _FINE * width, "height": _FINE * height, "moved": moved})
        drawn = cv2.imdecode(np.frombuffer(base64.b64decode(url.partition(",")[2]), np.uint8), cv2.IMREAD_COLOR)
        assert drawn is not None
        return np.asarray(cv2.resize(drawn, size, interpolation=cv2.INTER_AREA)[..., ::-1], np.uint8)

    def close(self) -> None:
        """Close the page and its server."""
        self._page.close()
        self._server.shutdown()
        self._server.server_close()


def _serve(file: HouseFile) -> ThreadingHTTPServer:
    """A server of the page's files and of one house."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            path = self.path.partition("?")[0]
            if path == _HOUSE:
                self._answer(file.data, "model/gltf-binary", "gzip")
                return
            asked = server.FOLDER / (path.lstrip("/") or server.PAGE)
            if asked.parent != server.FOLDER or not asked.is_file():
                self.send_error(404)
                return
            self._answer(asked.read_bytes(), _TYPES.get(asked.suffix, "application/octet-stream"), "identity")

        def _answer(self, data: bytes, kind: str, encoding: str) -> None:
            self.send_response(200)
            headers = {"Content-Type": kind, "Content-Encoding": encoding, "Content-Length": str(len(data))}
            for name, value in headers.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, format: str, *words: Any) -> None:
            pass

    made = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=made.serve_forever, daemon=True).start()
    return made
