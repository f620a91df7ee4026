"""How one guest is confined and what it may use, as a record that is sent to its process."""

from msgspec import Struct


class Policy(Struct, frozen=True, kw_only=True):
    """The permissions and limits of a guest.

    Attributes:
        level: one of `LEVELS`.
        read: files and folders that it may read. listed: folders of which it may read the names only.
        scratch: the folder that it may write to; emptied after each trial.
        memory_mb: memory that it may use. disk_mb: how much it may write in a trial.
        execute: whether it is a program, which is started once it is confined; readable files may then be executed.
        devices: devices beyond the common ones, such as GPUs.
        compiled: folder where the supervisor keeps compiled code, which agents may only read; may be empty.
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
