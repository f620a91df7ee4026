"""One trial from reset to its end: one clock, one mailbox, one goal, one list of events. Begin with `episode`."""

from hthor.episode.episode import Episode, run_episode
from hthor.episode.episode_log import EpisodeLog, Fault
from hthor.episode.trial_world import TrialWorld

__all__ = ["Episode", "EpisodeLog", "Fault", "TrialWorld", "run_episode"]
