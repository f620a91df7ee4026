"""The hashes of code that a result depends on: of trials, scoring, agents, robots, pictures, and of making tasks; and
the folder in which numba caches compiled functions of exactly this code.
"""

import contextlib
import functools
import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from hthor import installation, jsonio, plugins
from hthor.code_identity.sources import ours
from hthor.code_identity.syntax import PICTURES, SIMULATION, TOOLS

_TRIAL, _SCORING, _MAKERS = "trial", "scoring", "makers"
_HEX = 64
"""Number of letters of a hash."""


def code_sha256(models: Iterable[str], kinds: Iterable[str]) -> str:
    """Hash of the code that can change a trial: world, episode, human model, task kinds, records.

    Robots have hashes of their own: `agent_sha256`, `robot_sha256`, `pictures_sha256`. So has what can only change how
    a trial is judged: `scoring_sha256`.

    Args:
        models: the human models; a user's own model counts as all built-in ones, which it may use.
        kinds: the task kinds, with the same rule.
    """
    own = [name for model in dict.fromkeys(models) for name in _modules("human model", model)]
    own += [name for kind in set(kinds) for name in _modules("task kind", kind)]
    return modules_sha256([*roots(_TRIAL), *own])


@functools.cache
def scoring_sha256() -> str:
    """Hash of the code that judges trials from their logs: all metrics, which attempts count, corrections, statistics.

    It also covers all that these import, such as the benchmark's constants and the kinds of events. A change of it
    changes no trial: results are computed again from the logs.
    """
    metrics = [plugins.module_name("metric", name) for name in plugins.names("metric")]
    return modules_sha256([*roots(_SCORING), *metrics])


def agent_sha256(name: str) -> str:
    """Hash of the code of an agent that ships with hthor."""
    return modules_sha256([plugins.module_name("agent", name)])


def robot_sha256(name: str) -> str:
    """Hash of the code of a robot's body that ships with hthor."""
    return modules_sha256([plugins.module_name("robot", name)])


def pictures_sha256(pack: str = "") -> str:
    """Hash of the code that draws robots' camera images, and of a furniture pack (by its own hash ``pack``)."""
    code = modules_sha256(roots(_TRIAL), (SIMULATION, PICTURES))
    return jsonio.sha256([pack, code]) if pack else code


def makers_sha256() -> str:
    """Hash of the code that makes and checks houses and tasks."""
    kinds = [plugins.module_name("task kind", name) for name in plugins.names("task kind")]
    return modules_sha256([*roots(_MAKERS), *kinds], (SIMULATION, TOOLS))


def roots(of: str) -> list[str]:
    """Names of the modules that say ``CODE_ROOT = "OF"``, such as "trial"."""
    return ours().roots(of)


def modules_sha256(names: Sequence[str], parts: Sequence[str] = (SIMULATION,)) -> str:
    """Hash of modules of hthor and of all that they import, as `Sources.sha256`.

    The hash is cached under the bytes of all source files, as computing it takes a second.
    """
    place = installation.cache() / "code" / jsonio.sha256([installation.sha256(), sorted(set(names)), sorted(parts)])
    try:
        cached = place.read_text(encoding="ascii")
    except (OSError, UnicodeDecodeError):
        cached = ""
    if len(cached) == _HEX:
        return cached
    digest = ours().sha256(names, parts)
    with contextlib.suppress(OSError):  # without a writable cache it is computed every time
        jsonio.write(place, digest.encode("ascii"))
    return digest


def _modules(sort: str, name: str) -> list[str]:
    """The module of a built-in plug-in; for a user's own plug-in, all built-in ones of its sort, which it may use."""
    names = [name] if plugins.is_built_in(sort, name) else plugins.names(sort)
    return [plugins.module_name(sort, one) for one in names]


def compiled() -> Path:
    """The folder, in the user's cache, for compiled functions of exactly this code.

    By itself, numba's cache checks only the file of a function, not those of the functions that it calls: after an
    update it could silently run old code.
    """
    kernels = modules_sha256(ours().containing(b"import numba"), (SIMULATION, PICTURES, TOOLS))
    return installation.cache() / f"compiled-{kernels[:16]}"


def is_compiled() -> bool:
    """Whether an earlier process of exactly this code has compiled functions, so that those to come start at once."""
    folder = Path(os.environ.get("NUMBA_CACHE_DIR") or compiled())
    return any(folder.rglob("*.nbi"))  # numba's index files; it makes folders before it compiles


def keep_compiled() -> None:
    """Make this process and its children cache compiled functions in `compiled`, unless the user chose a folder.

    Call it before trials run: without it every process, also of an agent, compiles for 20 s.
    """
    if "NUMBA_CACHE_DIR" not in os.environ:
        os.environ["NUMBA_CACHE_DIR"] = str(compiled())
