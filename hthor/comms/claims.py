"""How far the claim of a message is from the truth."""

import math
from collections.abc import Iterator

from msgspec import UNSET, UnsetType

from hthor.geometry import plane
from hthor.types import HouseSpec, Snapshot, Thing, Vec3
from hthor.types.events import Sent

OFF_M = 1.0
"""[m] A claim is false if its object is farther than this from the claimed position; our choice."""


def claim_error(name: str, position: Vec3 | None, snapshot: Snapshot, house: HouseSpec) -> float | UnsetType | None:
    """How far [m] a message's claim is from the truth; unset where nothing is claimed.

    A message claims something when it names an object and a position: that the thing of this id, or a thing of this
    kind, is there. The error is the distance from there to the nearest such thing: to the centre of an object that can
    be carried, the outline on the plan of furniture in its place, a room's edge (0 within) or a body's axis. It is None
    when there is no such thing at all; naming it is then a false claim, even without a position.

    Args:
        name: what the sender named. position: of the claim [m], as the mailbox parsed it.
        snapshot: the true state when the message is sent.
    """
    if not name:
        return UNSET
    ways = list(_distances(name, position or (0.0, 0.0, 0.0), snapshot, house))
    if position is None and ways:
        return UNSET
    return round(min(ways), 3) if ways else None


def is_false(sent: Sent) -> bool:
    """Whether the claim of a message was wrong when it was made."""
    return sent.off is not UNSET and (sent.off is None or sent.off > OFF_M)


def _distances(name: str, position: Vec3, snapshot: Snapshot, house: HouseSpec) -> Iterator[float]:
    """Distances [m] to everything that has this name, or is of the kind of this name."""
    spot = (position[0], position[1])
    for thing in house.things:
        if name in (thing.id, thing.kind) and _is_in_place(thing, snapshot):
            yield plane.distance_to_rectangle(spot, thing.centre[:2], thing.size[:2], thing.yaw)
    known = {thing.id: thing for thing in house.things}
    for state in snapshot.things.values():
        if name in (state.id, state.kind) and not (state.id in known and _is_in_place(known[state.id], snapshot)):
            yield math.dist(state.position, position)
    for room in house.rooms:
        if name in (room.id, room.kind):
            yield 0.0 if plane.inside(spot, room.polygon) else plane.distance_to_edge(spot, room.polygon)
    if name in snapshot.poses:
        yield math.dist((snapshot.poses[name].x, snapshot.poses[name].y), spot)


def _is_in_place(thing: Thing, snapshot: Snapshot) -> bool:
    """Whether the thing is where the house's plan has it."""
    state = snapshot.things.get(thing.id)
    return state is None or math.dist(state.position, thing.centre) < 1e-6
