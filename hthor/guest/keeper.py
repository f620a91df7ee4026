"""The trusted part of a guest's process: forks one child a trial, watches it and clears up; runs no agent's code.

It has its own pipe to the host, which no child ever holds. So an agent can neither speak for it nor keep it from saying
how the agent ended. What a trial is about it never reads: that the host calls is enough to fork a child who does.
"""

from __future__ import annotations

import contextlib
import os
import select
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from hthor.guest import child, ending, forking, frames, wire
from hthor.guest.confinement import holding, kernel, limits
from hthor.guest.confinement.holding import Refused
from hthor.guest.forking import Spare
from hthor.guest.preloading import preload
from hthor.guest.senses import Pipe

_LOOK_MS = 50
_SUBREAPER = 36


def main(read: int, tell: int, write: int, parent: int) -> None:
    """Serve the host until it hangs up.

    Args:
        read: pipe from the host. tell: the keeper's own pipe to the host. write: the children's pipe to the host.
        parent: the host's process id, to die with it; 0 where bubblewrap sees to that.
    """
    limits.die_with(parent)
    for handle in (read, tell, write):
        os.set_inheritable(handle, False)
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    shared = int(os.environ.get(frames.VARIABLE, "-1"))
    if shared >= 0:
        os.set_inheritable(shared, False)
    pipe, own = Pipe(read, write, shared), Pipe(-1, tell)
    order = pipe.receive()
    if not isinstance(order, wire.Load):
        os._exit(1)
    if parent:
        _leave_guard((read, tell, write), order.policy.scratch)
    try:
        limits.renounce()
        if sys.platform == "linux":
            kernel.prctl("adopting orphans", _SUBREAPER, 1)
        held = holding.rules(order.policy)
    except Refused as error:
        own.send(wire.Failed(kind="confinement", detail=str(error)))
        return
    if not order.words:
        preload(Path(order.path), order.module)
    pid = forking.fork(pipe, tell, order, held, first=True)
    spare: Spare | None = None
    while True:
        own.send(_watch(pid, order))
        if not _called(read):
            return
        pid = (spare.start() if spare else 0) or forking.fork(pipe, tell, order, held)
        if order.policy.level != "L1":  # there all that the keeper has started ends with each trial
            spare = Spare(pipe, tell, order, held)


def _called(read: int) -> bool:
    """Wait until the host begins a trial, without reading what it says; false when it has hung up."""
    poll = select.poll()
    poll.register(read, select.POLLIN)
    ((_, event),) = poll.poll()
    return bool(event & select.POLLIN)


def _leave_guard(pipes: tuple[int, ...], scratch: str) -> None:
    """Go on as a child of a guard, which outlives us and the host for just as long as it takes to end all we started.

    Whatever loses its parent comes to the guard, even if it has left the group.
    """
    if sys.platform != "linux":
        return
    me, awaited = os.getpid(), {signal.SIGUSR1, signal.SIGCHLD}
    signal.pthread_sigmask(signal.SIG_BLOCK, awaited)
    pid = os.fork()
    if not pid:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, awaited)
        limits.die_with(me)
        return
    code: int | None = None
    try:
        host = os.getppid()
        kernel.prctl("outliving the host", kernel.PR_SET_PDEATHSIG, int(signal.SIGUSR1))
        kernel.prctl("adopting orphans", _SUBREAPER, 1)
        for handle in (*pipes, 1, 2):  # the host takes an open end for a guest that lives
            os.close(handle)
        while os.getppid() == host and code is None:
            signal.sigwait(awaited)
            ended, found = os.waitpid(-1, os.WNOHANG)
            code = os.waitstatus_to_exitcode(found) if ended == pid else None
        end_descendants(me)
        empty(scratch)
        os.rmdir(scratch)
    finally:
        if code is not None and code < 0:  # so that the host hears how the keeper ended
            os.kill(me, -code)
        os._exit(code or 0)


def _watch(pid: int, order: wire.Load) -> wire.KeeperToHost:
    """Wait for a child's end, which comes early if it takes too much; what to say of it."""
    policy = order.policy
    found = None
    if hasattr(os, "pidfd_open"):
        handle = os.pidfd_open(pid)
        poll = select.poll()
        poll.register(handle, select.POLLIN)
        while found is None and not poll.poll(_LOOK_MS):
            found = limits.excess(pid, policy.scratch, policy.memory_mb, policy.disk_mb)
        os.close(handle)
    if found:
        os.kill(pid, signal.SIGKILL)
    _, status = os.waitpid(pid, 0)
    if policy.level == "L1":
        end_descendants(os.getpid())
    empty(policy.scratch)
    code = os.waitstatus_to_exitcode(status)
    if found:
        return wire.Failed(kind=found[0], detail=found[1])
    if code == child.ORDERLY or (bool(order.words) and code == 0):
        return wire.Over()
    kind, words = ending.told(code)
    return wire.Failed(kind=kind, detail=f"the agent's process {'was ' * (code < 0)}{words}")


def end_descendants(ancestor: int) -> None:
    """End all that a process has started, and what those have started; it adopts what loses its parent."""
    for _ in range(20):
        families = _families()
        line, left = [ancestor], []
        while line:
            below = families.get(line.pop(), [])
            line += below
            left += below
        if not left:
            return
        for pid in left:
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        time.sleep(0.001)


def _families() -> dict[int, list[int]]:
    """Living processes by their parents."""
    found: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError, ValueError):
            state, parent = stat.read_text().rpartition(")")[2].split()[:2]
            if state not in "ZX":
                found.setdefault(int(parent), []).append(int(stat.parent.name))
    return found


def empty(folder: str) -> None:
    """Remove all that is in a folder, however deep."""
    with contextlib.suppress(OSError):
        for entry in os.scandir(folder):
            with contextlib.suppress(OSError, RecursionError):
                if entry.is_dir(follow_symlinks=False):
                    shutil.rmtree(entry.path)
                else:
                    os.unlink(entry.path)
            if os.path.lexists(entry.path):  # too deep for Python, or locked by its owner
                for words in (["chmod", "-R", "u+rwX"], ["rm", "-rf"]):
                    subprocess.run([*words, "--", entry.path], stderr=subprocess.DEVNULL, check=False)
