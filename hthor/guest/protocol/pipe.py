"""The guest's end of a trial's pipes."""

import os
from typing import NoReturn

import msgspec

from hthor.guest.protocol import shared_frames, wire

_hosts_words = msgspec.msgpack.Decoder(wire.ToGuest)


class HostPipe:
    """Messages over pipes. Reads exactly one message at a time, so that a fork shares nothing half read."""

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
