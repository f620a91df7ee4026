"""Forks the process of a trial, when or before the trial begins, and waits for its end or ends it at a limit."""

import os
import select
import signal
import socket
from collections.abc import Callable, Iterable

from hthor.guest.client import trial_process
from hthor.guest.confinement import Policy, limits
from hthor.guest.confinement.landlock import Ruleset
from hthor.guest.process_tools import cleanup, cpu_affinity
from hthor.guest.protocol import trial_channel, wire
from hthor.guest.protocol.trial_channel import GuestEnds

_LOOK_MS = 50


def fork_trial(ends: GuestEnds, tell: int, order: wire.Load, held: Ruleset | None, *, first: bool = False) -> int:
    """Fork a process that runs one trial by `trial_process.run_trials`; returns its process id.

    ``tell`` is the supervisor's own socket, which no child may have.
    """
    return _forked(lambda: ends, (tell,), order, held, first=first)


class SpareProcess:
    """A child process, already confined, that waits for its trial; this saves time when a trial begins.

    It has read nothing of the agent, so nothing can pass from one trial to the next through it; nor does it have the
    pipes of the trial that is ``playing`` while it waits.
    """

    def __init__(self, playing: GuestEnds, tell: int, order: wire.Load, held: Ruleset | None) -> None:
        self._go, wait = socket.socketpair()
        secret = (*playing.handles, tell, self._go.fileno())
        self._pid = _forked(lambda: _received(wait), secret, order, held)
        wait.close()

    def start(self, ends: GuestEnds) -> int:
        """Let it run a trial with these pipes; returns its process id, or 0 if it has ended."""
        try:
            ends.send_copies(self._go)
        except BrokenPipeError:
            self.discard()
            return 0
        self._go.close()
        return self._pid

    def discard(self) -> None:
        """End it without a trial."""
        self._go.close()
        os.waitpid(self._pid, 0)


def _received(wait: socket.socket) -> GuestEnds | None:
    with wait:
        return trial_channel.receive_ends(wait)


def _forked(
    ends: Callable[[], GuestEnds | None],
    secret: Iterable[int],
    order: wire.Load,
    held: Ruleset | None,
    *,
    first: bool = False,
) -> int:
    me = os.getpid()
    pid = os.fork()
    if pid:
        return pid
    try:
        limits.die_with(me)
        for handle in secret:
            os.close(handle)
        trial_process.run_trials(ends, order, held, first=first)
        os._exit(trial_process.COMPLETED)
    finally:
        os._exit(1)


def watch_trial(pid: int, order: wire.Load, tell: int) -> wire.SupervisorToHost:
    """Wait for a trial's process to end, or end it when it exceeds a limit; returns the message to the host.

    During the wait, the host may send the number of the CPU on which it waits through the socket ``tell``.
    """
    policy = order.policy
    found = _excess(pid, policy, tell) if hasattr(os, "pidfd_open") else None
    if found:
        os.kill(pid, signal.SIGKILL)
    _, status = os.waitpid(pid, 0)
    if policy.level == "L1":
        cleanup.end_descendants(os.getpid())
    code = os.waitstatus_to_exitcode(status)
    if found:
        return wire.Failed(kind=found[0], detail=found[1])
    if code == trial_process.COMPLETED or (bool(order.words) and code == 0):
        return wire.Over()
    kind, words = cleanup.describe_exit(code)
    return wire.Failed(kind=kind, detail=f"the agent's process {'was ' * (code < 0)}{words}")


def _excess(pid: int, policy: Policy, tell: int) -> tuple[str, str] | None:
    """The limit that a process exceeds, as a fault's kind and detail; None when the process ends first."""
    ended, joined, found = os.pidfd_open(pid), None, None
    poll = select.poll()
    for handle in (ended, tell):
        poll.register(handle, select.POLLIN)
    while found is None and ended not in (ready := [handle for handle, _ in poll.poll(_LOOK_MS)]):
        if not ready:
            found = limits.find_excess(pid, policy.scratch, policy.memory_mb, policy.disk_mb)
            if joined:
                joined.release_if_threaded()
        elif (cpu := cpu_affinity.receive_cpu(tell)) >= 0:
            joined = cpu_affinity.PinnedProcess(pid, cpu)
        else:
            poll.unregister(tell)
    os.close(ended)
    return found
