"""A trial's process, forked when its trial begins or before; knows nothing of what it plays."""

from __future__ import annotations

import os

from hthor.guest import child, wire
from hthor.guest.confinement import limits
from hthor.guest.confinement.landlock import Ruleset
from hthor.guest.senses import Pipe


def fork(pipe: Pipe, tell: int, order: wire.Load, held: Ruleset | None, *, first: bool = False) -> int:
    """A child that plays one trial; its process id.

    Args:
        tell: the keeper's own pipe, which no child may have. held: rules for files. first: as `child.serve`.
    """
    return _forked(pipe, (tell,), order, held, first, -1)


class Spare:
    """A child that is held already, and waits for its trial without having seen anything of the agent.

    So nothing of one trial can reach the next by it: what it imports, it imports when its turn has come.
    """

    def __init__(self, pipe: Pipe, tell: int, order: wire.Load, held: Ruleset | None) -> None:
        wait, self._go = os.pipe()
        self._pid = _forked(pipe, (tell, self._go), order, held, False, wait)
        os.close(wait)

    def start(self) -> int:
        """Let it play; its process id, or 0 if it is gone."""
        try:
            os.write(self._go, b"!")
        except BrokenPipeError:
            os.waitpid(self._pid, 0)
            return 0
        finally:
            os.close(self._go)
        return self._pid


def _forked(pipe: Pipe, secret: tuple[int, ...], order: wire.Load, held: Ruleset | None, first: bool, wait: int) -> int:
    me = os.getpid()
    pid = os.fork()
    if pid:
        return pid
    try:
        limits.die_with(me)
        for handle in secret:
            os.close(handle)
        pipe.own()
        child.serve(pipe, order, held, first=first, wait=wait)
        os._exit(child.ORDERLY)
    finally:
        os._exit(1)
