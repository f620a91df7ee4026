"""Records which of its own files an agent opens, in the agent's own process.

An agent can evade this, and libraries in C open files unnoticed. So the host hashes the files itself and adds those
that the sources name; for a submission, all submitted files count.
"""

import errno
import os
import sys
from collections.abc import Callable
from typing import Any

from hthor.guest.agent.agent_paths import AgentPaths

BATCH_BYTES = 16 << 10
"""Most bytes of names in one message; the other names follow in later messages."""


class UnprintableName(PermissionError):
    """The agent may not open this file of its own, because a manifest cannot list its name."""


class FileRecorder:
    """Records the agent's own files that are opened for reading after `start`, each once."""

    def __init__(self, paths: AgentPaths) -> None:
        self._paths = paths
        self._seen: set[str] = set()
        self._fresh: list[str] = []
        self._readers: dict[str, Callable[[Any], object]] = {
            "open": self._open,
            "import": lambda args: self._note(args[1]),
            "sqlite3.connect": lambda args: self._note(_database(args[0])),
            "ctypes.dlopen": lambda args: self._note(args[0]),
            "subprocess.Popen": lambda args: self._words(args[0], args[1]),
            "os.exec": lambda args: self._words(args[0], args[1]),
            "os.posix_spawn": lambda args: self._words(args[0], args[1]),
        }

    def start(self) -> None:
        """Record from now on, as long as this process lives."""
        sys.addaudithook(self._hear)

    @property
    def waiting(self) -> bool:
        """Whether there are names that `take` has not returned yet."""
        return bool(self._fresh)

    def take(self) -> tuple[str, ...]:
        """Names that have not been returned yet, as many as fit into a message."""
        if not self._fresh:
            return ()
        size, count = 0, 0
        for name in self._fresh:
            size += len(name.encode(errors="replace")) + 4
            if count and size > BATCH_BYTES:
                break
            count += 1
        taken, self._fresh = self._fresh[:count], self._fresh[count:]
        return tuple(taken)

    def _hear(self, event: str, args: Any) -> None:
        read = self._readers.get(event)
        if read is not None:
            try:
                read(args)
            except UnprintableName:
                raise
            except Exception:  # odd arguments are for the call itself to refuse
                return

    def _open(self, args: Any) -> None:
        path, _, flags = args
        if not isinstance(flags, int) or flags & os.O_ACCMODE != os.O_WRONLY:
            self._note(path)

    def _words(self, program: Any, words: Any) -> None:
        for word in (program, *([words] if isinstance(words, (str, bytes)) else words or ())):
            self._note(word)

    def _note(self, path: Any) -> None:
        if path is None or isinstance(path, int):
            return
        text = os.path.abspath(os.fsdecode(path))
        if text in self._seen:
            return
        self._seen.add(text)
        name = self._paths.name(text)
        if name is None or not os.path.isfile(text):
            return
        if not name.isprintable():
            self._seen.discard(text)  # refused every time
            raise UnprintableName(errno.EPERM, "an agent's own file needs a name of printable letters", text)
        self._fresh.append(name)


def _database(name: Any) -> Any:
    text = os.fsdecode(name)
    return text[len("file:") :].partition("?")[0] if text.startswith("file:") else text
