"""Laws of the hand: what a body may pick, place, open and close, and why not; knows nothing of goals.

Every law is checked when a motion starts and once more when it ends, and takes effect only then. A hand reaches what
lies in front of the body (within a quarter turn of its heading), within its reach and height, in a straight line of
sight of its eye. The camera need not point there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from hthor import catalog, geometry, rules
from hthor.types import Close, Event, HouseSpec, Open, Outcome, Pick, Place, Thing, Vec3
from hthor.world import bodies, geoms, places, sight
from hthor.world.doors import Doors, Leaf
from hthor.world.env import QPose
from hthor.world.motion import Step, ticks
from hthor.world.objects import Item, Objects
from hthor.world.places import Places
from hthor.world.scene import Scene
from hthor.world.seats import Seat

Handling = Pick | Place | Open | Close

_PAST = {"pick": "picked", "place": "placed", "open": "opened", "close": "closed"}
_TRIES = 60
"""Free spots of one surface that are looked at before it counts as out of sight."""


class Handing:
    """A hand at work for as long as its body's ``handling`` says."""

    def __init__(self, seat: Seat, motion: Handling, hands: Hands) -> None:
        self._seat, self._motion, self._hands = seat, motion, hands
        self._done, self._ticks = 0, ticks(seat.spec.handling)
        hands.begin(seat, motion)

    def advance(self, tick: int) -> Step:
        """One tick of it; at the last one it takes effect."""
        self._done += 1
        self._hands.during(self._motion, self._done / self._ticks)
        if self._done < self._ticks:
            return None, ()
        name, verb = self._seat.name, verb_of(self._motion)
        held = self._seat.holding
        reason = self._hands.finish(self._seat, self._motion)
        if reason:
            data = {"motion": verb, "reason": reason}
            return Outcome(motion=verb, ok=False, reason=reason), (
                Event(tick=tick, seat=name, kind="refused", data=data),
            )
        event = Event(tick=tick, seat=name, kind=_PAST[verb], data=_data(self._motion, held))
        return Outcome(motion=verb, ok=True), (event,)


class Hands:
    """What bodies can do to the things of one world."""

    def __init__(self, house: HouseSpec, scene: Scene, objects: Objects, doors: Doors, surfaces: Places) -> None:
        self._things = {thing.id: thing for thing in house.things}
        self._scene, self._objects, self._doors, self._places = scene, objects, doors, surfaces

    def refusal(self, seat: Seat, motion: Handling) -> str:
        """Why ``seat`` cannot do it now, empty when it can."""
        if isinstance(motion, Pick):
            return self._pick(seat, motion)
        if isinstance(motion, Place):
            return self._place(seat, motion)[0]
        return self._swing(seat, motion)

    def begin(self, seat: Seat, motion: Handling) -> None:
        """Take hold of a door."""
        if isinstance(motion, (Open, Close)):
            self._leaf(motion).user = seat.name

    def during(self, motion: Handling, share: float) -> None:
        """``share`` of the motion's time has passed: doors swing along."""
        if isinstance(motion, (Open, Close)):
            self._doors.swing(self._leaf(motion), share if isinstance(motion, Open) else 1.0 - share)

    def finish(self, seat: Seat, motion: Handling) -> str:
        """Do it, unless a law forbids it by now; the reason then."""
        if isinstance(motion, Pick):
            return self._pick(seat, motion) or self._take(seat, motion.object)
        if isinstance(motion, Place):
            reason, spot = self._place(seat, motion)
            return reason or self._put(seat, motion.on, spot)
        leaf = self._leaf(motion)
        leaf.open, leaf.user = isinstance(motion, Open), ""
        self._doors.changes += 1
        return ""

    # ------------------------------------------------------------------------------------------------------- pick

    def _pick(self, seat: Seat, motion: Pick) -> str:
        if "pick" not in seat.spec.capabilities:
            return f"{seat.spec.title} cannot pick things up"
        if seat.holding:
            return f"{seat.name} already holds {seat.holding}"
        item = self._objects.get(motion.object) if isinstance(motion.object, str) else None
        if item is None:
            return f"there is no object '{motion.object!s:.40}' to pick up"
        if item.held_by:
            return f"{item.id} is held by {item.held_by}"
        return self._out_of_reach(seat, item.id, item.position) or self._unseen(seat, item) or _too_heavy(seat, item)

    def _unseen(self, seat: Seat, item: Item) -> str:
        eye = sight.eye(seat.pose, seat.spec)
        if all(self._scene.hidden(eye, point, item.id) for point in sight.points(item.position, item.size)):
            return f"{item.id} is out of sight"
        return ""

    def _take(self, seat: Seat, id: str) -> str:
        seat.holding = id
        self._objects.take(id, seat.name, lambda: in_hand(seat))
        return ""

    # ------------------------------------------------------------------------------------------------------ place

    def _place(self, seat: Seat, motion: Place) -> tuple[str, Vec3]:
        nowhere = (0.0, 0.0, 0.0)
        if "pick" not in seat.spec.capabilities:
            return f"{seat.spec.title} cannot place things", nowhere
        item = self._objects.get(seat.holding)
        if item is None:
            return f"{seat.name} holds nothing to place", nowhere
        if motion.position is not None and not _is_point(motion.position):
            return f"position must be three finite numbers or None, got {motion.position!r:.60}", nowhere
        surfaces = self._places.of(motion.on) if isinstance(motion.on, str) else ()
        if not surfaces:
            return f"nothing can be placed on '{motion.on!s:.40}'", nowhere
        leaf = self._doors.get(motion.on)
        if leaf is not None and not leaf.open:
            surfaces = tuple(place for place in surfaces if not place.inside)
            if not surfaces:
                return f"{motion.on} is closed", nowhere
        return self._spot(seat, item, motion, surfaces)

    def _spot(self, seat: Seat, item: Item, motion: Place, surfaces: tuple[places.Place, ...]) -> tuple[str, Vec3]:
        """The place nearest to the wanted position, or to the hand, on any of the surfaces; or why there is none.

        A surface is in reach by its nearest point, so the object's centre may lie its own half width farther.
        """
        wanted = motion.position or in_hand(seat)[:3]
        nearest = min(surfaces, key=lambda place: place.distance(seat.pose.x, seat.pose.y))
        gap = nearest.distance(seat.pose.x, seat.pose.y)
        if gap > seat.spec.reach:
            return f"{motion.on} is {gap:.2f} m away; reach is {seat.spec.reach:.2f} m", wanted
        boxes = self._scene.boxes(motion.on)
        lean = max(item.size[:2]) / 2 + rules.GRID_M
        found: list[tuple[float, Vec3]] = []
        reason = f"no room on {motion.on}: {item.id} needs {item.size[0]:.2f} x {item.size[1]:.2f} m"
        for place in surfaces:
            free = places.candidates(place, item.size, boxes, wanted)
            near = [centre for centre in free if not self._out_of_reach(seat, motion.on, centre, lean)]
            visible = next(self._visible(seat, near), None)
            if visible is not None:
                found.append((round(math.dist(visible, wanted), 6), visible))
            elif near:
                reason = f"the free part of {motion.on} is out of sight"
            elif free and reason.startswith("no room"):
                reason = self._out_of_reach(seat, motion.on, free[0], lean)
        return ("", min(found)[1]) if found else (reason, wanted)

    def _visible(self, seat: Seat, centres: list[Vec3]) -> Iterator[Vec3]:
        eye = sight.eye(seat.pose, seat.spec)
        return (centre for centre in centres[:_TRIES] if not self._scene.hidden(eye, centre))

    def _put(self, seat: Seat, on: str, spot: Vec3) -> str:
        id, seat.holding = seat.holding, ""
        yaw = self._things[on].yaw
        self._objects.put(id, (*spot, *geoms.quaternion(yaw)), on)
        return ""

    # ------------------------------------------------------------------------------------------------ open and close

    def _swing(self, seat: Seat, motion: Open | Close) -> str:
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
        local = geometry.to_local((seat.pose.x, seat.pose.y, 0.0), leaf.thing.centre, leaf.thing.yaw)
        if local[1] < 0.0:
            return f"{seat.name} stands behind {name}; its door is on the other side"
        point = _front(leaf.thing, local)
        reason = self._out_of_reach(seat, name, point)
        if not reason and self._scene.hidden(sight.eye(seat.pose, seat.spec), point, name):
            return f"{name} is out of sight"
        return reason

    def _leaf(self, motion: Open | Close) -> Leaf:
        leaf = self._doors.get(motion.thing)
        assert leaf is not None, "checked before the motion started"
        return leaf

    # ------------------------------------------------------------------------------------------------------ common

    def _out_of_reach(self, seat: Seat, name: str, point: Vec3, lean: float = 1e-6) -> str:
        """Why a hand cannot get to ``point`` [m], the reach of the arm stretched by ``lean`` [m]."""
        pose, spec = seat.pose, seat.spec
        dx, dy = point[0] - pose.x, point[1] - pose.y
        if math.hypot(dx, dy) > spec.reach + lean:
            return f"{name} is {math.hypot(dx, dy):.2f} m away; reach is {spec.reach:.2f} m"
        if dx * math.cos(pose.yaw) + dy * math.sin(pose.yaw) < -1e-6:
            return f"{name} is behind {seat.name}; turn towards it"
        if not spec.reach_low - 1e-6 <= point[2] <= spec.reach_high + 1e-6:
            return f"{name} is at height {point[2]:.2f} m; reach is {spec.reach_low:.2f} to {spec.reach_high:.2f} m"
        return ""


def in_hand(seat: Seat) -> QPose:
    """Pose of what ``seat`` carries: in front of the chest, turned with the body."""
    ahead, left, up = bodies.hand(seat.spec)
    cos, sin = math.cos(seat.pose.yaw), math.sin(seat.pose.yaw)
    x, y = seat.pose.x + cos * ahead - sin * left, seat.pose.y + sin * ahead + cos * left
    return (x, y, up, *geoms.quaternion(seat.pose.yaw))


def _too_heavy(seat: Seat, item: Item) -> str:
    if item.mass > seat.spec.strength:
        title = catalog.kind(item.kind).title
        return f"{title} weighs {item.mass:.1f} kg; {seat.spec.title} lifts {seat.spec.strength:.1f} kg"
    return ""


def verb_of(motion: object) -> str:
    """The motion's name, such as "pick"."""
    return type(motion).__name__.lower()


def _data(motion: Handling, held: str) -> dict[str, str]:
    if isinstance(motion, Place):
        return {"object": held, "on": motion.on}
    return {"object": motion.object} if isinstance(motion, Pick) else {"thing": motion.thing}


def _front(thing: Thing, local: Vec3) -> Vec3:
    """The point of the thing's front, at half its height, that is nearest to a place in its local frame."""
    x = max(-thing.size[0] / 2, min(thing.size[0] / 2, local[0]))
    return geometry.to_house((x, thing.size[1] / 2, 0.0), thing.centre, thing.yaw)


def _is_point(position: object) -> bool:
    return (
        isinstance(position, (tuple, list))
        and len(position) == 3
        and all(isinstance(value, (int, float)) and math.isfinite(value) for value in position)
    )
