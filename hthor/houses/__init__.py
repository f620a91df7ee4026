"""Floor plans as data: load a house, judge it; knows nothing of engines, minds or tasks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hthor.houses.loader import load, names

if TYPE_CHECKING:
    from hthor.houses.check import check

__all__ = ["check", "load", "names"]


def __getattr__(name: str) -> Any:
    # The check compiles its grids, so it is imported only when asked for.
    if name == "check":
        from hthor.houses.check import check

        globals()["check"] = check
        return check
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
