"""Which level a guest is held at: what was asked for, or the strongest that starts.

A level counts as given only once a process has really come up on it. What did not come up is not tried again by the
same process.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from hthor.guest.agent.inputs import Given
from hthor.guest.agent.reference import Reference
from hthor.guest.confinement import AUTO, LEVELS, Isolation, IsolationError, known, namespaces
from hthor.guest.host import process
from hthor.guest.host.process import Process
from hthor.guest.protocol import wire
from hthor.guest.supervisor import noop_agent

_IDLE = Path(noop_agent.__file__)
_missing: dict[str, str] = {}
_HINT = "'hthor eval --isolation auto' takes the strongest level that there is; see docs/isolation.md."


class _Terms:
    """What holds for every guest of this process that asks for nothing else."""

    isolation = AUTO
    hidden: tuple[str, ...] = ()
    given = Given()


def confine_guests(isolation: str = AUTO, hidden: tuple[str, ...] = (), given: Given | None = None) -> None:
    """Lay down how the guests of this process are held.

    Args:
        isolation: a level, or "auto".
        hidden: files and folders that no guest may read, even in its own folder.
        given: what every agent is given beyond its own folder; nothing when left out.

    Raises:
        UnknownName: when there is no such level.
    """
    _Terms.isolation, _Terms.hidden, _Terms.given = known(isolation), hidden, given or Given()


def terms() -> tuple[object, ...]:
    """What is laid down for the guests of this process."""
    return _Terms.isolation, _Terms.hidden


def given() -> Given:
    """What agents of this process are given beyond their own folders."""
    return _Terms.given


def start(
    agent: Reference,
    wanted: str | None,
    enter: Callable[[Process], wire.Confined | str],
    memory_mb: int,
    disk_mb: int,
    gpus: bool = False,
    readable: tuple[str, ...] = (),
) -> Isolation:
    """Start a guest's process at the level that is wanted, and say what holds it.

    Args:
        enter: asks a process that has just started what holds it; gives the reason if nothing does.
        readable: files and folders beyond its own that it may read.

    Raises:
        IsolationError: when that level cannot be had.
    """
    level = known(_Terms.isolation if wanted is None else wanted)
    ladder = tuple(reversed(LEVELS)) if level == AUTO else (level,)
    reason = "" if level in (AUTO, LEVELS[-1]) else f"{level} was asked for"
    why = ""
    for rung in ladder:
        missing = _missing.get(rung) or (namespaces.unavailable() if rung == "L3" else "")
        if not missing:
            try:
                one = process.start(
                    agent,
                    rung,
                    hidden=_Terms.hidden,
                    memory_mb=memory_mb,
                    disk_mb=disk_mb,
                    gpus=gpus,
                    readable=readable,
                )
            except OSError as error:  # such as too many files beside this agent to name one by one
                place = f": {error.filename}" if error.filename else ""
                why = f"its process could not be started: {error.strerror}{place}"
                reason = reason or f"{rung}: {why}"
                continue
            said = enter(one)
            if isinstance(said, wire.Confined):
                return _described(rung, said, memory_mb, reason)
            missing = namespaces.excuse(said) if rung == "L3" else said
        _missing[rung] = why = missing
        reason = reason or f"{rung}: {missing}"
    raise IsolationError(f"isolation {level} cannot be had on this machine: {why}. {_HINT}")


def _described(level: str, said: wire.Confined, memory_mb: int, reason: str) -> Isolation:
    here = {name: os.readlink(f"/proc/self/ns/{name}") for name in said.spaces}
    return Isolation(
        level=level,
        landlock_abi=said.landlock_abi,
        seccomp=said.seccomp,
        netns=bool(here) and said.spaces["net"] != here["net"],
        pidns=bool(here) and said.spaces["pid"] != here["pid"],
        memory=f"{memory_mb} MB, by limit and watch",
        reason_not_higher=reason,
    )


def in_force(wanted: str = AUTO) -> Isolation:
    """What holds a guest on this machine, found out by starting one that does nothing.

    Raises:
        IsolationError: when the level cannot be had.
    """
    from hthor.guest.host.guest import load_info

    return load_info(_IDLE, isolation=wanted, given=Given()).isolation
