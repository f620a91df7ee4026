"""What a robot knows of a task's objects, of the things that they belong on, and of people: where it saw them last."""

from collections.abc import Sequence

from hthor.types import Briefing, Detection, Job, Observation, Vec3, is_person
from hthor.types.specs import WALKERS


class KnownThings:
    """The last detection of everything that the robot has seen, and with ``object_poses`` where objects are now.

    Attributes:
        last: the last detection of each thing, by id. view: the ids of those in view now.
    """

    def __init__(self, briefing: Briefing) -> None:
        self._all_known = "object_poses" in briefing.privileges
        self._true: dict[str, Vec3] = {}
        self._held: dict[str, str] = {}
        self.last: dict[str, Detection] = {}
        self.view: frozenset[str] = frozenset()

    def see(self, observation: Observation) -> None:
        """Take what is in view now."""
        found = {one.id: one for one in observation.detections}
        self.last |= found
        self.view = frozenset(found)
        self._held |= {one.id: one.held_by for one in found.values() if one.family == "object"}
        if self._all_known:
            self._true = {state.id: state.position for state in observation.truth}
            self._held |= {state.id: state.held_by for state in observation.truth}

    def position(self, id: str) -> Vec3 | None:
        """[m] Where a thing, an object or a body is as far as is known; None if that is not known."""
        if id in self._true:
            return self._true[id]
        return self.last[id].position if id in self.last else None

    def holder(self, id: str) -> str:
        """The seat that was last known to hold an object; empty for none."""
        return self._held.get(id, "")

    def destination(self, job: Job, near: Vec3) -> Detection | None:
        """The known thing nearest to ``near`` [m] where the job's object belongs, or where its walker has to go."""
        things = (one for one in self.last.values() if one.family == "furniture")
        return nearest([one for one in things if one.id in job.destinations or one.kind in job.destinations], near)

    def topic(self, job: Job, near: Vec3) -> Detection | None:
        """What a message about a job would be about: its object, or for the relation "go" a place to go to.

        None unless that is in view, and not in a person's hands.
        """
        found = self.destination(job, near) if job.relation == "go" else self.last.get(job.target)
        if found is None or found.id not in self.view or is_person(found.held_by):
            return None
        return found

    def person(self, near: Vec3) -> Detection | None:
        """The person who is or was last seen nearest to ``near`` [m]."""
        return nearest([one for one in self.last.values() if one.family == "person"], near)

    def openable(self, state: str, near: Vec3) -> Detection | None:
        """The thing or door in view that is "open" or "closed", nearest to ``near`` [m]."""
        return nearest([self.last[id] for id in sorted(self.view) if self.last[id].state == state], near)


def target_id(job: Job) -> str:
    """The id of a job's object, or the seat of its walker."""
    return WALKERS.get(job.target, job.target) if job.relation == "go" else job.target


def nearest(found: Sequence[Detection], near: Vec3) -> Detection | None:
    """The detection nearest to a place on the floor, the first by id of several."""
    return min(found, key=lambda one: (_apart(one, near), one.id), default=None)


def _apart(one: Detection, near: Vec3) -> float:
    return (one.position[0] - near[0]) ** 2 + (one.position[1] - near[1]) ** 2
