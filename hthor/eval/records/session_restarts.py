"""Sessions of a run that were played again because an agent's process was killed: one at most, and never unseen.

Mostly that comes from outside, from a kernel that ran out of memory or a machine that goes down, and then it is not
the agent's failure. But an agent that got as many tries as it liked would take them when it is losing. So a run has
one, which the result counts; after that a trial in which a process is killed has the fault `killed`.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import RunError

NAME = "replays.json"
MOST = 1
"""How many a run has."""


class Replays(Struct, frozen=True, kw_only=True):
    """A run's file of them: the participants whose sessions were begun again."""

    participants: tuple[int, ...] = ()


class SessionRestarts:
    """Those of a run, kept in its folder before they are taken, so that no later command has them again."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._participants = load(folder).participants

    def take(self, participant: int) -> bool:
        """Have this session played again; false when the run has had its share."""
        if len(self._participants) >= MOST:
            return False
        self._participants += (participant,)
        _store(self._folder, self._participants)
        return True


def load(folder: Path) -> Replays:
    """What a run has had so far.

    Raises:
        RunError: when its file cannot be read.
    """
    path = folder / NAME
    if not path.is_file():
        return Replays()
    return documents.read(path, Replays, RunError, hint="take the file from a copy of the run")


def count(folder: Path) -> int:
    """How many a run has had so far."""
    return len(load(folder).participants)


def join(folder: Path, parts: Iterable[Path]) -> None:
    """Keep with a whole run what its shards have had; each shard has a share of its own."""
    every = [participant for part in (folder, *parts) for participant in load(part).participants]
    if every:
        _store(folder, tuple(sorted(set(every))))


def _store(folder: Path, participants: tuple[int, ...]) -> None:
    jsonio.write(folder / NAME, jsonio.pretty(Replays(participants=participants)))
