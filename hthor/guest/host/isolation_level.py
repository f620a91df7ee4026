"""At which level of isolation a guest runs: the one asked for, or the strongest that starts.

A level counts only once a process has really come up on it.
"""

import os
from collections.abc import Callable

from hthor.guest.confinement import AUTO, LEVELS, Isolation, IsolationError, namespaces
from hthor.guest.host.process import GuestProcess
from hthor.guest.protocol import wire

_HINT = "'hthor eval --isolation auto' takes the strongest level that there is; see docs/isolation.md."


def start_at_level(
    level: str,
    launch: Callable[[str], GuestProcess],
    enter: Callable[[GuestProcess], wire.Confined | str],
    unavailable: dict[str, str],
    memory_mb: int,
) -> Isolation:
    """Start a guest's process at a level, and say what holds it.

    Args:
        level: one of `LEVELS`, or "auto".
        launch: starts a process at a level; raises OSError when it cannot.
        enter: asks a process that has just started what holds it; returns the reason if nothing does.
        unavailable: levels that did not start before, with the reason; those that do not start now are added.
        memory_mb: the memory limit, for the description.

    Raises:
        IsolationError: when that level does not start.
    """
    ladder = tuple(reversed(LEVELS)) if level == AUTO else (level,)
    not_higher = "" if level in (AUTO, LEVELS[-1]) else f"{level} was asked for"
    reason = ""
    for rung in ladder:
        reason = unavailable.get(rung) or (namespaces.unavailable() if rung == "L3" else "")
        if not reason:
            try:
                process = launch(rung)
            except OSError as error:  # such as too many files beside this agent to name one by one
                place = f": {error.filename}" if error.filename else ""
                reason = f"its process could not be started: {error.strerror}{place}"
                not_higher = not_higher or f"{rung}: {reason}"
                continue
            answer = enter(process)
            if isinstance(answer, wire.Confined):
                return _describe(rung, answer, memory_mb, not_higher)
            reason = namespaces.failure_reason(answer) if rung == "L3" else answer
        unavailable[rung] = reason
        not_higher = not_higher or f"{rung}: {reason}"
    raise IsolationError(f"isolation {level} cannot be had on this machine: {reason}. {_HINT}")


def _describe(level: str, confined: wire.Confined, memory_mb: int, not_higher: str) -> Isolation:
    here = {name: os.readlink(f"/proc/self/ns/{name}") for name in confined.spaces}
    return Isolation(
        level=level,
        landlock_abi=confined.landlock_abi,
        seccomp=confined.seccomp,
        netns=bool(here) and confined.spaces["net"] != here["net"],
        pidns=bool(here) and confined.spaces["pid"] != here["pid"],
        memory=f"{memory_mb} MB, by limit and watch",
        reason_not_higher=not_higher,
    )
