"""The command of a live session, as a process."""

from __future__ import annotations

import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

SERVER = str(Path(__file__).with_name("live_server.py"))


class Command:
    """The command of a session in a folder, which may be killed and started once more; a context manager."""

    def __init__(self, folder: Path, faster: float = 40.0, **options: object) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self._port = free.getsockname()[1]
        words = [f"{name}={value}" for name, value in options.items()]
        self._words = [sys.executable, SERVER, str(folder), str(self._port), str(faster), *words]
        self._errors = folder.with_suffix(".txt")
        self._process: subprocess.Popen[str] | None = None

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self._port}"

    @property
    def said(self) -> str:
        """What all starts have said."""
        return self._errors.read_text()

    def __enter__(self) -> Command:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.kill()

    def start(self) -> None:
        """Run the command until it serves; its token is then in ``token``."""
        with self._errors.open("a") as errors:
            self._process = subprocess.Popen(self._words, stdout=subprocess.PIPE, stderr=errors, text=True)
        assert self._process.stdout is not None
        self.token = self._process.stdout.readline().strip()
        assert self.token, self.said

    def kill(self) -> None:
        """SIGKILL, if it still runs."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            assert self._process.stdout is not None
            self._process.stdout.close()
            self._process = None

    def wait_until(self, done: Callable[[], bool], seconds: float = 120.0) -> None:
        """Wait until something is so, while the command runs."""
        end = time.monotonic() + seconds
        while not done():
            assert self._process is not None
            assert self._process.poll() is None, self.said
            assert time.monotonic() < end
            time.sleep(0.01)

    def finish(self) -> None:
        """Wait for the end of the session."""
        assert self._process is not None
        assert self._process.wait(120.0) == 0, self.said
