"""Forks the process of a trial, when the trial begins or before."""

import os
import socket
from collections.abc import Callable, Iterable

from hthor.guest.client import trial_process
from hthor.guest.confinement import limits
from hthor.guest.confinement.landlock import Ruleset
from hthor.guest.protocol import trial_channel, wire
from hthor.guest.protocol.trial_channel import GuestEnds


def fork_trial(ends: GuestEnds, tell: int, order: wire.Load, held: Ruleset | None, *, first: bool = False) -> int:
    """Fork a process that runs one trial; its process id.

    Args:
        ends: the trial's pipes. tell: the supervisor's own socket, which no child may have.
        held: rules for files. first: as in `trial_process.run_trials`.
    """
    return _forked(lambda: ends, (tell,), order, held, first=first)


class SpareProcess:
    """A child that is confined already, and waits for its trial; it saves the time to fork and confine one.

    It has seen nothing of the agent, so that nothing of one trial can reach the next through it.

    Args:
        playing: the pipes of the trial that runs meanwhile, which it must not have.
    """

    def __init__(self, playing: GuestEnds, tell: int, order: wire.Load, held: Ruleset | None) -> None:
        self._go, wait = socket.socketpair()
        secret = (*playing.handles, tell, self._go.fileno())
        self._pid = _forked(lambda: _received(wait), secret, order, held)
        wait.close()

    def start(self, ends: GuestEnds) -> int:
        """Let it run a trial with these pipes; its process id, or 0 if it has ended."""
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
