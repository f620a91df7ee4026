"""The folder that an agent may write to, which every trial finds as the first one did."""

from __future__ import annotations

import contextlib
import os

from hthor.guest.process_tools import cleanup


class ScratchFolder:
    """Keeps the folder.

    Args:
        folder: where it lies, in a folder that this process may change.
    """

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._size = os.stat(folder).st_size
        self.tidy()

    def tidy(self) -> bool:
        """Make it empty, with no sign of when it was changed; true when that took another folder in its place.

        A folder that had many files can stay large when they are gone, which would tell of them.
        """
        cleanup.empty_folder(self._folder)
        outgrown = os.stat(self._folder).st_size != self._size
        if outgrown:
            with contextlib.suppress(OSError):  # at L3 it is a file system of its own, which cannot be replaced
                os.rmdir(self._folder)
                os.mkdir(self._folder, 0o700)
        os.utime(self._folder, (0, 0))
        return outgrown
