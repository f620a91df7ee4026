"""The trusted part of a guest's process: forks one child a trial, watches it and clears up; runs no agent's code.

It has its own pipe to the host, which no child ever holds. So an agent can neither speak for it nor keep it from saying
how the agent ended. What a trial is about it never reads: that the host calls is enough to fork a child who does.
"""

from __future__ import annotations

import os
import select
import signal
import sys
from pathlib import Path

from hthor.guest import clearing, forking, frames, watching, wire
from hthor.guest.confinement import holding, kernel, limits
from hthor.guest.confinement.holding import Refused
from hthor.guest.forking import Spare
from hthor.guest.preloading import preload
from hthor.guest.senses import Pipe

_SUBREAPER = 36


def main(read: int, tell: int, write: int, parent: int) -> None:
    """Serve the host until it hangs up.

    Args:
        read: pipe from the host. tell: the keeper's own line to the host, and back. write: the children's pipe to
            the host.
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
        own.send(watching.watch(pid, order, tell))
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
        clearing.end_descendants(me)
        clearing.empty(scratch)
        os.rmdir(scratch)
    finally:
        if code is not None and code < 0:  # so that the host hears how the keeper ended
            os.kill(me, -code)
        os._exit(code or 0)
