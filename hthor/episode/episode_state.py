"""A copy of a trial in the middle of it."""

from msgspec import Struct

from hthor.comms.mailbox import MailboxState
from hthor.episode.goal_judge import GoalState
from hthor.episode.participants import ParticipantsState
from hthor.episode.phases import PhaseState
from hthor.episode.recording.log_writer import LogState
from hthor.types import Observation


class EpisodeState(Struct, frozen=True, kw_only=True):
    """Everything that `Episode.load_state` needs to continue a trial; for use within the process that made it."""

    world: bytes
    mailbox: MailboxState
    log: LogState
    goal: GoalState
    phases: PhaseState
    voided: str
    paused: bool
    participants: ParticipantsState
    observed: dict[str, Observation]
    steps: int
    reported: int
