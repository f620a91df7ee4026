"""One trial from reset to its end: one clock, one mailbox, one goal, one list of events. Begin with `episode`."""

from hthor.episode.clocks import Charged, Concurrent, DecisionClock, LockStep
from hthor.episode.episode import Episode, Observer
from hthor.episode.episode_state import EpisodeState
from hthor.episode.frames import Frames
from hthor.episode.play import begin, play, take_answers
from hthor.episode.recording.episode_log import EpisodeLog, Fault
from hthor.episode.recording.task_part import task_began, task_part
from hthor.episode.trial_world import TrialWorld

__all__ = [
    "Charged",
    "Concurrent",
    "DecisionClock",
    "Episode",
    "EpisodeLog",
    "EpisodeState",
    "Fault",
    "Frames",
    "LockStep",
    "Observer",
    "TrialWorld",
    "begin",
    "play",
    "take_answers",
    "task_began",
    "task_part",
]
