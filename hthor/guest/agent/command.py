"""An agent that is a command: its words, the files that they name, and their hash."""

import hashlib
import os
import shlex
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from hthor.errors import AgentError
from hthor.guest.agent import digests

_SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib64", sys.prefix, sys.base_prefix)
_ENV = ("/usr/bin/env", "/bin/env")


def parse_command(text: str) -> tuple[str, ...]:
    """The words of a command as it will be started, with absolute paths of the program and of files.

    A script that names its interpreter by ``env`` gets the interpreter in front: a confined program cannot start it.

    Raises:
        AgentError: when it cannot be read, or there is no such program.
    """
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise AgentError(
            f"agent 'cmd:{text}': {error}. Write it as in a shell, such as cmd:'node my_agent.js'."
        ) from None
    if not words:
        raise AgentError("agent 'cmd:' names no program. Write cmd:PROGRAM ARGS, such as 'cmd:node my_agent.js'.")
    return (*_found(words[0], text), *(os.path.abspath(word) if Path(word).is_file() else word for word in words[1:]))


def _found(program: str, text: str) -> list[str]:
    path = shutil.which(program)
    if path is None:
        reason = "is not executable (chmod +x)" if Path(program).is_file() else "was not found"
        raise AgentError(f"agent 'cmd:{text}': the program '{program}' {reason}.")
    path = os.path.abspath(path)
    try:
        with open(path, "rb") as file:
            first = file.readline(256)
    except OSError:
        return [path]
    line = first[2:].decode(errors="replace").split() if first.startswith(b"#!") else []
    if not line or line[0] not in _ENV:
        return [path]
    rest = line[2:] if line[1:2] == ["-S"] else line[1:]
    if not rest or rest[0].startswith("-") or "=" in rest[0]:
        raise AgentError(f"{path}: its first line must name an interpreter: '#!/usr/bin/env NAME', got {first!r}.")
    return [*_found(rest[0], text), *rest[1:], path]


def own_files(words: Sequence[str]) -> list[Path]:
    """The files of a command that do not come with the machine or with this Python."""
    files = [Path(word) for word in words if os.path.isabs(word) and Path(word).is_file()]
    return [path for path in files if not _comes_with_the_machine(path)]


def _comes_with_the_machine(path: Path) -> bool:
    """Whether a program is in a folder of the system or of this Python, or links to such a program."""
    return any(place.is_relative_to(root) for place in (path, path.resolve()) for root in _SYSTEM)


def command_sha256(words: Sequence[str]) -> str:
    """Hash of the words, without folders, and of the own files, or else of the program.

    Raises:
        AgentError: when a file cannot be read.
    """
    own = own_files(words) or [Path(words[0])]
    parts = [*(_bare(word) for word in words), *(digests.file_sha256(path) for path in own)]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def as_text(words: Sequence[str]) -> str:
    """The command as one text, for `parse_command`."""
    return "cmd:" + shlex.join(words)


def as_source(words: Sequence[str]) -> str:
    """The command without folders of this machine, for results."""
    return "cmd:" + shlex.join(_bare(word) for word in words)


def _bare(word: str) -> str:
    return Path(word).name if os.path.isabs(word) else word
