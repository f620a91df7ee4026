"""The trusted process of a guest: forks one process per trial, watches it and cleans up; runs no agent code.

It is confined too, before it imports libraries for an agent, so that no library does what an agent may not. It has its
own socket to the host, which trial processes never have: an agent can neither speak for it nor keep it from reporting
how the agent ended. It never reads the messages of a trial.
"""

import contextlib
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
from hthor.guest.protocol.trial_channel import HostPipe
from hthor.guest.supervisor import forking
from hthor.guest.supervisor.forking import SpareProcess
from hthor.guest.supervisor.preloading import preload

_SUBREAPER = 36


def main(tell: int, parent: int) -> None:
    """Serve the host until it closes the connection.

    Args:
        tell: the supervisor's own socket to the host, which also brings the pipes of each trial.
        parent: the host's process id, to end when the host ends; 0 if bubblewrap takes care of that.
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
        scratch = ScratchFolder(order.policy.scratch)
        held = enforcement.make_ruleset(order.policy)
    except Refused as error:
        own.send(wire.Failed(kind="confinement", detail=str(error)))
        return
    os.chdir(os.path.dirname(order.policy.scratch))
    if not order.words:
        preload(Path(order.path), order.module)
        scratch.reset()
    pid = forking.fork_trial(ends, tell, order, held, first=True)
    spare: SpareProcess | None = None
    while True:
        told = forking.watch_trial(pid, order, tell)
        if scratch.reset() and held is not None:  # the rules are for the old folder
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
        if order.policy.level != "L1":  # at L1 everything the supervisor has started ends with each trial
            spare = SpareProcess(ends, tell, order, held)


class ScratchFolder:
    """The folder that an agent may write to; every trial finds it in the state of the first trial.

    It lies in a folder that this process may change.
    """

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._size = os.stat(folder).st_size
        self.reset()

    def reset(self) -> bool:
        """Empty it, and reset its times; True when it was replaced by a new folder.

        An emptied folder can stay large, which would reveal that it had many files.
        """
        cleanup.empty_folder(self._folder)
        outgrown = os.stat(self._folder).st_size != self._size
        if outgrown:
            with contextlib.suppress(OSError):  # at L3 it is a mount, which cannot be replaced
                os.rmdir(self._folder)
                os.mkdir(self._folder, 0o700)
        os.utime(self._folder, (0, 0))
        return outgrown


def _called(read: int) -> bool:
    """Wait until the host begins a trial, without reading its message; False when it has closed the pipe."""
    poll = select.poll()
    poll.register(read, select.POLLIN)
    ((_, event),) = poll.poll()
    return bool(event & select.POLLIN)


def _leave_guard(pipes: tuple[int, ...], ground: str) -> None:
    """Become the guard, which outlives the host until all processes of the guest have ended; return in a child.

    Processes that lose their parent become children of the guard, even if they have left the group.
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
        for handle in (*pipes, 1, 2):  # an open end would look like a living guest to the host
            os.close(handle)
        while os.getppid() == host and code is None:
            signal.sigwait(awaited)
            ended, found = os.waitpid(-1, os.WNOHANG)
            code = os.waitstatus_to_exitcode(found) if ended == pid else None
        cleanup.end_descendants(me)
        cleanup.empty_folder(ground)
        os.rmdir(ground)
    finally:
        if code is not None and code < 0:  # so that the host learns how the supervisor ended
            os.kill(me, -code)
        os._exit(code or 0)
