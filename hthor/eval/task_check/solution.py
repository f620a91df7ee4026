"""How a person who knows everything solved a task."""

from msgspec import Struct

from hthor.types import Vec2


class Solution(Struct, frozen=True, kw_only=True):
    """The result: whether the goal was met, the time [s], the length of the walk [m], and why the goal was not met.

    ``way`` [m] is the walk with all its bends, from the start.
    """

    met: bool
    seconds: float
    metres: float
    reason: str = ""
    way: tuple[Vec2, ...] = ()
