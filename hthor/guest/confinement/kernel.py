"""Kernel calls for which Python has no functions."""

import ctypes
import os
from typing import Any

_libc: Any = None

PR_SET_PDEATHSIG = 1
PR_SET_DUMPABLE = 4
PR_SET_SECCOMP = 22
PR_SET_NO_NEW_PRIVS = 38


class Refused(Exception):
    """The kernel refuses a request; the message names the request and the reason."""


def syscall(what: str, number: int, *values: Any) -> int:
    """The result of a system call.

    Raises:
        Refused: when it fails; ``what`` names its purpose.
    """
    result: int = _library().syscall(ctypes.c_long(number), *(_wide(value) for value in values))
    if result < 0:
        raise Refused(f"{what}: {os.strerror(ctypes.get_errno())}")
    return result


def prctl(what: str, option: int, *values: Any) -> None:
    """Call prctl; ``what`` and errors as for `syscall`."""
    padded = (*values, 0, 0, 0, 0)[:4]
    if _library().prctl(ctypes.c_int(option), *(_wide(value) for value in padded)) < 0:
        raise Refused(f"{what}: {os.strerror(ctypes.get_errno())}")


def _library() -> Any:
    global _libc
    if _libc is None:
        _libc = ctypes.CDLL(None, use_errno=True)
    return _libc


def _wide(value: Any) -> Any:
    """The value as wide as a register: ctypes would pass a Python int as 32 bits."""
    return ctypes.c_ulong(value) if isinstance(value, int) else value
