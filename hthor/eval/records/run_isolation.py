"""How a run's agents are held: settled before the first trial, kept beside the log, told in the result.

A run may be played by several commands, on several levels. What counts is the weakest of them, so the run's folder
keeps it in `isolation.json`. It decides no record and is no part of the run's configuration.
"""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from hthor import documents
from hthor.errors import RunError
from hthor.guest import Isolation, IsolationError
from hthor.guest.confinement import check_level, suffices

NAME = "isolation.json"


def resolve_isolation(wanted: str, required: str, minds: Collection[str]) -> Isolation | None:
    """What will hold a run's agents; None when all of them are built in.

    Args:
        wanted: a level, or "auto". required: the least level, empty for any.
        minds: the submitted agents; one that is served elsewhere is held by nothing.

    Raises:
        IsolationError: when the level cannot be had, or is less than required.
    """
    if required:
        check_level(required, auto=False)
    if not minds:
        return None
    from hthor import guest
    from hthor.guest.host import websocket_client

    held = guest.in_force(wanted)
    if served := [mind for mind in minds if guest.is_served(mind)]:
        _demand(websocket_client.ISOLATION, required, f"{served[0]} is")
    _demand(held, required, "this machine gives" if wanted == "auto" else "--isolation asks for")
    return held


def weakest_isolation(folder: Path, held: Isolation | None, required: str) -> Isolation | None:
    """The weaker of what holds the agents now and what held them when an earlier command played a part of the run.

    Raises:
        IsolationError: when the earlier command had less than is required now.
    """
    before = load_isolation(folder)
    if before is None:
        return held
    _demand(before, required, f"{folder} has trials played at")
    return before if held is None or suffices(held.level, before.level) else held


def isolation_of(held: Isolation | None, minds: Collection[str]) -> Isolation | None:
    """What holds the agents of one of several runs: nothing where one is served; None when all are built in."""
    from hthor import guest
    from hthor.guest.host import websocket_client

    if any(guest.is_served(mind) for mind in minds):
        return websocket_client.ISOLATION
    return held if minds else None


def load_isolation(folder: Path) -> Isolation | None:
    """What held a run's agents at the least; None when all were built in.

    Raises:
        RunError: when it cannot be read.
    """
    path = folder / NAME
    if not path.is_file():
        return None
    hint = "it says how the agents were held; evaluate the run again, into another folder"
    return documents.read(path, Isolation, RunError, hint=hint)


def _demand(held: Isolation, required: str, whose: str) -> None:
    if required and not suffices(held.level, required):
        why = f" ({held.reason_not_higher})" if held.reason_not_higher else ""
        raise IsolationError(
            f"isolation {required} is required, but {whose} {held.level}{why}. See docs/isolation.md for what it takes."
        )
