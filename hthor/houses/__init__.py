"""Floor plans as data: load a house, judge it."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

from hthor.houses.loader import load, names, shelve, shelves

if TYPE_CHECKING:
    from hthor.houses.checks.check import check

__all__ = ["check", "load", "names", "shelve", "shelves"]


class _Houses(ModuleType):
    """Keeps ``houses.check`` the function: loading the submodule of that name would put the module in its place."""

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value.check if name == "check" and isinstance(value, ModuleType) else value)

    def __getattr__(self, name: str) -> Any:
        # The check compiles its grids, so it is imported only when asked for.
        if name == "check":
            from hthor.houses.checks.check import check

            return check
        raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")


sys.modules[__name__].__class__ = _Houses
