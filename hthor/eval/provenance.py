"""What can move a score, as hashes and version numbers; knows nothing of trials."""

from __future__ import annotations

import functools
import hashlib
import os
import platform
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
_ABOVE = ("cli", "__main__.py", "leaderboard", "eval", "calibration")
_HASHED_BY_CONTENT = (  # each trial names those of its own house, suite and people
    *("houses/data", "houses/unseen", "tasks/suites", "humans/populations"),
)
_COUNTED = tuple(
    f"eval/{name}.py" for name in ("cast", "channel", "deeds", "hindrance", "metrics")
)  # these decide trials' worth
_SUFFIXES = (".py", ".json", ".txt", ".xml", ".csv")


@functools.cache
def code_sha256() -> str:
    """Hash of every file of the package that can move a trial's course or its metrics."""
    digest = hashlib.sha256()
    for path in _files():
        data = path.read_bytes()
        digest.update(f"{path.relative_to(PACKAGE).as_posix()} {len(data)}\n".encode())
        digest.update(data)
    return digest.hexdigest()


def compiled() -> Path:
    """Where compiled loops of exactly this code are kept, in the user's cache.

    Left to itself the compiler's cache looks only at the file of the loop it is asked for, not at those that the loop
    calls into: after an update it could run old code, and nothing would tell.
    """
    return cache() / f"compiled-{code_sha256()[:16]}"


def cache() -> Path:
    """hthor's folder in the user's cache; what lies there can be deleted at any time."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "hthor"


def keep_compiled() -> None:
    """Have this process, and those that it starts, keep compiled loops in `compiled`, unless the user chose a place.

    Whatever plays trials calls this first: without it every process, the agents' too, compiles for 20 s.
    """
    os.environ.setdefault("NUMBA_CACHE_DIR", str(compiled()))


def _files() -> Iterator[Path]:
    for path in sorted(PACKAGE.rglob("*")):
        name = path.relative_to(PACKAGE).as_posix()
        if path.suffix in _SUFFIXES and (name in _COUNTED or not _left_out(name)):
            yield path


def _left_out(name: str) -> bool:
    folders = name.split("/")
    return folders[0] in _ABOVE or "__pycache__" in folders or any(name.startswith(f"{f}/") for f in _HASHED_BY_CONTENT)


def versions() -> dict[str, str]:
    """Versions of hthor, of Python and of the libraries that compute, without importing them."""
    found = {name: metadata.version(name) for name in ("mujoco", "dm_control", "numba", "numpy")}
    from hthor import __version__

    return {"hthor": __version__, "python": platform.python_version(), **found}
