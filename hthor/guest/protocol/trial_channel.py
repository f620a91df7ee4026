"""The pipes and shared memory between host and guest, made for one trial and closed after it.

Whatever an agent does to them, such as writing into a pipe's other end, ends with its trial.
"""

import contextlib
import fcntl
import os
import socket

from hthor.guest.protocol import shared_frames

_PIPE_BYTES = 1 << 20
_F_SETPIPE_SZ = 1031
_SIGN = b"c"


class HostEnds:
    """The host's ends.

    Attributes:
        out: pipe to the trial's process. words: pipe with its messages. err: pipe with what it prints.
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
        """Send the guest's ends to the supervisor; if that has ended, it is noticed elsewhere."""
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


class GuestEnds:
    """The guest's ends.

    Attributes:
        read: pipe from the host. write: pipe to it. printed: pipe for output.
        shared: shared memory for pictures, -1 for none.
    """

    def __init__(self, read: int, write: int, printed: int, shared: int = -1) -> None:
        self.read, self.write, self.printed, self.shared = read, write, printed, shared

    @property
    def handles(self) -> tuple[int, ...]:
        """All of them."""
        every = (self.read, self.write, self.printed, self.shared)
        return tuple(handle for handle in every if handle >= 0)

    def send_copies(self, line: socket.socket) -> None:
        """Send copies of them to another process.

        Raises:
            BrokenPipeError: when it has ended.
        """
        socket.send_fds(line, [_SIGN], self.handles)

    def close(self) -> None:
        """Close them."""
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
