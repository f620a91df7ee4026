"""What can move a score, as hashes and version numbers; knows nothing of trials."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import platform
from collections.abc import Iterable, Sequence
from importlib import metadata
from pathlib import Path

from hthor import code_identity, jsonio, plugins
from hthor.code_identity import PACKAGE, PICTURES, SIMULATION, TOOLS

_COMPILER = b"import numba"
_HEX = 64
"""Letters of a hash."""


def code_sha256(model: str, kinds: Iterable[str]) -> str:
    """Hash of the code that plays trials and measures them: world, episode, people, kinds of task, records, metrics.

    What robots bring counts apart: `agent_sha256`, `robot_sha256`, `pictures_sha256`.

    Args:
        model: the human model; one of the user's own may use every one of ours, and so may a kind.
        kinds: the kinds of task.
    """
    from hthor.eval import cast, metrics, record

    own = [*_modules("human model", model), *(name for kind in set(kinds) for name in _modules("task kind", kind))]
    return hashed([cast.__name__, metrics.__name__, record.__name__, *own])


def agent_sha256(name: str) -> str:
    """Hash of the code of an agent that ships with hthor."""
    return hashed([plugins.module("agent", name)])


def robot_sha256(name: str) -> str:
    """Hash of a robot's body that ships with hthor."""
    return hashed([plugins.module("robot", name)])


def pictures_sha256(pack: str = "") -> str:
    """Hash of what draws what robots' cameras show: of the code, and of a furniture pack by its own hash."""
    from hthor.eval import cast

    code = hashed([cast.__name__], (SIMULATION, PICTURES))
    return jsonio.sha256([pack, code]) if pack else code


def makers_sha256() -> str:
    """Hash of the code that makes houses and tasks, and proves them sound."""
    from hthor import tasks
    from hthor.eval import making, soundness
    from hthor.houses import generator

    roots = [tasks.__name__, making.__name__, soundness.__name__, generator.__name__]
    kinds = [plugins.module("task kind", name) for name in plugins.names("task kind")]
    return hashed([*roots, *kinds], (SIMULATION, TOOLS))


@functools.cache
def installed_sha256() -> str:
    """Hash of every source file of the package: the same installation, down to the comments."""
    digest = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*.py")):
        data = path.read_bytes()
        digest.update(f"{path.relative_to(PACKAGE).as_posix()} {len(data)}\n".encode())
        digest.update(data)
    return digest.hexdigest()


def compiled() -> Path:
    """Where compiled loops of exactly this code are kept, in the user's cache.

    Left to itself the compiler's cache looks only at the file of the loop it is asked for, not at those that the loop
    calls into: after an update it could run old code, and nothing would tell.
    """
    return cache() / f"compiled-{_kernels()[:16]}"


def cache() -> Path:
    """hthor's folder in the user's cache; what lies there can be deleted at any time."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "hthor"


def keep_compiled() -> None:
    """Have this process, and those that it starts, keep compiled loops in `compiled`, unless the user chose a place.

    Whatever plays trials calls this first: without it every process, the agents' too, compiles for 20 s.
    """
    if "NUMBA_CACHE_DIR" not in os.environ:
        os.environ["NUMBA_CACHE_DIR"] = str(compiled())


def versions() -> dict[str, str]:
    """Versions of hthor, of Python and of the libraries that compute, without importing them."""
    found = {name: metadata.version(name) for name in ("mujoco", "dm_control", "numba", "numpy")}
    from hthor import __version__

    return {"hthor": __version__, "python": platform.python_version(), **found}


def _modules(sort: str, name: str) -> list[str]:
    """The module of a plug-in; of the user's own, all that it may build on."""
    return [plugins.module(sort, one) for one in ([name] if plugins.ships(sort, name) else plugins.names(sort))]


@functools.cache
def _kernels() -> str:
    """Hash of the modules that compile loops, and of what they import."""
    sources = [path for path in sorted(PACKAGE.rglob("*.py")) if _COMPILER in path.read_bytes()]
    names = [".".join((PACKAGE.name, *path.relative_to(PACKAGE).with_suffix("").parts)) for path in sources]
    return hashed(names, (SIMULATION, PICTURES, TOOLS))


def hashed(roots: Sequence[str], parts: Sequence[str] = (SIMULATION,)) -> str:
    """Hash of modules of hthor and of all that they import, as `code_identity` has it.

    It is kept for the next time, as reading them takes a second.
    What is kept goes by the bytes of every source file.
    """
    place = cache() / "code" / jsonio.sha256([installed_sha256(), sorted(set(roots)), sorted(parts)])
    try:
        held = place.read_text(encoding="ascii")
    except (OSError, UnicodeDecodeError):
        held = ""
    if len(held) == _HEX:
        return held
    made = code_identity.ours().sha256(roots, parts)
    with contextlib.suppress(OSError):  # in a home that cannot be written it is worked out again the next time
        jsonio.write(place, made.encode("ascii"))
    return made
