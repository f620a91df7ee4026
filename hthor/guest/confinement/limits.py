"""Resource limits, dropped privileges, and resource use of processes."""

import contextlib
import ctypes
import os
import resource
import signal
import struct
import sys
from pathlib import Path

from hthor.guest.confinement import kernel

_MOST_FILES = 10_000
_OPEN_FILES = 256
_MORE_PROCESSES = 1024
_CAPSET, _CAPBSET_DROP = 126, 24
_HELD = ("VmRSS", "VmPTE", "VmSwap")


def die_with(parent: int) -> None:
    """Make this process end when ``parent`` ends; with 0, bubblewrap does that."""
    if sys.platform == "linux":
        kernel.prctl("dying with the parent", kernel.PR_SET_PDEATHSIG, int(signal.SIGKILL))
    if parent and os.getppid() != parent:
        os._exit(0)


def make_undumpable() -> None:
    """Hide this process's memory and environment from other processes of the same user."""
    if sys.platform == "linux":
        kernel.prctl("hiding memory", kernel.PR_SET_DUMPABLE, 0)


def drop_privileges() -> None:
    """Give up every privilege permanently; write no core files, and be the first to be killed when memory runs out."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if sys.platform != "linux":
        return
    with contextlib.suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("1000")
    kernel.prctl("renouncing privileges", kernel.PR_SET_NO_NEW_PRIVS, 1)
    with contextlib.suppress(kernel.Refused):  # without privileges nothing can be dropped
        for capability in range(41):
            kernel.prctl("dropping a privilege", _CAPBSET_DROP, capability)
    if os.uname().machine == "x86_64":
        head = ctypes.create_string_buffer(struct.pack("<Ii", 0x20080522, 0), 8)
        kernel.syscall("dropping privileges", _CAPSET, head, ctypes.create_string_buffer(bytes(24), 24))


def set_limits(memory_mb: int, disk_mb: int, *, processes: bool) -> None:
    """Limit memory (0: no limit, since a GPU maps more than any), files, and ``processes`` if it may start any."""
    if memory_mb:
        _lower(resource.RLIMIT_DATA, memory_mb << 20)
    _lower(resource.RLIMIT_FSIZE, disk_mb << 20)
    _lower(resource.RLIMIT_NOFILE, _OPEN_FILES)
    if processes and sys.platform == "linux":
        _lower(resource.RLIMIT_NPROC, _threads_of_user() + _MORE_PROCESSES)


def process_memory_mb(pid: int) -> float:
    """All memory that a process uses [MB], with swapped pages and page tables.

    The tables can be many times as large as the pages: a page that was only read needs a table entry but no memory.
    """
    with contextlib.suppress(OSError, ValueError, IndexError):
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
        facts = {name: words for name, _, words in (line.partition(":") for line in lines)}
        return sum(int(facts[name].split()[0]) for name in _HELD if name in facts) / 1024
    return 0.0


def written_mb(pid: int) -> float:
    """The amount that a process has written to disk so far [MB], deleted files included."""
    try:
        words = Path(f"/proc/{pid}/io").read_text().split()
        return int(words[words.index("write_bytes:") + 1]) / (1 << 20)
    except (OSError, ValueError):
        return 0.0


def folder_usage(folder: str) -> tuple[float, int]:
    """Size of all files in a folder [MB] and their number; stops counting at `_MOST_FILES`.

    Raises:
        OSError: when a folder in it exists but cannot be read.
    """
    size = count = 0
    left = [folder]
    while left and count <= _MOST_FILES:
        with contextlib.suppress(FileNotFoundError, NotADirectoryError), os.scandir(left.pop()) as entries:
            for entry in entries:
                count += 1
                with contextlib.suppress(FileNotFoundError):
                    size += entry.stat(follow_symlinks=False).st_blocks * 512
                    if entry.is_dir(follow_symlinks=False):
                        left.append(entry.path)
                if count > _MOST_FILES:
                    break
    return size / (1 << 20), count


def find_excess(pid: int, scratch: str, memory_mb: int, disk_mb: int) -> tuple[str, str] | None:
    """The limit that a process exceeds, as a fault's kind and detail; None while it exceeds none.

    The detail has no measured amount, which would differ from run to run.
    """
    if process_memory_mb(pid) > memory_mb:
        return "memory", f"the agent held more than {memory_mb} MB of memory"
    try:
        size, count = folder_usage(scratch)
    except OSError as error:
        return "disk", f"a folder of the agent's cannot be looked into: {error.strerror}"
    size = max(size, written_mb(pid))
    if size > disk_mb:
        return "disk", f"the agent wrote more than {disk_mb} MB in a trial"
    if count > _MOST_FILES:
        return "disk", f"the agent made more than {_MOST_FILES} files in a trial"
    return None


def _lower(which: int, most: int) -> None:
    _, hard = resource.getrlimit(which)
    value = most if hard == resource.RLIM_INFINITY else min(most, hard)
    resource.setrlimit(which, (value, value))


def _threads_of_user() -> int:
    """How many threads this user has; the kernel counts them all against the limit."""
    count, me = 0, os.getuid()
    for status in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if status.stat().st_uid == me:
                count += len(os.listdir(status / "task"))
    return count
