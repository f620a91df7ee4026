"""How a run's agents are isolated: resolved before the first trial, kept in `isolation.json`, stated in the result.

Several commands may work on one run at different levels. The weakest of them counts, so that is what the file has. It
affects no record and is not part of the run's configuration.
"""

from collections.abc import Collection
from pathlib import Path

from hthor import documents, guest
from hthor.errors import RunError
from hthor.guest import Isolation, IsolationError
from hthor.guest.confinement import check_level, suffices

NAME = "isolation.json"


def resolve_isolation(wanted: str, required: str, agents: Collection[str]) -> Isolation | None:
    """The isolation of a run's agents on this machine; None when all of them are built in.

    Args:
        wanted: a level, or "auto".
        required: the lowest acceptable level, empty for any.
        agents: the submitted agents; one that is served elsewhere is not isolated at all.

    Raises:
        IsolationError: when the level is not available, or lower than required.
    """
    if required:
        check_level(required, auto=False)
    if not agents:
        return None
    from hthor.guest.host import websocket_client

    isolation = guest.in_force(wanted)
    if served := [agent for agent in agents if guest.is_served(agent)]:
        _require(websocket_client.ISOLATION, required, f"{served[0]} is")
    _require(isolation, required, "this machine gives" if wanted == "auto" else "--isolation asks for")
    return isolation


def isolation_of(isolation: Isolation | None, agents: Collection[str]) -> Isolation | None:
    """The isolation of one run's submitted agents, given that of all runs' agents: none where one is served."""
    from hthor.guest.host import websocket_client

    if any(guest.is_served(agent) for agent in agents):
        return websocket_client.ISOLATION
    return isolation if agents else None


def weakest_isolation(folder: Path, isolation: Isolation | None, required: str) -> Isolation | None:
    """The weaker of ``isolation`` and the level at which earlier commands ran this folder's trials.

    Raises:
        IsolationError: when an earlier command had a lower level than is required now.
    """
    before = load_isolation(folder)
    if before is None:
        return isolation
    _require(before, required, f"{folder} has trials played at")
    return before if isolation is None or suffices(isolation.level, before.level) else isolation


def load_isolation(folder: Path) -> Isolation | None:
    """The weakest isolation of the run in a folder; None when all agents were built in.

    Raises:
        RunError: when the file cannot be read.
    """
    hint = "it says how the agents were isolated; evaluate the run again, into another folder"
    return documents.read_or_none(folder / NAME, Isolation, RunError, hint=hint)


def _require(isolation: Isolation, required: str, subject: str) -> None:
    if required and not suffices(isolation.level, required):
        why = f" ({isolation.reason_not_higher})" if isolation.reason_not_higher else ""
        raise IsolationError(
            f"isolation {required} is required, but {subject} {isolation.level}{why}. "
            "See docs/isolation.md for what it takes."
        )
