"""What a participant remembers of a tour of the house when the task itself begins.

What is remembered is what was noticed on the tour and not forgotten since (`hthor.humans.memory.object_memory`). Where
exactly on a piece of furniture an object was is remembered with an error, or not at all, see `SubgoalTracker`.
"""

from collections.abc import Iterable

import msgspec

from hthor.humans.memory.object_memory import ObjectMemory
from hthor.types import Briefing, Detection, Job


def remembered_briefing(briefing: Briefing, toured: ObjectMemory) -> Briefing:
    """The briefing for the task itself, with what the participant remembers in place of what they were not told.

    Objects whose place they do not remember are left out. If they remember none, the first job stays as it was told,
    and they do nothing about it.
    """
    jobs = tuple(job for told in briefing.todo if (job := _remembered(told, toured)) is not None)
    return msgspec.structs.replace(briefing, jobs=jobs or briefing.todo[:1], phases=())


def still_believed(jobs: Iterable[Job], toured: ObjectMemory, owner: str) -> ObjectMemory:
    """What the participant believes about where the objects of these jobs are now.

    Objects that belong back where they were may have been moved, so people look again. The others are believed to be
    where they were seen.
    """
    memory = ObjectMemory((job.target for job in jobs), owner)
    for job in jobs:
        before = toured.known.get(job.target)
        if job.place is None and before is not None:
            memory.known[job.target] = before
    return memory


def _remembered(job: Job, toured: ObjectMemory) -> Job | None:
    """A job as remembered; None if the participant does not remember where its object belongs."""
    if job.relation != "back":
        return job
    seen: Detection | None = toured.known[job.target].lies
    if seen is None or not seen.support:
        return None
    return Job(target=job.target, relation="on", destinations=(seen.support,), place=seen.position)
