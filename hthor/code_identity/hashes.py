"""Hashes of the code that a result depends on: of trials, agents, robots, pictures, and of what makes tasks."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Sequence

from hthor import installation, jsonio, plugins
from hthor.code_identity import sources
from hthor.code_identity.syntax import PICTURES, SIMULATION, TOOLS

_TRIAL, _MAKERS = "trial", "makers"
_HEX = 64
"""Letters of a hash."""


def code_sha256(model: str, kinds: Iterable[str]) -> str:
    """Hash of the code that plays trials and measures them: world, episode, people, kinds of task, records, metrics.

    What robots bring counts apart: `agent_sha256`, `robot_sha256`, `pictures_sha256`.

    Args:
        model: the human model; one of the user's own may use every one of ours, and so may a kind.
        kinds: the kinds of task.
    """
    own = [*_modules("human model", model), *(name for kind in set(kinds) for name in _modules("task kind", kind))]
    metrics = [plugins.module_name("metric", name) for name in plugins.names("metric")]
    return modules_sha256([*roots(_TRIAL), *metrics, *own])


def agent_sha256(name: str) -> str:
    """Hash of the code of an agent that ships with hthor."""
    return modules_sha256([plugins.module_name("agent", name)])


def robot_sha256(name: str) -> str:
    """Hash of a robot's body that ships with hthor."""
    return modules_sha256([plugins.module_name("robot", name)])


def pictures_sha256(pack: str = "") -> str:
    """Hash of what draws what robots' cameras show: of the code, and of a furniture pack by its own hash."""
    code = modules_sha256(roots(_TRIAL), (SIMULATION, PICTURES))
    return jsonio.sha256([pack, code]) if pack else code


def makers_sha256() -> str:
    """Hash of the code that makes houses and tasks, and proves them sound."""
    kinds = [plugins.module_name("task kind", name) for name in plugins.names("task kind")]
    return modules_sha256([*roots(_MAKERS), *kinds], (SIMULATION, TOOLS))


def roots(of: str) -> list[str]:
    """Names of the modules where something begins, as they say of themselves: ``CODE_ROOT = "trial"``."""
    return sources.ours().roots(of)


def modules_sha256(names: Sequence[str], parts: Sequence[str] = (SIMULATION,)) -> str:
    """Hash of modules of hthor and of all that they import, as `Sources.sha256` has it.

    It is kept for the next time, as reading them takes a second.
    What is kept goes by the bytes of every source file.
    """
    place = installation.cache() / "code" / jsonio.sha256([installation.sha256(), sorted(set(names)), sorted(parts)])
    try:
        held = place.read_text(encoding="ascii")
    except (OSError, UnicodeDecodeError):
        held = ""
    if len(held) == _HEX:
        return held
    made = sources.ours().sha256(names, parts)
    with contextlib.suppress(OSError):  # in a home that cannot be written it is worked out again the next time
        jsonio.write(place, made.encode("ascii"))
    return made


def _modules(sort: str, name: str) -> list[str]:
    """The module of a plug-in; of the user's own, all that it may build on."""
    return [
        plugins.module_name(sort, one) for one in ([name] if plugins.is_built_in(sort, name) else plugins.names(sort))
    ]
