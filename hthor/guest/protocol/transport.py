"""What carries messages to a guest and back, as a shape."""

from __future__ import annotations

from typing import Protocol


class TimeIsUp(Exception):
    """The other end was not ready in time."""


class HungUp(Exception):
    """The other end is gone."""


class Line(Protocol):
    """A guest that can be talked to."""

    @property
    def pid(self) -> int:
        """The first of its processes on this machine, 0 when there is none."""

    @property
    def log(self) -> str:
        """The end of what it printed, empty where that cannot be had."""

    def write(self, body: bytes, end: float) -> None:
        """Send a message before a moment of the monotonic clock.

        Raises:
            TimeIsUp, HungUp: when it cannot.
        """

    def read(self, most: int, end: float) -> tuple[bool, bytes | int]:
        """The next message: whether it is the keeper's, and its bytes, or its size when it has more than ``most``.

        Raises:
            TimeIsUp, HungUp: when there is none.
        """

    def obituary(self) -> tuple[str, str]:
        """How it ended: a fault's kind and its words."""

    def kill(self) -> None:
        """Let it go for good."""
