"""Puts a process under a policy before it runs any code of an agent.

Each layer is tested after it is applied, so that a filter with gaps is not taken for one that works.
"""

import os
import resource
import socket
from collections.abc import Iterable

from hthor.guest.confinement import landlock, limits, paths, seccomp
from hthor.guest.confinement.isolation import Policy
from hthor.guest.confinement.kernel import Refused
from hthor.guest.confinement.landlock import Ruleset

__all__ = ["Refused", "confine_supervisor", "confine_trial", "make_ruleset"]
_PROCESSES = ("/proc",)


def make_ruleset(policy: Policy) -> Ruleset | None:
    """The Landlock rules for all trials of a guest; None at L1.

    Raises:
        Refused: when the kernel does not support them.
    """
    if policy.level == "L1":
        return None
    if reason := seccomp.unavailable():
        raise Refused(reason)
    return _ruleset(policy, policy.read, [policy.scratch])


def confine_supervisor(policy: Policy) -> None:
    """Confine the supervisor permanently, before it imports the libraries that an agent names.

    It may do what its agents may do, and what it needs to start, watch and clean up after them.

    Raises:
        Refused: when it cannot be confined.
    """
    if policy.level == "L1":
        return
    write = [os.path.dirname(policy.scratch), *([policy.compiled] if policy.compiled else [])]
    own = _ruleset(policy, (*policy.read, *_PROCESSES), write)
    own.apply()
    own.close()
    seccomp.install_supervisor_filter(execute=policy.execute)


def confine_trial(policy: Policy, held: Ruleset | None, word: bytes = b"") -> None:
    """Confine this process, which has dropped its privileges, to a policy permanently.

    Args:
        word: the token that lets it start a program, once; see `seccomp`. Empty if it may start none.

    Raises:
        Refused: when a layer cannot be applied, or does not work.
    """
    limits.set_limits(0 if policy.devices else policy.memory_mb, policy.disk_mb, processes=held is None)
    if held is None:
        return
    held.apply()
    held.close()
    seccomp.install_filter(os.getpid(), word, driven=bool(policy.devices))
    _prove()


def _ruleset(policy: Policy, read: Iterable[str], write: Iterable[str]) -> Ruleset:
    devices = {"devices": paths.DEVICES, "driven": policy.devices}
    return landlock.Ruleset(read, listed=policy.listed, write=write, execute=policy.execute, **devices)


def _prove() -> None:
    try:
        os.listdir("/")
    except PermissionError:
        pass
    else:
        raise Refused("Landlock is on, but the root folder can still be read")
    try:
        socket.socket().close()
    except PermissionError:
        pass
    else:
        raise Refused("the system call filter is on, but a socket can still be made")
    try:
        child = os.fork()
    except PermissionError:
        pass
    else:
        if child == 0:
            os._exit(0)
        os.waitpid(child, 0)
        raise Refused("the system call filter is on, but a process can still be started")
    if resource.getrlimit(resource.RLIMIT_CORE) != (0, 0):
        raise Refused("core files are not off")
