"""A copy of a trial in the middle of it."""

from msgspec import Struct

from hthor.comms.mailbox import MailboxState
from hthor.episode.episode_log import Fault
from hthor.episode.goal_judge import GoalState
from hthor.episode.log_writer import LogState
from hthor.types import Action, Observation


class EpisodeState(Struct, frozen=True, kw_only=True):
    """Everything that `Episode.load_state` needs to continue a trial; for use within the process that made it."""

    world: bytes
    mailbox: MailboxState
    log: LogState
    goal: GoalState
    voided: str
    paused: bool
    active: tuple[str, ...]
    observed: dict[str, Observation]
    actions: dict[str, tuple[Action, Observation | None]]
    failed: dict[str, Fault]
    steps: int
