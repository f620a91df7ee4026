"""Canonical JSON, hashes of content, and atomic writes."""

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec

_canonical = msgspec.json.Encoder(order="sorted")


def canonical(document: Any) -> bytes:
    """Encode as JSON with sorted keys and no white space; equal documents give equal bytes."""
    return _canonical.encode(document)


def pretty(document: Any) -> bytes:
    """Encode as readable JSON: sorted keys, indented by two spaces, with a newline at the end."""
    return msgspec.json.format(canonical(document), indent=2) + b"\n"


def sha256(document: Any) -> str:
    """Hash of the canonical encoding, 64 hexadecimal digits."""
    return hashlib.sha256(canonical(document)).hexdigest()


def is_text(value: str) -> bool:
    """Whether a text can be encoded; file names and JSON escapes can hold lone surrogates, which cannot."""
    try:
        value.encode()
    except UnicodeEncodeError:
        return False
    return True


def write(path: Path, data: bytes) -> None:
    """Replace a file in one step: a reader sees the old content or the new content, never a part."""
    write_parts(path, (data,))


def write_parts(path: Path, parts: Iterable[bytes]) -> None:
    """Replace a file, like `write`, by these parts in order, of which only one need be in memory."""
    make_folder(path.parent)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.writelines(parts)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException as error:
        Path(name).unlink(missing_ok=True)
        if isinstance(error, OSError) and not error.filename:  # so that the message names the full disk's file
            error.filename = str(path)
        raise
    sync_folder(path.parent)


def make_folder(folder: Path) -> None:
    """Make a folder and its parents, durably: they survive a loss of power."""
    above = [*reversed(folder.parents), folder]
    new = [one for one in above if not one.is_dir()]
    folder.mkdir(parents=True, exist_ok=True)
    for one in new:
        sync_folder(one.parent)


def sync_folder(folder: Path) -> None:
    """Write the folder's list of files to the disk; without it new files can be lost with the power."""
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        with contextlib.suppress(OSError):  # some network file systems do not support it
            os.fsync(handle)
    finally:
        os.close(handle)
