"""Finding plug-ins by file name: one file in a package is one plug-in; knows nothing of what they are."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from hthor.errors import HthorError, UnknownName

_PACKAGES = {
    "agent": ("hthor.agents", "Agent"),
    "human model": ("hthor.humans.models", "Model"),
    "robot": ("hthor.world.robots", "SPEC"),
    "task kind": ("hthor.tasks.kinds", "KIND"),
}


def names(sort: str) -> tuple[str, ...]:
    """The names of every plug-in of a sort, without importing any.

    Args:
        sort: "agent", "human model", "robot" or "task kind".
    """
    package, _ = _PACKAGES[sort]
    folder = Path(__file__).parent.joinpath(*package.split(".")[1:])
    return tuple(sorted(path.stem for path in folder.glob("*.py") if not path.stem.startswith("_")))


def load(sort: str, name: str) -> Any:
    """The plug-in's class or record.

    Raises:
        UnknownName: when no file has that name.
        HthorError: when the file does not define what its sort asks for.
    """
    package, attribute = _PACKAGES[sort]
    known = names(sort)
    if name not in known:
        raise UnknownName(sort, name, known)
    module = importlib.import_module(f"{package}.{name}")
    try:
        return getattr(module, attribute)
    except AttributeError:
        raise HthorError(f"{module.__file__}: a {sort} file must define '{attribute}'.") from None
