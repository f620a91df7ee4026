"""Ends the processes that a guest has started, says how they ended, and removes the files that they have written."""

import contextlib
import os
import signal
import time
from pathlib import Path

from hthor.errors import KILLED
from hthor.guest.confinement.calls import FROM_OUTSIDE

_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW
_SHELLS = 128


def end_descendants(ancestor: int) -> None:
    """End all descendants of a process, which adopts descendants that lose their parent."""
    for _ in range(20):
        below_each = children_by_parent()
        line, left = [ancestor], []
        while line:
            below = below_each.get(line.pop(), [])
            line += below
            left += below
        if not left:
            return
        for pid in left:
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        time.sleep(0.001)


def children_by_parent() -> dict[int, list[int]]:
    """The ids of running processes by their parents' ids."""
    found: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError, ValueError):
            state, parent = stat.read_text().rpartition(")")[2].split()[:2]
            if state not in "ZX":
                found.setdefault(int(parent), []).append(int(stat.parent.name))
    return found


def empty_folder(folder: str) -> None:
    """Remove everything in a folder, at any depth and with any permissions, without following links.

    It starts no program and keeps one folder open at a time, so neither depth nor names stop it.
    """
    if os.path.islink(folder):
        os.unlink(folder)
        return
    with contextlib.suppress(OSError):
        os.chmod(folder, 0o700)
        _descend(os.open(folder, _FOLDER))


def _descend(at: int) -> None:
    """Empty an open folder, and close it."""
    way, left = list[str](), [_emptied(at)]
    try:
        while way or left[-1]:
            if left[-1]:
                way.append(left[-1].pop())
                with contextlib.suppress(OSError):
                    os.chmod(way[-1], 0o700, dir_fd=at)
                at = _moved(way[-1], at)
                left.append(_emptied(at))
            else:
                at = _moved("..", at)
                left.pop()
                with contextlib.suppress(OSError):
                    os.rmdir(way.pop(), dir_fd=at)
    finally:
        os.close(at)


def _moved(name: str, at: int) -> int:
    there = os.open(name, _FOLDER, dir_fd=at)
    os.close(at)
    return there


def _emptied(at: int) -> list[str]:
    """Remove everything from an open folder except folders that are not empty; returns these folders' names."""
    with os.scandir(at) as entries:
        found = [(entry.name, entry.is_dir(follow_symlinks=False)) for entry in entries]
    full = []
    for name, deep in found:
        try:
            (os.rmdir if deep else os.unlink)(name, dir_fd=at)
        except OSError:
            full += [name] * deep
    return full


def describe_exit(code: int) -> tuple[str, str]:
    """A fault's kind and description for an exit code as `subprocess` reports it.

    Some signals are sent only by a person, or by a machine that runs out of memory or shuts down. Their kind of fault
    is "killed", and the trial may be repeated. From L2 on, an agent cannot send itself such a signal.
    """
    if code >= 0:
        return "died", f"exited with status {code}"
    return KILLED if -code in FROM_OUTSIDE else "died", f"killed by {_name(-code)}"


def unwrap_bwrap(code: int) -> int:
    """The exit code of the program that bubblewrap ran; bubblewrap reports a signal as shells do."""
    return _SHELLS - code if code > _SHELLS else code


def _name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:  # real-time signals have no names
        return f"signal {number}"
