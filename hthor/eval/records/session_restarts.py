"""Sessions that were run again because an agent's process was killed; `replays.json` counts them.

The kernel kills processes when memory runs out, and machines go down; that is not the agent's failure. But an agent
with unlimited retries could kill itself whenever it is losing. So each run has one restart, which the result counts.
After that, a trial in which a process is killed has the fault `killed`.
"""

from collections.abc import Iterable
from pathlib import Path

from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import RunError

NAME = "replays.json"
MOST = 1
"""How many restarts a run has. Our choice."""


class Replays(Struct, frozen=True, kw_only=True):
    """The file: the numbers of the sessions that were restarted."""

    sessions: tuple[int, ...] = ()


class SessionRestarts:
    """The restarts of one run. Each is written to the folder before it is used, so that no later command repeats it."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._sessions = load(folder).sessions

    def take(self, session: int) -> bool:
        """Use a restart for this session; False when the run has none left."""
        if len(self._sessions) >= MOST:
            return False
        self._sessions += (session,)
        _store(self._folder, self._sessions)
        return True


def load(folder: Path) -> Replays:
    """The restarts that the run in a folder has used. Raises RunError for a damaged file."""
    hint = "take the file from a copy of the run"
    return documents.read_or_none(folder / NAME, Replays, RunError, hint=hint) or Replays()


def join(folder: Path, shards: Iterable[Path]) -> None:
    """Keep the restarts of all shards with the whole run; each shard has its own allowance."""
    every = {session for part in (folder, *shards) for session in load(part).sessions}
    if every:
        _store(folder, tuple(sorted(every)))


def _store(folder: Path, sessions: tuple[int, ...]) -> None:
    jsonio.write(folder / NAME, jsonio.pretty(Replays(sessions=sessions)))
