"""The part of a trial's log that is about the task itself, after all phases before it."""

import msgspec

from hthor import rules
from hthor.episode.recording.episode_log import EpisodeLog
from hthor.types.events import PhaseBegan, Voided


def task_began(log: EpisodeLog) -> int | None:
    """The tick at which the task itself began: 0 without phases before it, None if the trial ended before."""
    began = [event for event in log.events if isinstance(event, PhaseBegan)]
    return 0 if not began else next((event.tick for event in began if not event.name), None)


def task_part(log: EpisodeLog) -> EpisodeLog:
    """The log as if the trial had begun with the task itself; the same log without phases before it.

    Events, faults, paths and the length count from the beginning of the task. What happened before is left out, except
    that faults from before are at tick 0. The journal stays as it is. Of a trial that ended before the task began, only
    its end is left, at tick 0.
    """
    began = task_began(log)
    if began == 0:
        return log
    first = log.ticks if began is None else began
    start = next((n for n, event in enumerate(log.events) if isinstance(event, PhaseBegan) and not event.name), -1)
    kept = log.events[start + 1 :] if began is not None else [one for one in log.events if isinstance(one, Voided)]
    poses = -(-first // rules.LOG_EVERY_TICKS)
    return msgspec.structs.replace(
        log,
        events=tuple(msgspec.structs.replace(event, tick=event.tick - first) for event in kept),
        faults=tuple(msgspec.structs.replace(fault, tick=max(0, fault.tick - first)) for fault in log.faults),
        paths={seat: path[poses:] or path[-1:] for seat, path in log.paths.items()},
        ticks=log.ticks - first,
    )
