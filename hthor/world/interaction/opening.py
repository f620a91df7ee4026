"""Rules of opening and closing the doors and drawers of furniture, and doors in doorways: one rule for all.

A door or drawer moves only if the whole way that it sweeps is free of bodies and things. The body that moves it steps
out of its way and does not count, except where a shut door would enclose it. What lies in a drawer goes along with it.
An open door stops nobody; a shut one is as solid as a wall. Whether walls and furniture leave room for a door is not
checked.
"""

from collections.abc import Sequence

from hthor.errors import HthorError, UnknownName
from hthor.geometry import plane
from hthor.types import Close, Open, Opening, Thing, Vec3
from hthor.world import numbers
from hthor.world.interaction.door_sweep import DoorSweep
from hthor.world.model.geom_index import GeomIndex
from hthor.world.motion.reach import out_of_reach
from hthor.world.perception import view_frustum
from hthor.world.state.body_state import BodyState
from hthor.world.state.doors import Doors, DoorState, Doorways, in_doorway
from hthor.world.state.objects import Objects
from hthor.world.state.support_surfaces import SupportSurfaces

_DOOR_HANDLE_M = 1.0
"""[m] Height at which a hand takes hold of a door in a doorway."""


class DoorHandling:
    """Opens and closes the doors and drawers of one world."""

    def __init__(
        self,
        geoms: GeomIndex,
        objects: Objects,
        doors: Doors,
        surfaces: SupportSurfaces,
        doorways: Doorways,
        seats: Sequence[BodyState],
    ) -> None:
        self._geoms, self._objects, self._doors, self._surfaces = geoms, objects, doors, surfaces
        self._doorways, self._seats = doorways, seats
        self._sweeps: dict[str, DoorSweep] = {}

    def refusal(self, seat: BodyState, motion: Open | Close) -> str:
        """Why ``seat`` cannot carry out the motion now, empty when it can."""
        if "open" not in seat.spec.capabilities:
            return f"{seat.spec.title} cannot open or close things"
        leaf = self._doors.get(motion.thing) if isinstance(motion.thing, str) else None
        if leaf is None:
            return f"'{motion.thing!s:.40}' has no door"
        name = leaf.thing.id
        if leaf.user and leaf.user != seat.name:
            return f"{name} is being used by {leaf.user}"
        if leaf.open == isinstance(motion, Open):
            return f"{name} is already {'open' if leaf.open else 'closed'}"
        return self._far(seat, leaf) or self._in_the_way(leaf, isinstance(motion, Open), seat)

    def body_in_the_way(self, seat: BodyState, motion: Open | Close, reason: str) -> str:
        """The seat of the other body for which the motion of ``seat`` was refused; empty if the reason is another."""
        leaf = self._doors.get(motion.thing) if isinstance(motion.thing, str) else None
        why, other = ("", "") if leaf is None else self._body_in_the_way(leaf, isinstance(motion, Open), seat)
        return other if why == reason else ""

    def begin(self, seat: BodyState, motion: Open | Close) -> None:
        """Take hold of a door."""
        self._leaf(motion).user = seat.name

    def during(self, motion: Open | Close, share: float) -> None:
        """Move doors, and drawers with the objects in them, to where they are after ``share`` of the motion's time."""
        self._move(self._leaf(motion), share if isinstance(motion, Open) else 1.0 - share)

    def finish(self, motion: Open | Close) -> str:
        """Finish the motion; if something is in the way by now, move the door back and return the reason."""
        leaf, wanted = self._leaf(motion), isinstance(motion, Open)
        mover = next((seat for seat in self._seats if seat.name == leaf.user), None)
        leaf.user = ""
        reason = self._in_the_way(leaf, wanted, mover)
        self._rest(leaf, leaf.open if reason else wanted)
        return reason

    def put(self, id: str, wanted: bool) -> None:
        """See `World.set_open`."""
        wanted = numbers.truth("wanted", wanted)
        leaf = self._doors.get(id)
        if leaf is None:
            raise UnknownName("thing that opens", id, [one.thing.id for one in self._doors])
        reason = f"it is being used by {leaf.user}" if leaf.user else self._in_the_way(leaf, wanted)
        if reason:
            raise HthorError(f"{id} cannot be {'opened' if wanted else 'closed'}: {reason}")
        self._rest(leaf, wanted)

    def release(self, seat: str) -> None:
        """Move the door that a body was opening or closing back to where it was."""
        for leaf in self._doors:
            if leaf.user == seat:
                leaf.user = ""
                self._rest(leaf, leaf.open)

    def _rest(self, leaf: DoorState, opened: bool) -> None:
        self._move(leaf, 1.0 if opened else 0.0)
        leaf.open = opened
        self._doorways.update(self._doors.shut())
        self._doors.changes += 1

    def _leaf(self, motion: Open | Close) -> DoorState:
        leaf = self._doors.get(motion.thing)
        assert leaf is not None, "checked before the motion started"
        return leaf

    def _move(self, leaf: DoorState, share: float) -> None:
        """Move a door with what lies in its drawers; what leans on either is let go."""
        step, drawers = share - leaf.share, [place for place in self._surfaces.of(leaf.thing.id) if place.slides]
        riders = [self._objects.lying(place) for place in drawers]
        solids = (geom for items in riders for item in items for geom in range(item.geoms.start, item.geoms.stop))
        self._objects.wake_beside((*leaf.solids, *solids))
        for place, items in zip(drawers, riders, strict=True):
            x, y, z = (step * way for way in place.pull)
            self._objects.ride([item.id for item in items], (x, y, z))
        self._doors.swing(leaf, share)

    def _far(self, seat: BodyState, leaf: DoorState) -> str:
        name, thing = leaf.thing.id, leaf.thing
        local = plane.to_local((seat.pose.x, seat.pose.y, 0.0), thing.centre, thing.yaw)
        if leaf.opening is None and local[1] < 0.0:
            return f"{seat.name} stands behind {name}; its door is on the other side"
        point = _front_point(thing, local) if leaf.opening is None else _handle_point(leaf.opening, thing, local)
        reason = out_of_reach(seat, name, point)
        return reason or ("" if self._sees(seat, leaf, point) else f"{name} is out of sight")

    def _sees(self, seat: BodyState, leaf: DoorState, point: Vec3) -> bool:
        """Whether the eye sees the point to take hold of, that point on a pulled drawer, or the upper edge there."""
        eye, name = view_frustum.eye_position(seat.pose, seat.spec), leaf.thing.id
        x, y, _ = point
        top = leaf.thing.centre[2] + 0.45 * leaf.thing.size[2]
        ways = [place.pull for place in self._surfaces.of(name) if place.slides]
        points = [point, (x, y, top), *((x + leaf.share * way[0], y + leaf.share * way[1], top) for way in ways)]
        return any(not self._geoms.hidden(eye, place, name) for place in points)

    # ------------------------------------------------------------------------------------------------------- obstacles

    def _in_the_way(self, leaf: DoorState, opening: bool, mover: BodyState | None = None) -> str:
        """What keeps a door from moving, empty for nothing; ``mover`` is the body that moves it, at its place."""
        reason, _ = self._body_in_the_way(leaf, opening, mover)
        if reason:
            return reason
        riders = set()
        for place in self._surfaces.of(leaf.thing.id):
            if place.slides:
                lying = self._objects.lying(place)
                riders |= {item.id for item in lying}
                top = place.centre[2] + place.clearance
                tall = [item.id for item in lying if item.position[2] + item.size[2] / 2 > top]
                if tall and not opening:
                    return f"{tall[0]} is too tall for the drawer of {leaf.thing.id}"
        for item in self._objects:
            carried = item.held_by and not item.bearers  # a thing carried by its handles is in the way too
            if item.present and not carried and item.id not in riders and self._sweep(leaf).hits(item):
                return f"{item.id} is in the way"
        return ""

    def _body_in_the_way(self, leaf: DoorState, opening: bool, mover: BodyState | None) -> tuple[str, str]:
        """Why a body keeps a door from moving, and that body's seat unless it is the mover's own; empty for none."""
        sweep = self._sweep(leaf)
        for seat in self._seats:
            moves = mover is not None and seat.name == mover.name
            body = mover if mover is not None and moves else seat
            if leaf.opening is not None and not opening and in_doorway(body, leaf.opening):
                return f"{seat.name} stands in the doorway", "" if moves else seat.name
            if not moves and sweep.hits_body(body):
                return f"{seat.name} is in the way", seat.name
        return "", ""

    def _sweep(self, leaf: DoorState) -> DoorSweep:
        id = leaf.thing.id
        if id not in self._sweeps:
            self._sweeps[id] = DoorSweep(leaf.thing, leaf.parts, leaf.joints)
        return self._sweeps[id]


def _front_point(thing: Thing, local: Vec3) -> Vec3:
    """The point of the thing's front, at half its height, nearest to a point of its local frame."""
    x = max(-thing.size[0] / 2, min(thing.size[0] / 2, local[0]))
    return plane.to_house((x, thing.size[1] / 2, 0.0), thing.centre, thing.yaw)


def _handle_point(opening: Opening, thing: Thing, local: Vec3) -> Vec3:
    """The point of a doorway's line, at the height of a door handle, nearest to a point of its frame."""
    x = max(-thing.size[0] / 2, min(thing.size[0] / 2, local[0]))
    place = plane.to_house((x, 0.0, 0.0), thing.centre, thing.yaw)
    return (place[0], place[1], opening.low + _DOOR_HANDLE_M)
