"""Hashes of agents' files; knows nothing of what is in them."""

from __future__ import annotations

import errno
import hashlib
from pathlib import Path

from hthor.errors import AgentError


def of_file(path: Path) -> str:
    """The hash of a file's bytes.

    Raises:
        AgentError: when it cannot be read.
    """
    try:
        if path.exists() and not path.is_file():  # which could be read without end, or never
            raise OSError(errno.EINVAL, "it is no file")
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        hint = "Write one to start from: hthor agent new my_agent.py"
        raise AgentError(f"cannot read the agent's file {path}: {error.strerror}. {hint}") from None
