"""How strongly a guest is held, as a record of what is in force."""

from __future__ import annotations

from msgspec import Struct

from hthor.errors import HthorError, UnknownName

LEVELS = ("L1", "L2", "L3")
"""From weak to strong: a process; plus Landlock and seccomp; plus namespaces."""
SERVED = "served"
"""In place of a level: the agent runs elsewhere, and what holds it there is not known here."""
AUTO = "auto"
"""The strongest level that the machine gives."""


class IsolationError(HthorError):
    """A level of isolation that was asked for cannot be had."""

    exit_code = 5


class Isolation(Struct, frozen=True, kw_only=True):
    """What holds a guest.

    Attributes:
        level: one of `LEVELS`, or "served" for an agent that runs elsewhere and is held by nothing of ours.
        landlock_abi: version of Landlock in force, 0 for none.
        seccomp: whether system calls are filtered.
        netns: whether it has a network of its own, an empty one.
        pidns: whether it sees no processes but its own.
        memory: how much memory it may take, and what sees to that.
        reason_not_higher: why the next level could not be had, or that it was not asked for; empty at the highest.
    """

    level: str
    landlock_abi: int = 0
    seccomp: bool = False
    netns: bool = False
    pidns: bool = False
    memory: str = ""
    reason_not_higher: str = ""

    def __post_init__(self) -> None:
        """Refuse a level that does not exist, also one that is read from a file.

        Raises:
            ValueError: when there is no such level.
        """
        if self.level not in (SERVED, *LEVELS):
            raise ValueError(f"level is '{self.level}', valid are {', '.join((SERVED, *LEVELS))}")


def check_level(level: str, *, auto: bool = True) -> str:
    """The same level, if there is one of this name.

    Raises:
        UnknownName: when there is none.
    """
    valid = (AUTO, *LEVELS) if auto else LEVELS
    if level not in valid:
        raise UnknownName("isolation level", level, valid, "See docs/isolation.md.")
    return level


def suffices(level: str, required: str) -> bool:
    """Whether a level is at least the required one."""
    ladder = (SERVED, *LEVELS)
    return ladder.index(level) >= ladder.index(required)
