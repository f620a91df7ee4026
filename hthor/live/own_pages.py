"""The pages about themselves that people get at the end of a session, at addresses that nobody can guess."""

from __future__ import annotations

import secrets
import threading

POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'self'"
)
"""What a browser lets such a page do: it has a style of its own, and asks nobody for anything."""


class OwnPages:
    """The pages, each with a key; the server's thread gives them out."""

    def __init__(self) -> None:
        self._pages: dict[str, bytes] = {}
        self._left: set[str] = set()
        self._changed = threading.Condition()

    def publish(self, page: bytes) -> str:
        """Give out a page from now on; its address on the server."""
        key = secrets.token_urlsafe(16)
        with self._changed:
            self._pages[key] = page
            self._left.add(key)
        return f"/people/{key}.html"

    def take(self, key: str) -> bytes | None:
        """The page of a key, None if there is none."""
        with self._changed:
            self._left.discard(key)
            self._changed.notify_all()
            return self._pages.get(key)

    def wait(self, seconds: float) -> None:
        """Wait until every page was taken, but not longer than this."""
        with self._changed:
            self._changed.wait_for(lambda: not self._left, seconds)
