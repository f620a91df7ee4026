"""Shared memory for pictures: the host writes, the guest can only read.

The memory has no name and a fixed size; seals allow changes only through the host's own mapping. A picture stays
until the next step, so the guest takes a copy.
"""

import fcntl
import mmap
import os
import sys
from typing import Any

import numpy as np

SIZE = 4 << 20
"""Size of the memory [bytes]; a picture that does not fit is sent in a message."""
VARIABLE = "HTHOR_FRAMES"
"""Environment variable with the number of the guest's file descriptor for this memory."""
_ADD_SEALS, _SEAL, _SHRINK, _GROW, _FUTURE_WRITE = 1033, 1, 2, 4, 16
_ALIGN = 64
_KINDS = "biuf"
"""Kinds of arrays: boolean, integer, unsigned, float."""


class FrameWriter:
    """The host's end."""

    def __init__(self) -> None:
        self.handle = os.memfd_create("hthor-frames", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
        try:
            os.ftruncate(self.handle, SIZE)
            self._memory = mmap.mmap(self.handle, SIZE)
            fcntl.fcntl(self.handle, _ADD_SEALS, _SHRINK | _GROW | _FUTURE_WRITE | _SEAL)
        except OSError:
            os.close(self.handle)
            raise
        self._whole = np.frombuffer(self._memory, np.uint8)
        self._at = self._most = 0

    def clear(self) -> None:
        """Start a step: earlier pictures may be overwritten."""
        self._at = 0

    def wipe(self) -> None:
        """Start a trial: erase everything of the previous one."""
        self._whole[: self._most] = 0
        self._at = self._most = 0

    def put(self, array: Any) -> dict[str, Any] | None:
        """Store an array; the reference to it for a message, or None when it does not fit."""
        if not isinstance(array, np.ndarray) or array.dtype.kind not in _KINDS or self._at + array.nbytes > SIZE:
            return None
        at, end = self._at, self._at + array.nbytes
        self._whole[at:end].view(array.dtype).reshape(array.shape)[...] = array
        self._at = -(-end // _ALIGN) * _ALIGN
        self._most = max(self._most, end)
        return {"__nd__": array.dtype.str, "s": list(array.shape), "at": at}

    def close(self) -> None:
        """Close the memory."""
        os.close(self.handle)


def open_frames() -> FrameWriter | None:
    """New memory; None if the system does not support it."""
    if sys.platform != "linux":
        return None
    try:
        return FrameWriter()
    except OSError:
        return None


class FrameReader:
    """The guest's end, which can only read."""

    def __init__(self, handle: int) -> None:
        self._memory = memoryview(mmap.mmap(handle, SIZE, mmap.MAP_SHARED, mmap.PROT_READ))

    def take(self, value: dict[str, Any]) -> Any:
        """A copy of the array that a message refers to."""
        shape, dtype = value["s"], np.dtype(value["__nd__"])
        count = 1
        for length in shape:
            count *= length
        array = np.frombuffer(self._memory, dtype, count, value["at"]).reshape(shape).copy()
        array.flags.writeable = False
        return array
