"""System calls of Linux on x86_64 by number: calls that a guest is denied, and calls that only seem to succeed.

The filter in `seccomp` is assembled from these tables. Calls that are not listed are allowed; but of `fcntl` and
`ioctl`, only the listed commands are.
"""

import signal


def _numbers(text: str) -> dict[str, int]:
    """Numbers of system calls by their names, from pairs such as ``socket 41, connect 42``."""
    return {name: int(number) for name, number in (pair.split() for pair in text.split(", "))}


DENIED = {
    # the network; a pair of connected streams is allowed, as asyncio needs one: see SOCKETPAIR
    **_numbers("socket 41, connect 42, accept 43, bind 49, listen 50, accept4 288"),
    # other processes: starting, signalling, inspecting or slowing them, and leaving the process group
    # (timer_create sends any signal, and all processes of a user share one limit of their number)
    **_numbers(
        "fork 57, vfork 58, execveat 322, setsid 112, setpgid 109, tkill 200, rt_sigqueueinfo 129, "
        "rt_tgsigqueueinfo 297, pidfd_open 434, pidfd_getfd 438, pidfd_send_signal 424, ptrace 101, "
        "process_vm_readv 310, process_vm_writev 311, kcmp 312, process_madvise 440, process_mrelease 448, "
        "migrate_pages 256, move_pages 279, setpriority 141, sched_setparam 142, sched_setscheduler 144, "
        "sched_setaffinity 203, sched_setattr 314, ioprio_set 251, setrlimit 160, timer_create 222"
    ),
    # memory and messages that outlive a process or escape the limits
    **_numbers(
        "shmget 29, shmat 30, shmctl 31, semget 64, semop 65, semctl 66, msgget 68, msgsnd 69, msgrcv 70, "
        "msgctl 71, semtimedop 220, mq_open 240, mq_unlink 241, memfd_secret 447, add_key 248, request_key 249, "
        "keyctl 250"
    ),
    # the file system as a whole, and ways around Landlock
    **_numbers(
        "mount 165, umount2 166, chroot 161, pivot_root 155, unshare 272, setns 308, open_tree 428, move_mount 429, "
        "fsopen 430, fsconfig 431, fsmount 432, fspick 433, mount_setattr 442, quotactl_fd 443, open_tree_attr 467, "
        "name_to_handle_at 303, open_by_handle_at 304, mknod 133, mknodat 259, inotify_init 253, inotify_init1 294, "
        "fanotify_init 300, quotactl 179, swapon 167, swapoff 168"
    ),
    # not restricted by Landlock: a process could change every file of its user
    **_numbers(
        "truncate 76, chown 92, fchown 93, lchown 94, fchownat 260, setxattr 188, lsetxattr 189, fsetxattr 190, "
        "setxattrat 463, removexattr 197, lremovexattr 198, fremovexattr 199, removexattrat 466, file_setattr 469"
    ),
    # the kernel and the machine
    **_numbers(
        "bpf 321, perf_event_open 298, userfaultfd 323, io_uring_setup 425, io_uring_enter 426, "
        "io_uring_register 427, kexec_load 246, kexec_file_load 320, init_module 175, finit_module 313, "
        "delete_module 176, reboot 169, sethostname 170, setdomainname 171, iopl 172, ioperm 173, modify_ldt 154, "
        "personality 135, syslog 103, acct 163, settimeofday 164, clock_settime 227, adjtimex 159, "
        "clock_adjtime 305, vhangup 153"
    ),
}
SUPERVISOR_CALLS = ("fork", "vfork", "pidfd_open", "sched_setaffinity")
"""Calls that the supervisor may make, because it starts and watches processes."""
ABSENT = {"clone3": 435, "memfd_create": 319, "mincore": 27, "cachestat": 451}
"""Reported as missing, so that libraries fall back: clone3 hides its flags behind a pointer, and the last two reveal
which parts of a shared file have been read."""
UNSUPPORTED = {"fallocate": 285}
"""Reported as unsupported: libraries then write to the file instead, which the limits notice."""
IGNORED = _numbers(
    "chmod 90, fchmod 91, fchmodat 268, fchmodat2 452, utime 132, utimes 235, futimesat 261, utimensat 280, "
    "flock 73, sync 162, syncfs 306, fadvise64 221"
)
"""Reported as done, but not done. Normal programs make these calls, but Landlock cannot restrict them: new modes and
times would last, a lock on a file that two guests can read would be a channel between them, and others may notice that
a file was dropped from memory."""

CLONE, KILL, TGKILL, PRLIMIT, EXECVE = 56, 62, 234, 302, 59
"""Allowed only for threads, signals to itself but `FROM_OUTSIDE`, its own limits but `CPU_LIMITS`, one program."""
FROM_OUTSIDE = frozenset({signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGKILL, signal.SIGTERM})
"""Signals by which the machine or a person ends a process. Its trial may then be repeated, so guests cannot send
them."""
CPU_LIMITS = (0, 15)
"""RLIMIT_CPU and RLIMIT_RTTIME end a process with SIGKILL."""

SOCKETPAIR, AF_UNIX, SOCK_TYPE, SOCK_STREAM = 53, 1, 0xF, 1
"""Only streams: a datagram socket of a pair could also send to any address on the machine."""

PRCTL = 157
PRCTLS = (1, 4, 67)
"""Refused: PR_SET_PDEATHSIG (could outlive its parent), PR_SET_DUMPABLE (visible in /proc), PR_SET_MEMORY_MERGE."""

PREADV2, READ_FLAGS = 327, 5
"""This call's flags reveal whether a part of a file is cached, or drop it from the cache."""
MADVISE, COLD = 28, (12, 20, 21)
"""Advice whose effect others could notice: MADV_MERGEABLE, MADV_COLD, MADV_PAGEOUT. Reported as done."""

FCNTL = 72
FCNTLS = (0, 1, 2, 3, 4, 5, 9, 11, 16, 17, 36, 1025, 1027, 1028, 1030, 1032, 1034)
"""Allowed: F_DUPFD, F_GETFD, F_SETFD, F_GETFL, F_SETFL, F_GETLK, F_GETOWN, F_GETSIG, F_GETOWN_EX, F_GETOWNER_UIDS,
F_OFD_GETLK, F_GETLEASE, F_DUPFD_QUERY, F_CREATED_QUERY, F_DUPFD_CLOEXEC, F_GETPIPE_SZ, F_GET_SEALS. The others send
signals, take leases, watch folders, or make lasting changes to a file or a pipe."""
FCNTL_LOCKS = (6, 7, 37, 38)
"""F_SETLK, F_SETLKW, F_OFD_SETLK, F_OFD_SETLKW: reported as done, like `flock`."""

IOCTL = 16
IOCTLS = (0x5401, 0x802C542A, 0x540F, 0x5411, 0x5413, 0x541B, 0x5421, 0x5450, 0x5451, 0x5460, 0x8905)
"""Allowed: TCGETS, TCGETS2, TIOCGPGRP, TIOCOUTQ, TIOCGWINSZ, FIONREAD, FIONBIO, FIONCLEX, FIOCLEX, FIOQSIZE and
SIOCATMARK."""
FILE_IOCTLS = (0x58, 0x66, 0x76, 0x94)
"""Families of commands (the second byte) that make lasting changes to a file: flags, generation, whole blocks. A guest
with a GPU may use all commands except these and `TERMINAL_IOCTLS`, as drivers have their own commands."""
TERMINAL_IOCTLS = (0x5412, 0x8901, 0x8902)
"""TIOCSTI types into a terminal; FIOSETOWN and SIOCSPGRP make the kernel send signals."""
