"""Hashes of agents' files."""

import errno
import hashlib
import os
import time
from pathlib import Path

from hthor.errors import AgentError

_Sign = tuple[int, int, int, int, int]
_SETTLED_NS = 2_000_000_000
"""A file that was written so recently may be written again without a change of its times."""
_known: dict[str, tuple[_Sign, str]] = {}


def file_sha256(path: Path) -> str:
    """The hash of a file's bytes.

    Raises:
        AgentError: when it cannot be read.
    """
    try:
        return hash_file(path)[0]
    except OSError as error:
        hint = "Write one to start from: hthor agent new my_agent.py"
        raise AgentError(f"cannot read the agent's file {path}: {error.strerror}. {hint}") from None


def hash_file(path: Path) -> tuple[str, int]:
    """The hash of a file's bytes, and their number; cached while the file's inode, size and times stay the same.

    Raises:
        OSError: when it cannot be read, or is not a file.
    """
    if path.exists() and not path.is_file():  # reading it might never end
        raise OSError(errno.EINVAL, "it is no file")
    with path.open("rb") as file:
        found = os.fstat(file.fileno())
        sign = (found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns)
        before = _known.get(str(path))
        if before is not None and before[0] == sign:
            return before[1], found.st_size
        digest = hashlib.file_digest(file, "sha256").hexdigest()
        if time.time_ns() - max(found.st_mtime_ns, found.st_ctime_ns) > _SETTLED_NS:
            _known[str(path)] = sign, digest
        else:
            _known.pop(str(path), None)
        return digest, found.st_size
