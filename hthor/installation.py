"""This installation of hthor: one hash of its files, its versions, and its cache."""

import functools
import hashlib
import os
import platform
from importlib import metadata
from pathlib import Path

from hthor import __version__

PACKAGE = Path(__file__).resolve().parent


@functools.cache
def sha256() -> str:
    """Hash of every source file of the package, comments included."""
    digest = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*.py")):
        data = path.read_bytes()
        digest.update(f"{path.relative_to(PACKAGE).as_posix()} {len(data)}\n".encode())
        digest.update(data)
    return digest.hexdigest()


def cache() -> Path:
    """hthor's folder in the user's cache; its content can be deleted at any time."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "hthor"


def versions() -> dict[str, str]:
    """Versions of hthor, of Python and of the libraries that compute, without importing them."""
    libraries = {name: metadata.version(name) for name in ("mujoco", "dm_control", "numba", "numpy")}
    return {"hthor": __version__, "python": platform.python_version(), **libraries}
