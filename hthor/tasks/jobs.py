"""What a job demands of an object, and whether it is done.

A job is done when its object is in nobody's hands and rests at one of its ``destinations``: on or in the thing with
that id, on or in a thing of that kind, or in the room with that id. If the job has an exact ``place``, the object must
also lie within `PLACE_M` of it on the plan, or within `TOGETHER_M` for an object that several bodies carry.
"""

import math
from collections.abc import Collection

from hthor import catalog
from hthor.geometry import plane
from hthor.tasks.kind import kind_of
from hthor.types import Goal, HouseSpec, Job, Placement, Thing, ThingState

PLACE_M = 0.30
"""How far an object may lie from its exact place. A hand puts things on the free spot nearest to the intended one, and
a person remembers a spot to within about 0.1 m; but the other end of the same table does not count."""
TOGETHER_M = 0.75
"""[m] The same for an object that several carry: it follows its leader like a trailer, and is put down where it is."""


def is_done(job: Job, state: ThingState | None, house: HouseSpec) -> bool:
    """Whether the object rests at its destination, in nobody's hands; a search is never done."""
    if state is None or state.held_by or state.bearers or job.relation == "find":
        return False
    spare = TOGETHER_M if job.hands > 1 else PLACE_M
    if job.place is not None and math.dist(state.position[:2], job.place[:2]) > spare:
        return False
    if not job.destinations:
        return job.place is not None
    if job.relation == "at":
        rooms = [room for room in house.rooms if room.id in job.destinations]
        return any(plane.inside(state.position[:2], room.polygon) for room in rooms)
    return state.support in job.destinations or kind_of(state.support, house) in job.destinations


def jobs_left(goal: Goal, objects: tuple[Placement, ...], house: HouseSpec) -> tuple[Job, ...]:
    """The jobs that are not done in the arrangement."""
    lying = {
        one.id: ThingState(id=one.id, kind=one.kind, position=one.position, support=one.support) for one in objects
    }
    return tuple(job for job in goal.todo if not is_done(job, lying.get(job.target), house))


def why_impossible(job: Job, house: HouseSpec) -> str:
    """Why the job cannot be done by any arrangement in the house; empty when it can be."""
    rooms = {room.id: room for room in house.rooms}
    if job.relation == "at":
        valid = set(rooms)
    else:
        things = [thing for thing in house.things if catalog.kind(thing.kind).receptacle]
        valid = {thing.id for thing in things} | {thing.kind for thing in things}
    # One destination has to be in the house; the others may be kinds that it lacks.
    if job.destinations and not valid.intersection(job.destinations):
        return f"has destinations {', '.join(job.destinations)}; the house has {', '.join(sorted(valid))}"
    if job.place is not None and not any(plane.inside(job.place[:2], room.polygon) for room in house.rooms):
        return f"has a place in no room: {job.place}"
    if job.relation == "back":
        return "has the relation 'back', which only briefings have; a task says where the object belongs"
    if not job.destinations and job.place is None and job.relation != "find":
        return "has neither destinations nor a place"
    return ""


def destination_things(destinations: Collection[str], house: HouseSpec) -> tuple[Thing, ...]:
    """The things of the house with these ids, or of these kinds."""
    wanted = frozenset(destinations)
    return tuple(thing for thing in house.things if thing.id in wanted or thing.kind in wanted)
