"""Floor plans as data: load a house by name or from a file, check it. Begin with `library.HouseLibrary`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hthor.houses.library import HouseLibrary, load, names

if TYPE_CHECKING:
    from hthor.houses.checks.house_checks import check

__all__ = ["HouseLibrary", "check", "load", "names"]


def __getattr__(name: str) -> Any:
    # The checks compile their grids, so they are imported only when they are used.
    if name == "check":
        from hthor.houses.checks.house_checks import check

        return check
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
