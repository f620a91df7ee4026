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
    """The file: the participants whose sessions were restarted."""

    participants: tuple[int, ...] = ()


class SessionRestarts:
    """The restarts of one run. Each is written to the folder before it is used, so that no later command repeats it."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._participants = load(folder).participants

    def take(self, participant: int) -> bool:
        """Use a restart for this participant's session; False when the run has none left."""
        if len(self._participants) >= MOST:
            return False
        self._participants += (participant,)
        _store(self._folder, self._participants)
        return True


def load(folder: Path) -> Replays:
    """The restarts that the run in a folder has used. Raises RunError for a damaged file."""
    hint = "take the file from a copy of the run"
    return documents.read_or_none(folder / NAME, Replays, RunError, hint=hint) or Replays()


def join(folder: Path, shards: Iterable[Path]) -> None:
    """Keep the restarts of all shards with the whole run; each shard has its own allowance."""
    every = {participant for part in (folder, *shards) for participant in load(part).participants}
    if every:
        _store(folder, tuple(sorted(every)))


def _store(folder: Path, participants: tuple[int, ...]) -> None:
    jsonio.write(folder / NAME, jsonio.pretty(Replays(participants=participants)))
