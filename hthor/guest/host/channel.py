"""Messages to and from a guest, each with a deadline; whatever goes wrong ends the guest and is a fault."""

from __future__ import annotations

import time
from typing import Protocol

import msgspec

from hthor.guest.protocol import wire
from hthor.guest.protocol.sanitize import sanitize_text

_guests_words = msgspec.msgpack.Decoder(wire.ToHost)
_MOST_OPENED, _LONGEST = 20_000, 1000
_keepers_words = msgspec.msgpack.Decoder(wire.SupervisorToHost)


class GuestFault(Exception):
    """A submitted agent failed; its process is gone.

    Attributes:
        kind: raised, timeout, died, killed (from outside, as it seems), memory, disk, garbage, wrong_type, oversized
            or not_finite.
        detail: what happened; for "raised" the traceback of the agent's own frames.
        traceback: the same traceback, empty for the other kinds.
        log: the end of what the agent printed.
    """

    def __init__(self, kind: str, detail: str, traceback: str = "", log: str = "") -> None:
        self.kind, self.traceback, self.log = kind, traceback, log
        self.detail = traceback or detail
        super().__init__(f"{kind}: {detail}")


class DeadlinePassed(Exception):
    """The other end was not ready in time."""


class PeerGone(Exception):
    """The other end is gone."""


class Transport(Protocol):
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


class MessageChannel:
    """A conversation over a line, or over none once the guest is gone.

    ``loaded`` says that the guest is up: from then on a message that it failed is a fault. ``opened`` are the files
    that it says it has opened.
    """

    def __init__(self) -> None:
        self.line: Transport | None = None
        self.loaded = False
        self.opened: set[str] = set()
        self._log = ""

    def open(self, line: Transport) -> None:
        """Talk to this guest from now on."""
        self.line, self.loaded = line, False

    def send(self, message: wire.ToGuest, seconds: float, allowed: str = "") -> float:
        """Say something, and say what is left of the time.

        Args:
            allowed: what a fault is to say that it had, where ``seconds`` are the rest of that.

        Raises:
            GuestFault: when it is not taken in time.
        """
        body = wire.encode(message)
        end = time.monotonic() + seconds
        try:
            self._running().write(body, end)
        except DeadlinePassed:
            raise self.fault("timeout", f"the agent read nothing for {allowed or f'{seconds:g} s'}") from None
        except PeerGone:
            raise self.fault(*self._running().obituary()) from None
        return max(0.0, end - time.monotonic())

    def receive(self, seconds: float, allowed: str = "") -> tuple[wire.ToHost | wire.Over, float]:
        """The next message of the guest or its keeper, and what is left of the time.

        Args:
            allowed: as in `send`. A fault is part of a record, so it does not tell what a clock said.

        Raises:
            GuestFault: when there is none, or it is none.
        """
        end = time.monotonic() + seconds
        try:
            keepers, body = self._running().read(wire.MOST_BYTES, end)
        except DeadlinePassed:
            raise self.fault("timeout", f"the agent gave no answer within {allowed or f'{seconds:g} s'}") from None
        except PeerGone:
            raise self.fault(*self._running().obituary()) from None
        if isinstance(body, int):
            raise self.fault("oversized", f"a message of {body} bytes, at most {wire.MOST_BYTES} are taken")
        message: wire.ToHost | wire.Over
        try:
            message = _keepers_words.decode(body) if keepers else _guests_words.decode(body)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            raise self.fault("garbage", f"what came is no message: {error}") from None
        if len(self.opened) < _MOST_OPENED:
            self.opened.update(name for name in getattr(message, "files", ()) if len(name) <= _LONGEST)
        if isinstance(message, wire.Failed) and (self.loaded or keepers):
            kind = message.kind if keepers or message.kind in wire.OWN_FAULTS else "garbage"
            raise self.fault(kind, message.detail, message.traceback)
        return message, max(0.0, end - time.monotonic())

    def wrong(self, what: str, answer: object) -> GuestFault:
        """The fault of a message that does not belong here; the guest is gone."""
        if isinstance(answer, wire.Over):
            return self.fault("died", f"its process ended before it had answered {what}")
        return self.fault("garbage", f"{what} was answered by {type(answer).__name__}")

    def fault(self, kind: str, detail: str, traceback: str = "") -> GuestFault:
        """End the guest, and say why."""
        log = self.log
        self.close()
        kind = kind if kind in wire.FAULTS else "garbage"
        return GuestFault(kind, sanitize_text(detail)[: wire.TEXT_MAX], sanitize_text(traceback)[-wire.TEXT_MAX :], log)

    @property
    def log(self) -> str:
        """The end of what the guest printed."""
        return self._log if self.line is None else self.line.log

    def release(self) -> None:
        """Go on without the guest, which somebody else has now."""
        if self.line is not None:
            self._log, self.line = self.line.log, None

    def close(self) -> None:
        """End the guest."""
        line, self.line = self.line, None
        if line is not None:
            self._log = line.log
            line.kill()

    def _running(self) -> Transport:
        if self.line is None:
            raise GuestFault("died", "the agent's process is gone")
        return self.line
