"""Serves one page to browsers on this machine."""

from __future__ import annotations

from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from hthor.errors import HthorError

_HOST = "127.0.0.1"
_NAMES = ("127.0.0.1", "localhost")
_HEADERS = {
    "Content-Type": "text/html; charset=utf-8",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Cache-Control": "no-store",
}


class PageServer(ThreadingHTTPServer):
    """A server of one page, whose own policy says what it may do; other machines cannot reach it.

    Args:
        port: 0 for any that is free.

    Raises:
        HthorError: when the port is taken.
    """

    daemon_threads = True

    def __init__(self, page: bytes, port: int = 0) -> None:
        self.page = page
        try:
            super().__init__((_HOST, port), _Handler)
        except OSError as error:
            raise HthorError(
                f"--port {port}: {error.strerror}. Choose another port, or 0 for any that is free."
            ) from None

    @property
    def address(self) -> str:
        """What a browser opens."""
        return f"http://{_HOST}:{self.server_port}/"


class _Handler(BaseHTTPRequestHandler):
    server: PageServer

    def do_GET(self) -> None:
        """Send the page, to those who call this server by a name of this machine's."""
        host = self.headers.get("Host", "").partition(":")[0]
        if self.path.partition("?")[0] != "/" or host not in _NAMES:
            self.send_error(404)
            return
        self.send_response(200)
        for name, value in {**_HEADERS, "Content-Length": str(len(self.server.page))}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(self.server.page)

    def log_message(self, format: str, *words: Any) -> None:
        """Say nothing."""
