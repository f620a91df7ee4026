"""Restricts the system calls of a process, by a seccomp filter assembled by hand.

Calls that are not listed are allowed, also those of newer kernels. The numbers are those of x86_64; on another
machine the filter refuses to be installed.

A process can be allowed to start one program, which stays confined: `exec_with_token` passes a token that the filter
demands, in arguments that the kernel itself ignores. The token is random, and is gone with the memory of its sender.
"""

import ctypes
import errno
import itertools
import os
import platform
import struct
from collections.abc import Iterable, Mapping, Sequence
from typing import NoReturn

from hthor.guest.confinement import calls, kernel
from hthor.guest.confinement.kernel import Refused

_ARCH = 0xC000003E
_X32 = 0x40000000
_CLONE_THREAD = 0x10000
_LOAD, _EQUAL, _AT_LEAST, _ANY_BIT, _AND, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x54, 0x06
_NUMBER, _MACHINE = 0, 4
_ALLOW, _KILL = 0x7FFF0000, 0x80000000
_FILTER = 2
_UNREAD = 3
_WORD = struct.Struct("<3Q")

Line = tuple[int, int, int, int]
"""An instruction: operation, lines to skip if it is true and if false, and a value."""


def unavailable() -> str:
    """Why a filter is impossible on this machine; empty if it is possible."""
    machine = platform.machine()
    return "" if machine == "x86_64" else f"the system call filter is written for x86_64, this machine is {machine}"


def new_token() -> bytes:
    """A token for `exec_with_token`."""
    return os.urandom(_WORD.size)


def exec_with_token(words: Sequence[str], env: Mapping[str, str], word: bytes) -> NoReturn:
    """Replace this process by another program.

    Raises:
        Refused: when the program cannot be started.
    """
    argv = (ctypes.c_char_p * (len(words) + 1))(*map(os.fsencode, words), None)
    envp = (ctypes.c_char_p * (len(env) + 1))(*(os.fsencode(f"{name}={value}") for name, value in env.items()), None)
    kernel.syscall(f"starting {words[0]}", calls.EXECVE, os.fsencode(words[0]), argv, envp, *_WORD.unpack(word))
    raise Refused(f"starting {words[0]}: the kernel did not run it")


def install_filter(me: int, word: bytes = b"", *, driven: bool = False) -> None:
    """Filter this process's system calls permanently. It must have no_new_privs set, and a single thread.

    Args:
        me: its process id, the only one that it may signal. word: the token to start a program, or empty.
        driven: whether it uses drivers, such as a GPU's, whose commands cannot be listed.

    Raises:
        Refused: when the filter cannot be installed.
    """
    load_filter(filter_program(me, word, driven=driven))


def install_supervisor_filter(*, execute: bool) -> None:
    """Filter the supervisor's calls, as `install_filter`; it may also fork, and start programs if ``execute``."""
    needed = (*calls.SUPERVISOR_CALLS, *(["execve"] if execute else []))
    refused = {**calls.DENIED, "execve": calls.EXECVE}
    lines = [_on(number, [_no(errno.EPERM)]) for name, number in refused.items() if name not in needed]
    load_filter(_assembled(itertools.chain(_begin(), *lines)))


def load_filter(code: bytes) -> None:
    """Apply a filter's instructions to this process permanently; errors as for `install_filter`."""
    if reason := unavailable():
        raise Refused(reason)
    text = ctypes.create_string_buffer(code, len(code))
    head = ctypes.create_string_buffer(struct.pack("<HxxxxxxQ", len(code) // 8, ctypes.addressof(text)), 16)
    kernel.prctl("filtering system calls", kernel.PR_SET_SECCOMP, _FILTER, ctypes.cast(head, ctypes.c_void_p))


def filter_program(me: int, word: bytes = b"", *, driven: bool = False) -> bytes:
    """The filter's instructions; arguments as for `install_filter`."""
    refuse = _no(errno.EPERM)
    answers = {
        errno.EPERM: calls.DENIED,
        errno.ENOSYS: calls.ABSENT,
        errno.EOPNOTSUPP: calls.UNSUPPORTED,
        0: calls.IGNORED,
    }
    lines = _begin()
    for code, table in answers.items():
        for number in table.values():
            lines += _on(number, [_no(code)])
    lines += _on(calls.EXECVE, _spoken(word, refuse) if word else [refuse])
    lines += _on(calls.CLONE, [_argument(0), (_ANY_BIT, 1, 0, _CLONE_THREAD), refuse, _YES])
    for number, signal_at in ((calls.KILL, 1), (calls.TGKILL, 2)):
        mine = [_argument(0), (_EQUAL, 1, 0, me), refuse, _argument(signal_at)]
        lines += _on(number, [*mine, *_any(sorted(calls.FROM_OUTSIDE), refuse), _YES])
    lines += _on(calls.PRLIMIT, _own_limits(me, refuse))
    lines += _on(calls.SOCKETPAIR, _streams(refuse))
    lines += _on(calls.PRCTL, [_argument(0), *_any(calls.PRCTLS, refuse), _YES])
    lines += _on(calls.PREADV2, [_argument(calls.READ_FLAGS), (_EQUAL, 1, 0, 0), _no(errno.EOPNOTSUPP), _YES])
    lines += _on(calls.MADVISE, [_argument(2), *_any(calls.COLD, _no(0)), _YES])
    locks = _any(calls.FCNTL_LOCKS, _no(0))
    lines += _on(calls.FCNTL, [_argument(1), *_any(calls.FCNTLS, _YES), *locks, refuse])
    lines += _on(calls.IOCTL, _commands(driven))
    return _assembled(lines)


def _begin() -> list[Line]:
    """End processes whose calls are not those of x86_64 programs; then load the call's number."""
    lines = [(_LOAD, 0, 0, _MACHINE), (_EQUAL, 1, 0, _ARCH), (_RETURN, 0, 0, _KILL)]
    return [*lines, (_LOAD, 0, 0, _NUMBER), (_AT_LEAST, 0, 1, _X32), (_RETURN, 0, 0, _KILL)]


def _assembled(lines: Iterable[Line]) -> bytes:
    return b"".join(struct.pack("<HBBI", *line) for line in [*lines, _YES])


def _own_limits(me: int, refuse: Line) -> list[Line]:
    """Allow reading a process's own limits, and setting those that do not end it by a signal."""
    own = [_argument(0), (_EQUAL, 2, 0, 0), (_EQUAL, 1, 0, me), refuse]
    read = [_argument(2), (_EQUAL, 0, 3, 0), (_LOAD, 0, 0, 16 + 8 * 2 + 4), (_EQUAL, 0, 1, 0), _YES]
    return [*own, *read, _argument(1), *_any(calls.CPU_LIMITS, refuse), _YES]


def _streams(refuse: Line) -> list[Line]:
    """Allow a pair of connected stream sockets."""
    family = [_argument(0), (_EQUAL, 1, 0, calls.AF_UNIX), refuse]
    return [*family, _argument(1), (_AND, 0, 0, calls.SOCK_TYPE), (_EQUAL, 1, 0, calls.SOCK_STREAM), refuse, _YES]


def _commands(driven: bool) -> list[Line]:
    """Allow the listed ioctl commands."""
    refuse = _no(errno.ENOTTY)
    if not driven:
        return [_argument(1), *_any(calls.IOCTLS, _YES), refuse]
    family = [(_AND, 0, 0, 0xFF00), *_any([one << 8 for one in calls.FILE_IOCTLS], refuse)]
    return [_argument(1), *_any(calls.TERMINAL_IOCTLS, refuse), *family, _YES]


def _spoken(word: bytes, refuse: Line) -> list[Line]:
    """Allow a call whose last three arguments are this token."""
    lines: list[Line] = []
    for index, (half,) in enumerate(struct.iter_unpack("<I", word)):
        lines += [(_LOAD, 0, 0, 16 + 8 * _UNREAD + 4 * index), (_EQUAL, 1, 0, half), refuse]
    return [*lines, _YES]


_YES = (_RETURN, 0, 0, _ALLOW)


def _no(code: int) -> Line:
    return (_RETURN, 0, 0, 0x50000 | code)


def _argument(index: int) -> Line:
    """Load the low half of an argument; all arguments that are examined have 32 bits."""
    return (_LOAD, 0, 0, 16 + 8 * index)


def _on(value: int, lines: list[Line]) -> list[Line]:
    """Instructions that apply only if the loaded word has this value."""
    return [(_EQUAL, 0, len(lines), value), *lines]


def _any(values: Iterable[int], answer: Line) -> list[Line]:
    """Give this answer if the loaded word has any of these values."""
    return [line for value in values for line in _on(value, [answer])]
