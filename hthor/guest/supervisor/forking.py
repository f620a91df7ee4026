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
from hthor.guest.protocol import trial_channel, trial_orders, wire
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
    """Wait for a trial's process to end, or end it at a limit or by order; returns the message to the host.

    During the wait, the host may send orders through the socket ``tell``.
    """
    policy = order.policy
    reason = _reason_to_end(pid, policy, tell) if hasattr(os, "pidfd_open") else None
    if reason:
        os.kill(pid, signal.SIGKILL)
    _, status = os.waitpid(pid, 0)
    if policy.level == "L1":
        cleanup.end_descendants(os.getpid())
    code = os.waitstatus_to_exitcode(status)
    if reason:
        return reason
    if code == trial_process.COMPLETED or (bool(order.words) and code == 0):
        return wire.Over()
    kind, words = cleanup.describe_exit(code)
    return wire.Failed(kind=kind, detail=f"the agent's process {'was ' * (code < 0)}{words}")


def _reason_to_end(pid: int, policy: Policy, tell: int) -> wire.SupervisorToHost | None:
    """What to tell the host when a process exceeds a limit or is to stop; None when the process ends first."""
    ended, joined = os.pidfd_open(pid), None
    reason: wire.SupervisorToHost | None = None
    poll = select.poll()
    for handle in (ended, tell):
        poll.register(handle, select.POLLIN)
    while reason is None and ended not in (ready := [handle for handle, _ in poll.poll(_LOOK_MS)]):
        if not ready:
            if found := limits.find_excess(pid, policy.scratch, policy.memory_mb, policy.disk_mb):
                reason = wire.Failed(kind=found[0], detail=found[1])
            if joined:
                joined.release_if_threaded()
            continue
        told = trial_orders.receive_order(tell)
        if told == trial_orders.CLOSED:
            poll.unregister(tell)
        elif told == trial_orders.STOP:
            reason = wire.Over()
        elif told != trial_orders.ANYWHERE:
            joined = cpu_affinity.PinnedProcess(pid, told)
        elif joined:
            joined.release()
    os.close(ended)
    return reason
