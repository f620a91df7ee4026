"""Objects that are pickled as they were made: another process makes a new one with the same arguments."""

import functools
from typing import Any


class Remade:
    """An environment's world is in the memory of the physics engine; so a copy is a new environment, not yet reset."""

    def __new__(cls, *args: Any, **named: Any) -> Any:
        made: Any = super().__new__(cls)
        made._made_with = (args, named)
        return made

    def __reduce__(self) -> Any:
        args, named = self._made_with  # type: ignore[attr-defined]
        return functools.partial(type(self), **named), args
