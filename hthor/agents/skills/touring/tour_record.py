"""A robot's own record of where objects were when it saw them."""

from collections.abc import Iterable, Mapping

from hthor import catalog
from hthor.agents.skills.knowledge import has_door
from hthor.agents.skills.viewpoints import outline_distance
from hthor.types import Detection, Job, Observation, Thing

_ON_M = 0.05
"""[m] How far past the edge of furniture an object on it may lie, as seen from above. Our choice."""
_ABOVE_M = 0.4
"""[m] How far the middle of an object may be from the surface that it lies on. Our choice: more than half the height of
anything that can be carried by one body."""


class TourRecord:
    """Where each of some objects was, by the detection from nearest; detectors are exact or better from nearby.

    An object in somebody's hands is not recorded.
    """

    def __init__(self, targets: Iterable[str]) -> None:
        self.targets = tuple(targets)
        self.seen: dict[str, Detection] = {}

    def note(self, observation: Observation) -> None:
        """Record the objects in view."""
        for seen in observation.detections:
            if seen.family != "object" or seen.id not in self.targets or seen.held_by or seen.bearers:
                continue
            known = self.seen.get(seen.id)
            if known is None or seen.distance < known.distance:
                self.seen[seen.id] = seen

    @property
    def complete(self) -> bool:
        """Whether all objects were seen."""
        return len(self.seen) == len(self.targets)

    def job(self, target: str, things: Mapping[str, Thing]) -> Job | None:
        """The job to bring an object back to where it was; None if that was not seen.

        Args:
            things: the furniture that was seen, by id, for a detector that does not tell what an object rests on.
        """
        seen = self.seen.get(target)
        support = "" if seen is None else seen.support or _guessed_support(seen, things.values())
        if seen is None or not support:
            return None
        inside = support in things and has_door(things[support])
        return Job(target=target, relation="in" if inside else "on", destinations=(support,), place=seen.position)


def _guessed_support(seen: Detection, things: Iterable[Thing]) -> str:
    """The furniture with the surface nearest below an object; empty for none."""
    found = []
    for thing in things:
        if outline_distance(thing, seen.position[:2]) > _ON_M:
            continue
        tops = [thing.centre[2] + surface.centre[2] for surface in catalog.kind(thing.kind).rests(thing.size)]
        found += [(seen.position[2] - top, thing.id) for top in tops if 0.0 <= seen.position[2] - top <= _ABOVE_M]
    return min(found, default=(0.0, ""))[1]
