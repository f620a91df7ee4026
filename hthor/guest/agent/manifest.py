"""An agent's manifest: a list of its files with hashes, and its arguments."""

import errno
import hashlib
import os
import time
from collections.abc import Iterable
from pathlib import Path

from msgspec import Struct

from hthor import jsonio
from hthor.errors import AgentError

_Sign = tuple[int, int, int, int, int]
_SETTLED_NS = 2_000_000_000
"""[ns] A file changed within this time may change again without new timestamps."""
_known: dict[str, tuple[_Sign, str]] = {}


class File(Struct, frozen=True, kw_only=True, order=True):
    """One file of an agent.

    ``path`` is relative to the agent's folder, with slashes; outside of it (``--readable``) it begins with ``../`` and
    the name of the file or folder that was made readable.
    """

    path: str
    sha256: str
    bytes: int


class Manifest(Struct, frozen=True, kw_only=True):
    """An agent's identity.

    Attributes:
        name, source: as in `AgentRef`.
        sha256: as in `AgentRef`: the hash of source, arguments, files and library; for a served agent, of its server's
            description.
        args: the ``--agent-args``; files appear by their path in ``files``.
        files: sorted by path.
        library: hash of the modules of hthor that its files import, directly or not; empty without Python files.
        claimed: whether the agent's server reports all this, unchecked.
    """

    name: str
    source: str
    sha256: str
    args: dict[str, str] = {}
    files: tuple[File, ...] = ()
    library: str = ""
    claimed: bool = False


def make_manifest(name: str, source: str, args: dict[str, str], files: Iterable[File], library: str = "") -> Manifest:
    """The manifest of an agent that runs here."""
    kept = tuple(sorted(set(files)))
    args = dict(sorted(args.items()))
    sha256 = jsonio.sha256({"source": source, "args": args, "files": kept, "library": library})
    return Manifest(name=name, source=source, sha256=sha256, args=args, files=kept, library=library)


def differences(there: Iterable[File], here: Iterable[File]) -> list[str]:
    """The differences between two lists of files, as short phrases."""
    before, now = ({file.path: file.sha256 for file in files} for files in (there, here))
    words = []
    for path in sorted({*before, *now}):
        if path not in now:
            words.append(f"{path} is gone")
        elif path not in before:
            words.append(f"{path} is new")
        elif before[path] != now[path]:
            words.append(f"{path} has changed")
    return words


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
        raise OSError(errno.EINVAL, "it is not a file")
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
