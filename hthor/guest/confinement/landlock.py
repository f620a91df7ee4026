"""Restricts the files that a process may open, by the kernel's Landlock.

Access that no rule allows is denied permanently to this process and all that it starts. From ABI version 4 on, TCP is
denied too; from version 6 on, also signals and abstract sockets to processes outside. A process can still find out
whether a file exists, and its size.
"""

import ctypes
import os
import stat
import struct
from collections.abc import Iterable

from hthor.guest.confinement import kernel
from hthor.guest.confinement.kernel import Refused

_CREATE, _ADD, _RESTRICT = 444, 445, 446
_ASK_VERSION = 1
_BENEATH = 1
_EXECUTE = 1
_READ_FILE, _READ_DIR, _WRITE_FILE = 1 << 2, 1 << 3, 1 << 1
_TRUNCATE, _IOCTL = 1 << 14, 1 << 15
_DEVICES_AND_SOCKETS = 1 << 6 | 1 << 9 | 1 << 11
_OF_FILES = _EXECUTE | _WRITE_FILE | _READ_FILE | _TRUNCATE | _IOCTL
_PORTS = 1 | 2
_SCOPES = 1 | 2


def abi() -> int:
    """Version of the kernel's Landlock ABI, 0 if it has no Landlock."""
    try:
        return kernel.syscall("asking for Landlock", _CREATE, None, 0, _ASK_VERSION)
    except Refused:
        return 0


class Ruleset:
    """A set of rules, made once and applied by any number of forks.

    Args:
        read: files and folders that may be read, folders with everything in them.
        listed: folders in which only names may be listed.
        write: folders that may be changed. devices: files that may be read and written.
        driven: devices that also take ioctl commands. execute: whether readable files may be executed.

    Paths that do not exist are skipped.
    """

    def __init__(
        self,
        read: Iterable[str],
        *,
        listed: Iterable[str] = (),
        write: Iterable[str] = (),
        devices: Iterable[str] = (),
        driven: Iterable[str] = (),
        execute: bool = False,
    ) -> None:
        self.abi = abi()
        if not self.abi:
            raise Refused("the kernel has no Landlock (Linux 5.13 or newer, with landlock in CONFIG_LSM)")
        self._handled = _handled(self.abi)
        words = (self._handled, _PORTS if self.abi >= 4 else 0, _SCOPES if self.abi >= 6 else 0)
        size = 24 if self.abi >= 6 else 16 if self.abi >= 4 else 8
        attributes = ctypes.create_string_buffer(struct.pack("<QQQ", *words)[:size], size)
        self._handle = kernel.syscall("making Landlock rules", _CREATE, attributes, size, 0)
        for paths, rights in (
            (read, _READ_FILE | _READ_DIR | (_EXECUTE if execute else 0)),
            (listed, _READ_DIR),
            (write, self._handled & ~_EXECUTE & ~_DEVICES_AND_SOCKETS),
            (devices, _READ_FILE | _WRITE_FILE),
            (driven, _READ_FILE | _WRITE_FILE | _READ_DIR | _IOCTL),
        ):
            for path in paths:
                self._allow(path, rights)

    def apply(self) -> None:
        """Apply the rules permanently to this process, which must have a single thread."""
        kernel.syscall("putting on Landlock rules", _RESTRICT, self._handle, 0)

    def close(self) -> None:
        """Close the rules; processes that have applied them stay confined."""
        os.close(self._handle)

    def _allow(self, path: str, rights: int) -> None:
        try:
            place = os.open(path, os.O_PATH | os.O_CLOEXEC)
        except OSError:
            return
        try:
            if not stat.S_ISDIR(os.fstat(place).st_mode):
                rights &= _OF_FILES
            rule = ctypes.create_string_buffer(struct.pack("<Qi", rights & self._handled, place), 12)
            kernel.syscall(f"allowing {path}", _ADD, self._handle, _BENEATH, rule, 0)
        finally:
            os.close(place)


def _handled(version: int) -> int:
    """Every file access right that this version knows."""
    return (1 << (13 if version == 1 else 14 if version == 2 else 15 if version < 5 else 16)) - 1
