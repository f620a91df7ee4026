"""Waits for the end of a trial's process, and ends it early if it exceeds a limit."""

import os
import select
import signal

from hthor.guest.client import trial_process
from hthor.guest.confinement import Policy, limits
from hthor.guest.process_tools import cleanup, cpu_affinity, exit_status
from hthor.guest.protocol import wire

_LOOK_MS = 50


def watch_trial(pid: int, order: wire.Load, tell: int) -> wire.SupervisorToHost:
    """Wait for a trial's process to end, or end it when it exceeds a limit; the message to the host.

    Args:
        tell: the socket to the host, which may say on which CPU it waits.
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
    kind, words = exit_status.describe_exit(code)
    return wire.Failed(kind=kind, detail=f"the agent's process {'was ' * (code < 0)}{words}")


def _excess(pid: int, policy: Policy, tell: int) -> tuple[str, str] | None:
    """The limit that a process exceeds, as a fault's kind and detail; None when it ends before."""
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
