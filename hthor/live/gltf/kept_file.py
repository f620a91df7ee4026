"""Files that take long to make, and are made once."""

from __future__ import annotations

import fcntl
from collections.abc import Callable
from pathlib import Path

from hthor import jsonio


def kept_file(path: Path, make: Callable[[], bytes]) -> bytes:
    """The content of a file, made unless it is there; one process makes it, and others that want it wait for that."""
    if not path.exists():
        jsonio.make_folder(path.parent)
        lock = path.with_name(f"{path.name}.lock")
        with lock.open("w") as handle:
            fcntl.flock(handle, fcntl.LOCK_EX)
            if not path.exists():
                jsonio.write(path, make())
            lock.unlink(missing_ok=True)
    return path.read_bytes()
