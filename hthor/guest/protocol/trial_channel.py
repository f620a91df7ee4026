"""The pipes and shared memory between host and guest, made for one trial and closed after it.

Whatever an agent does to them, such as writing into a pipe's other end, ends with its trial.
"""

import contextlib
import fcntl
import os
import socket
from typing import NamedTuple, NoReturn

import msgspec

from hthor.guest.protocol import shared_frames, wire

_PIPE_BYTES = 1 << 20
_F_SETPIPE_SZ = 1031
_SIGN = b"c"
_hosts_words = msgspec.msgpack.Decoder(wire.ToGuest)


class HostEnds:
    """The host's ends.

    Attributes:
        out: pipe to the trial's process. words: pipe with its messages. err: pipe with its output.
        frames: shared memory for pictures.
    """

    def __init__(self) -> None:
        read, self.out = os.pipe()
        self.words, write = os.pipe()
        self.err, printed = os.pipe()
        self.frames = shared_frames.open_frames()
        self._far: tuple[int, ...] = (read, write, printed)
        for handle in (self.out, self.words, self.err):
            os.set_blocking(handle, False)
        with contextlib.suppress(OSError):  # only speed depends on it
            fcntl.fcntl(self.out, _F_SETPIPE_SZ, _PIPE_BYTES)

    def send_far_ends(self, line: socket.socket) -> None:
        """Send the guest's ends to the supervisor; if it has ended, another function notices that."""
        shared = (self.frames.handle,) if self.frames is not None else ()
        with contextlib.suppress(OSError):
            socket.send_fds(line, [_SIGN], [*self._far, *shared])
        self._let_go()

    def close(self) -> None:
        """Close all ends that this process has."""
        for handle in (self.out, self.words, self.err):
            os.close(handle)
        self._let_go()
        if self.frames is not None:
            self.frames.close()

    def _let_go(self) -> None:
        far, self._far = self._far, ()
        for handle in far:
            os.close(handle)


class GuestEnds(NamedTuple):
    """The guest's ends: pipes from the host, to it and for output, and shared memory for pictures, -1 for none."""

    read: int
    write: int
    printed: int
    shared: int = -1

    @property
    def handles(self) -> tuple[int, ...]:
        """The file descriptors of all ends that exist."""
        return tuple(handle for handle in self if handle >= 0)

    def send_copies(self, line: socket.socket) -> None:
        """Send copies to another process; BrokenPipeError when it has ended."""
        socket.send_fds(line, [_SIGN], self.handles)

    def close(self) -> None:
        """Close the guest's ends."""
        for handle in self.handles:
            os.close(handle)


def receive_ends(line: socket.socket) -> GuestEnds | None:
    """Wait for the guest's ends on a socket; None when it is closed.

    Other bytes on the socket were meant for the previous trial, and are skipped.
    """
    while True:
        try:
            said, handles, *_ = socket.recv_fds(line, 1, 4, socket.MSG_CMSG_CLOEXEC)
        except ConnectionResetError:
            return None
        if handles:
            return GuestEnds(*handles)
        if not said:
            return None


class HostPipe:
    """Messages over pipes. Reads exactly one message at a time, so that a fork inherits no half-read message."""

    def __init__(self, read: int, write: int, shared: int = -1) -> None:
        self._read, self._write = read, write
        self.handles, self.shared = (read, write), shared
        self.view = shared_frames.FrameReader(shared) if shared >= 0 else None

    def receive(self) -> wire.ToGuest:
        """The host's next message; ends the process when the host has closed the pipe."""
        size = int.from_bytes(self._exactly(4), "little")
        message: wire.ToGuest = _hosts_words.decode(self._exactly(size))
        return message

    def send(self, message: wire.ToHost | wire.SupervisorToHost) -> None:
        data = memoryview(wire.frame(message))
        while data:
            data = data[os.write(self._write, data) :]

    def fail(self) -> NoReturn:
        """The host has broken the protocol: end the process."""
        os._exit(1)

    def _exactly(self, size: int) -> bytes:
        chunks = []
        while size:
            chunk = os.read(self._read, min(size, 1 << 20))
            if not chunk:
                os._exit(0)
            chunks.append(chunk)
            size -= len(chunk)
        return b"".join(chunks)
