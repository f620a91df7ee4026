"""What holds one guest and what it may use, as one record that travels to its process."""

from __future__ import annotations

from msgspec import Struct


class Policy(Struct, frozen=True, kw_only=True):
    """The terms of a guest.

    Attributes:
        level: one of `LEVELS`.
        read: files and folders that it may read. listed: folders of which it may read the names only.
        scratch: the folder that it may write to; emptied after each trial.
        memory_mb: memory that it may hold. disk_mb: what it may write in a trial.
        execute: whether it is a program, which is started once it is held; what may be read may then be executed.
        devices: what it may use beyond what everybody may, such as GPUs.
        compiled: where the trusted part of the guest keeps compiled code, which agents may only read; may be empty.
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
