"""Messages to and from a guest, each with a deadline.

Any failure ends the guest and raises a `GuestFault`, with an explanation if isolation caused it.
"""

import os
import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Protocol

import msgspec

from hthor.guest.confinement import Policy
from hthor.guest.protocol import wire
from hthor.guest.protocol.wire import sanitize_text

_guests_messages = msgspec.msgpack.Decoder(wire.ToHost)
_MOST_OPENED, _LONGEST = 20_000, 1000
_supervisors_messages = msgspec.msgpack.Decoder(wire.SupervisorToHost)
_QUOTED = re.compile(r"'([^'\n]+)'|\"([^\"\n]+)\"|(?<![\w'\"])(/[^\s'\":,;()]+)")
_VARIABLE = re.compile(r"KeyError: '([A-Za-z_]\w*)'")
_ENVIRONMENT = ("os.environ", "<frozen os>", "/os.py")


class GuestFault(Exception):
    """A submitted agent failed; its process is gone.

    Attributes:
        kind: raised, timeout, died, killed (from outside, as it seems), memory, disk, garbage, wrong_type, oversized
            or not_finite.
        detail: what happened; for "raised" the traceback of the agent's own frames.
        traceback: the same traceback, empty for the other kinds.
        log: the last part of the agent's output.
    """

    def __init__(self, kind: str, detail: str, traceback: str = "", log: str = "") -> None:
        self.kind, self.traceback, self.log = kind, traceback, log
        self.detail = traceback or detail
        super().__init__(f"{kind}: {detail}")


class DeadlinePassed(Exception):
    """The peer was not ready in time."""


class PeerGone(Exception):
    """The peer has closed the connection or ended."""


class TrialStopped(Exception):
    """The trial was ended by another thread while the agent still decided. Not a fault of the agent."""


class Transport(Protocol):
    """Carries messages to a guest and back: a process's pipes, or a WebSocket."""

    @property
    def pid(self) -> int:
        """The id of the guest's first process on this machine, 0 when there is none."""

    @property
    def log(self) -> str:
        """The last part of the guest's output; empty if unknown."""

    def write(self, body: bytes, end: float) -> None:
        """Send a message before a moment of the monotonic clock.

        Raises:
            DeadlinePassed, PeerGone: when it cannot be sent.
        """

    def read(self, most: int, end: float) -> tuple[bool, bytes | int]:
        """The next message.

        Returns:
            Whether it comes from the supervisor, and its bytes, or only its size if that is more than ``most``.

        Raises:
            DeadlinePassed, PeerGone: when no message arrives.
        """

    def end_reason(self) -> tuple[str, str]:
        """How the guest ended: a fault's kind and description."""

    def kill(self) -> None:
        """End the guest."""


class MessageChannel:
    """Typed messages over a transport.

    Attributes:
        transport: None once the guest has ended.
        loaded: whether the agent is loaded; after that, a ``Failed`` message is a fault.
        opened: the files that the guest has reported as opened.
        stopping: whether the host has ordered the supervisor to stop the trial.
    """

    def __init__(self) -> None:
        self.transport: Transport | None = None
        self.loaded = self.stopping = False
        self.opened: set[str] = set()
        self._log = ""

    def open(self, transport: Transport) -> None:
        """Use this transport from now on."""
        self.transport, self.loaded = transport, False

    def send(self, message: wire.ToGuest, seconds: float, allowed: str = "") -> float:
        """Send a message within ``seconds``; returns the seconds that are left.

        Args:
            allowed: the whole time allowed, in words for a fault, if ``seconds`` is only the rest of it.

        Raises:
            GuestFault: when the guest does not receive it in time.
        """
        body = wire.encode(message)
        end = time.monotonic() + seconds
        try:
            self._live_transport().write(body, end)
        except DeadlinePassed:
            raise self.fault("timeout", f"the agent read nothing for {allowed or f'{seconds:g} s'}") from None
        except PeerGone:
            raise self.fault(*self._live_transport().end_reason()) from None
        return max(0.0, end - time.monotonic())

    def receive(self, seconds: float, allowed: str = "") -> tuple[wire.ToHost | wire.Over, float]:
        """The next message of the guest or its supervisor, and the seconds that are left.

        Args:
            allowed: as in `send`. A fault is part of a record, so it never contains a measured time.

        Raises:
            GuestFault: if no message arrives in time, or the bytes are not a valid message.
        """
        end = time.monotonic() + seconds
        try:
            from_supervisor, body = self._live_transport().read(wire.MOST_BYTES, end)
        except DeadlinePassed:
            raise self.fault("timeout", f"the agent gave no answer within {allowed or f'{seconds:g} s'}") from None
        except PeerGone:
            raise self.fault(*self._live_transport().end_reason()) from None
        if isinstance(body, int):
            raise self.fault("oversized", f"a message of {body} bytes, at most {wire.MOST_BYTES} are accepted")
        message: wire.ToHost | wire.Over
        try:
            message = _supervisors_messages.decode(body) if from_supervisor else _guests_messages.decode(body)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            raise self.fault("garbage", f"what the agent sent is not a message: {error}") from None
        if len(self.opened) < _MOST_OPENED:
            self.opened.update(name for name in getattr(message, "files", ()) if len(name) <= _LONGEST)
        if isinstance(message, wire.Failed) and (self.loaded or from_supervisor):
            kind = message.kind if from_supervisor or message.kind in wire.OWN_FAULTS else "garbage"
            raise self.fault(kind, message.detail, message.traceback)
        return message, max(0.0, end - time.monotonic())

    def wrong(self, what: str, answer: object) -> GuestFault | TrialStopped:
        """The error to raise for an unexpected message; a fault has ended the guest."""
        if self.stopping and isinstance(answer, wire.Over):
            return TrialStopped("the trial was ended while the agent still decided")
        if isinstance(answer, wire.Over):
            return self.fault("died", f"its process ended before it had answered {what}")
        return self.fault("garbage", f"{what} was answered by {type(answer).__name__}")

    def fault(self, kind: str, detail: str, traceback: str = "") -> GuestFault:
        """End the guest, and return the fault to raise."""
        log = self.log
        self.close()
        kind = kind if kind in wire.FAULTS else "garbage"
        return GuestFault(kind, sanitize_text(detail)[: wire.TEXT_MAX], sanitize_text(traceback)[-wire.TEXT_MAX :], log)

    @property
    def log(self) -> str:
        """The last part of the guest's output."""
        return self._log if self.transport is None else self.transport.log

    def release(self) -> None:
        """Give up the transport without ending the guest, which has another user now."""
        if self.transport is not None:
            self._log, self.transport = self.transport.log, None

    def close(self) -> None:
        """End the guest."""
        transport, self.transport = self.transport, None
        if transport is not None:
            self._log = transport.log
            transport.kill()

    def _live_transport(self) -> Transport:
        if self.transport is None:
            raise GuestFault("died", "the agent's process is gone")
        return self.transport


def explain_fault(fault: GuestFault, policy: Policy, root: str) -> GuestFault:
    """The fault, with a sentence of explanation if isolation caused it."""
    more = isolation_reason(fault.detail, policy, root) if fault.kind == "raised" else ""
    if not more:
        return fault
    return GuestFault(fault.kind, f"{fault.detail.rstrip()}\n{more}", "", fault.log)


def isolation_reason(text: str, policy: Policy, root: str) -> str:
    """One sentence on how isolation caused a failure; empty if it did not.

    Args:
        text: the error message, with its traceback if there is one. root: the agent's folder.
    """
    said = _said(text)
    variable = _VARIABLE.match(said)
    if variable and any(word in text for word in _ENVIRONMENT):
        return (
            f"No environment variable of yours reaches an agent, {variable[1]} neither; give it what it needs with "
            "--agent-args. See docs/isolation.md."
        )
    if policy.level == "L1":
        return ""
    hidden = next((path for path in _paths(said, root) if path.exists() and not _shown(path, policy)), None)
    if hidden is None:
        return ""
    if root and hidden.is_relative_to(root):
        return f"'{hidden.name}' is there, but isolation {policy.level} hides runs and .git from every agent."
    what = "folder" if hidden.is_dir() else "file"
    return (
        f"The {what} '{hidden.name}' is there, but isolation {policy.level} hides it, as it lies outside the agent's "
        "own folder. Let the agent read it with --readable PATH. See docs/isolation.md."
    )


def _said(text: str) -> str:
    """The exception's own message, which follows its traceback."""
    lines = text.strip().splitlines()
    frames = [number for number, line in enumerate(lines) if line.startswith(" ")]
    return "\n".join(lines[frames[-1] + 1 if frames else 0 :])


def _paths(said: str, root: str) -> Iterator[Path]:
    for found in _QUOTED.finditer(said):
        text = next(group for group in found.groups() if group)
        if os.path.isabs(text) or (root and os.sep in text):
            yield Path(os.path.normpath(os.path.join(root or "/", text)))


def _shown(path: Path, policy: Policy) -> bool:
    """Whether the agent may read this path."""
    real = path.resolve()
    return any(one.is_relative_to(place) for one in (path, real) for place in (*policy.read, policy.scratch))
