"""The trusted part of a guest's process: forks one child a trial, watches it and clears up; runs no agent's code.

It is held too, before it imports anything for an agent, so that no library does what an agent may not. It has its own
line to the host, which no child ever holds. So an agent can neither speak for it nor keep it from saying
how the agent ended. What a trial is about it never reads: that the host calls is enough to fork a child who does.
"""

from __future__ import annotations

import os
import select
import signal
import socket
import sys
from pathlib import Path

from hthor.guest.confinement import enforcement, kernel, limits
from hthor.guest.confinement.enforcement import Refused
from hthor.guest.process_tools import cleanup
from hthor.guest.protocol import trial_channel, wire
from hthor.guest.protocol.pipe import HostPipe
from hthor.guest.supervisor import forking, watchdog
from hthor.guest.supervisor.forking import SpareProcess
from hthor.guest.supervisor.preloading import preload
from hthor.guest.supervisor.scratch_folder import ScratchFolder

_SUBREAPER = 36


def main(tell: int, parent: int) -> None:
    """Serve the host until it hangs up.

    Args:
        tell: the keeper's own line to the host and back, by which channels for trials come too.
        parent: the host's process id, to die with it; 0 where bubblewrap sees to that.
    """
    limits.die_with(parent)
    os.set_inheritable(tell, False)
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    line, own = socket.socket(fileno=tell), HostPipe(-1, tell)
    ends = trial_channel.receive_ends(line)
    order = HostPipe(ends.read, ends.write).receive() if ends else None
    if ends is None or not isinstance(order, wire.Load):
        os._exit(1)
    if parent:
        _leave_guard((tell, *ends.handles), os.path.dirname(order.policy.scratch))
    try:
        limits.drop_privileges()
        if sys.platform == "linux":
            kernel.prctl("adopting orphans", _SUBREAPER, 1)
        enforcement.confine_supervisor(order.policy)
        home = ScratchFolder(order.policy.scratch)
        held = enforcement.make_ruleset(order.policy)
    except Refused as error:
        own.send(wire.Failed(kind="confinement", detail=str(error)))
        return
    os.chdir(os.path.dirname(order.policy.scratch))
    if not order.words:
        preload(Path(order.path), order.module)
        home.tidy()
    pid = forking.fork_trial(ends, tell, order, held, first=True)
    spare: SpareProcess | None = None
    while True:
        told = watchdog.watch_trial(pid, order, tell)
        if home.tidy() and held is not None:  # rules are for the folder that was there
            held.close()
            held = enforcement.make_ruleset(order.policy)
            if spare:
                spare.discard()
                spare = None
        own.send(told)
        if (fresh := trial_channel.receive_ends(line)) is None:
            return
        ends.close()
        ends = fresh
        if not _called(ends.read):
            return
        pid = (spare.start(ends) if spare else 0) or forking.fork_trial(ends, tell, order, held)
        if order.policy.level != "L1":  # there all that the keeper has started ends with each trial
            spare = SpareProcess(ends, tell, order, held)


def _called(read: int) -> bool:
    """Wait until the host begins a trial, without reading what it says; false when it has hung up."""
    poll = select.poll()
    poll.register(read, select.POLLIN)
    ((_, event),) = poll.poll()
    return bool(event & select.POLLIN)


def _leave_guard(pipes: tuple[int, ...], ground: str) -> None:
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
        cleanup.end_descendants(me)
        cleanup.empty_folder(ground)
        os.rmdir(ground)
    finally:
        if code is not None and code < 0:  # so that the host hears how the keeper ended
            os.kill(me, -code)
        os._exit(code or 0)
