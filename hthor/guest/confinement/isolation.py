"""Levels of isolation, the record of how a guest was isolated, and the permissions of its process."""

from msgspec import Struct

from hthor.errors import HthorError, UnknownName

LEVELS = ("L1", "L2", "L3")
"""From weak to strong: a separate process; Landlock and seccomp too; namespaces too."""
SERVED = "served"
"""Stands for a level when the agent runs elsewhere, where its confinement is unknown."""
AUTO = "auto"
"""The strongest level that starts on the machine."""


class IsolationError(HthorError):
    """The requested level of isolation does not start on this machine."""

    exit_code = 5


class Isolation(Struct, frozen=True, kw_only=True):
    """How a guest was isolated.

    Attributes:
        level: one of `LEVELS`, or "served" for an agent that runs elsewhere.
        landlock_abi: version of Landlock in force, 0 for none.
        seccomp: whether system calls are filtered.
        netns: whether it has its own, empty network.
        pidns: whether it sees only its own processes.
        memory: how much memory it may use, and how that is enforced.
        reason_not_higher: why the next level did not start, or that this level was requested; empty at L3.
    """

    level: str
    landlock_abi: int = 0
    seccomp: bool = False
    netns: bool = False
    pidns: bool = False
    memory: str = ""
    reason_not_higher: str = ""

    def __post_init__(self) -> None:
        """Check the level, also of a record that is read from a file.

        Raises:
            ValueError: when there is no such level.
        """
        if self.level not in (SERVED, *LEVELS):
            raise ValueError(f"level is '{self.level}', valid are {', '.join((SERVED, *LEVELS))}")


def check_level(level: str, *, auto: bool = True) -> str:
    """The level itself, if it exists.

    Raises:
        UnknownName: when there is no such level.
    """
    valid = (AUTO, *LEVELS) if auto else LEVELS
    if level not in valid:
        raise UnknownName("isolation level", level, valid, "See docs/isolation.md.")
    return level


def suffices(level: str, required: str) -> bool:
    """Whether a level is at least the required one."""
    ladder = (SERVED, *LEVELS)
    return ladder.index(level) >= ladder.index(required)


class Policy(Struct, frozen=True, kw_only=True):
    """The permissions and limits of a guest.

    Attributes:
        level: one of `LEVELS`.
        read: files and folders that it may read. listed: folders in which it may only list names.
        scratch: the folder that it may write to; emptied after each trial.
        memory_mb: memory that it may use. disk_mb: how much it may write in a trial.
        execute: whether it is a program, started after confinement; it may then execute readable files.
        devices: devices besides `paths.DEVICES`, such as GPUs.
        compiled: folder where the supervisor keeps compiled code, which agents may only read; empty for no folder.
    """

    level: str
    read: tuple[str, ...]
    listed: tuple[str, ...]
    scratch: str
    memory_mb: int
    disk_mb: int
    execute: bool = False
    devices: tuple[str, ...] = ()
    compiled: str = ""
