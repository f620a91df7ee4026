"""Which system calls a process may make, as a filter assembled by hand; knows nothing of files.

What is not named is allowed, so this is a fence and no wall: a new kernel may have new calls. The numbers are those of
x86_64; on another machine the filter refuses to be put on.

A process can be let start one program, which stays held: `start` says a word that the filter waits for, in places that
the kernel itself does not read. The word is random, and gone with the memory of whoever said it.
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import struct
from collections.abc import Mapping, Sequence
from typing import NoReturn

from hthor.guest.confinement import kernel
from hthor.guest.confinement.kernel import Refused

_ARCH = 0xC000003E
_X32 = 0x40000000
_CLONE_THREAD = 0x10000
_LOAD, _EQUAL, _AT_LEAST, _ANY_BIT, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_NUMBER, _MACHINE = 0, 4
_ALLOW, _KILL = 0x7FFF0000, 0x80000000
_FILTER = 2

DENIED = {
    # the network; a pair of connected sockets stays, asyncio needs one
    "socket": 41,
    "connect": 42,
    "accept": 43,
    "bind": 49,
    "listen": 50,
    "accept4": 288,
    # other processes: starting, leaving the group, signalling, looking into, slowing down
    "fork": 57,
    "vfork": 58,
    "execveat": 322,
    "setsid": 112,
    "setpgid": 109,
    "tkill": 200,
    "rt_sigqueueinfo": 129,
    "rt_tgsigqueueinfo": 297,
    "pidfd_open": 434,
    "pidfd_getfd": 438,
    "pidfd_send_signal": 424,
    "ptrace": 101,
    "process_vm_readv": 310,
    "process_vm_writev": 311,
    "kcmp": 312,
    "process_madvise": 440,
    "process_mrelease": 448,
    "migrate_pages": 256,
    "move_pages": 279,
    "setpriority": 141,
    "sched_setparam": 142,
    "sched_setscheduler": 144,
    "sched_setaffinity": 203,
    "sched_setattr": 314,
    "ioprio_set": 251,
    "setrlimit": 160,
    # memory and messages that outlive a process, or that no limit counts
    "shmget": 29,
    "shmat": 30,
    "shmctl": 31,
    "semget": 64,
    "semop": 65,
    "semctl": 66,
    "msgget": 68,
    "msgsnd": 69,
    "msgrcv": 70,
    "msgctl": 71,
    "semtimedop": 220,
    "mq_open": 240,
    "mq_unlink": 241,
    "memfd_secret": 447,
    "add_key": 248,
    "request_key": 249,
    "keyctl": 250,
    # the file system as a whole, and ways around the rules for files
    "mount": 165,
    "umount2": 166,
    "chroot": 161,
    "pivot_root": 155,
    "unshare": 272,
    "setns": 308,
    "open_tree": 428,
    "move_mount": 429,
    "fsopen": 430,
    "fsconfig": 431,
    "fsmount": 432,
    "fspick": 433,
    "mount_setattr": 442,
    "quotactl_fd": 443,
    "open_tree_attr": 467,
    "name_to_handle_at": 303,
    "open_by_handle_at": 304,
    "mknod": 133,
    "mknodat": 259,
    "inotify_init": 253,
    "inotify_init1": 294,
    "fanotify_init": 300,
    "quotactl": 179,
    "swapon": 167,
    "swapoff": 168,
    # what the rules for files say nothing of: they would let a process change every file of its user
    "truncate": 76,
    "chown": 92,
    "fchown": 93,
    "lchown": 94,
    "fchownat": 260,
    "setxattr": 188,
    "lsetxattr": 189,
    "fsetxattr": 190,
    "setxattrat": 463,
    "removexattr": 197,
    "lremovexattr": 198,
    "fremovexattr": 199,
    "removexattrat": 466,
    "file_setattr": 469,
    # the kernel and the machine
    "bpf": 321,
    "perf_event_open": 298,
    "userfaultfd": 323,
    "io_uring_setup": 425,
    "io_uring_enter": 426,
    "io_uring_register": 427,
    "kexec_load": 246,
    "kexec_file_load": 320,
    "init_module": 175,
    "finit_module": 313,
    "delete_module": 176,
    "reboot": 169,
    "sethostname": 170,
    "setdomainname": 171,
    "iopl": 172,
    "ioperm": 173,
    "modify_ldt": 154,
    "personality": 135,
    "syslog": 103,
    "acct": 163,
    "settimeofday": 164,
    "clock_settime": 227,
    "adjtimex": 159,
    "clock_adjtime": 305,
    "vhangup": 153,
}
_ABSENT = {"clone3": 435, "memfd_create": 319}
"""Said not to exist, so that libraries take the older way: clone3 hides what it does behind a pointer."""
_UNSUPPORTED = {"fallocate": 285}
"""Said not to be supported: libraries then write, which is counted while it happens."""
_IDLE = {
    "chmod": 90,
    "fchmod": 91,
    "fchmodat": 268,
    "fchmodat2": 452,
    "utime": 132,
    "utimes": 235,
    "futimesat": 261,
    "utimensat": 280,
}
"""Said to be done, and not done: whoever copies a file calls these, and no rule for files says whose it may be."""
_EXECVE, _UNREAD = 59, 3
_WORD = struct.Struct("<3Q")
_CLONE, _KILL_CALL, _TGKILL, _PRLIMIT, _FCNTL, _IOCTL = 56, 62, 234, 302, 72, 16
_OWNED = (8, 10, 15)  # F_SETOWN, F_SETSIG, F_SETOWN_EX: they make the kernel send signals
_IOCTLS = (0x5412, 0x8901, 0x8902)  # TIOCSTI types into a terminal; FIOSETOWN, SIOCSPGRP are F_SETOWN again


def unavailable() -> str:
    """Why there can be no filter on this machine, empty when there can."""
    machine = platform.machine()
    return "" if machine == "x86_64" else f"the system call filter is written for x86_64, this machine is {machine}"


def new_word() -> bytes:
    """What is to be said to start a program."""
    return os.urandom(_WORD.size)


def start(words: Sequence[str], env: Mapping[str, str], word: bytes) -> NoReturn:
    """Become another program.

    Raises:
        Refused: when it cannot be started.
    """
    argv = (ctypes.c_char_p * (len(words) + 1))(*map(os.fsencode, words), None)
    envp = (ctypes.c_char_p * (len(env) + 1))(*(os.fsencode(f"{name}={value}") for name, value in env.items()), None)
    kernel.syscall(f"starting {words[0]}", _EXECVE, os.fsencode(words[0]), argv, envp, *_WORD.unpack(word))
    raise Refused(f"starting {words[0]}: nothing came of it")


def put_on(me: int, word: bytes = b"") -> None:
    """Filter this process's system calls for good. It needs no_new_privs, and a single thread.

    Args:
        me: its process id, the only one that it may signal. word: what lets it start a program, empty for nothing.

    Raises:
        Refused: when it cannot be.
    """
    if reason := unavailable():
        raise Refused(reason)
    code = program(me, word)
    text = ctypes.create_string_buffer(code, len(code))
    head = ctypes.create_string_buffer(struct.pack("<HxxxxxxQ", len(code) // 8, ctypes.addressof(text)), 16)
    kernel.prctl("filtering system calls", kernel.PR_SET_SECCOMP, _FILTER, ctypes.cast(head, ctypes.c_void_p))


def program(me: int, word: bytes = b"") -> bytes:
    """The filter's instructions."""
    refuse, absent = _no(errno.EPERM), _no(errno.ENOSYS)
    lines = [(_LOAD, 0, 0, _MACHINE), (_EQUAL, 1, 0, _ARCH), (_RETURN, 0, 0, _KILL)]
    lines += [(_LOAD, 0, 0, _NUMBER), (_AT_LEAST, 0, 1, _X32), (_RETURN, 0, 0, _KILL)]
    for number in DENIED.values():
        lines += _on(number, [refuse])
    for number in _ABSENT.values():
        lines += _on(number, [absent])
    for number in _UNSUPPORTED.values():
        lines += _on(number, [_no(errno.EOPNOTSUPP)])
    for number in _IDLE.values():
        lines += _on(number, [_no(0)])
    lines += _on(_EXECVE, _spoken(word, refuse) if word else [refuse])
    lines += _on(_CLONE, [_argument(0), (_ANY_BIT, 1, 0, _CLONE_THREAD), refuse, _YES])
    for number in (_KILL_CALL, _TGKILL):
        lines += _on(number, [_argument(0), (_EQUAL, 1, 0, me), refuse, _YES])
    lines += _on(_PRLIMIT, [_argument(0), (_EQUAL, 2, 0, 0), (_EQUAL, 1, 0, me), refuse, _YES])
    for number, words in ((_FCNTL, _OWNED), (_IOCTL, _IOCTLS)):
        lines += _on(number, [_argument(1), *(line for word in words for line in _on(word, [refuse])), _YES])
    return b"".join(struct.pack("<HBBI", *line) for line in [*lines, _YES])


def _spoken(word: bytes, refuse: tuple[int, int, int, int]) -> list[tuple[int, int, int, int]]:
    """Allow a call whose last three arguments are this word."""
    lines: list[tuple[int, int, int, int]] = []
    for index, (half,) in enumerate(struct.iter_unpack("<I", word)):
        lines += [(_LOAD, 0, 0, 16 + 8 * _UNREAD + 4 * index), (_EQUAL, 1, 0, half), refuse]
    return [*lines, _YES]


_YES = (_RETURN, 0, 0, _ALLOW)


def _no(code: int) -> tuple[int, int, int, int]:
    return (_RETURN, 0, 0, 0x50000 | code)


def _argument(index: int) -> tuple[int, int, int, int]:
    """Load the low half of an argument; all those that are looked at have 32 bits."""
    return (_LOAD, 0, 0, 16 + 8 * index)


def _on(value: int, lines: list[tuple[int, int, int, int]]) -> list[tuple[int, int, int, int]]:
    """Lines that count only where the loaded word has this value."""
    return [(_EQUAL, 0, len(lines), value), *lines]
