"""Rules of the hand: which objects a body may pick, place and drop, and the reasons for refusals.

The rules are checked when a motion starts and again when it ends, which is when it takes effect. A hand reaches points
in front of the body (within a quarter turn of its heading), within its reach and heights, and in a straight line of
sight from its eye; the camera need not point there. For opening and closing see `hthor.world.interaction.opening`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from hthor import catalog, rules
from hthor.types import Close, Drop, HouseSpec, Open, Outcome, Pick, Place, Vec3
from hthor.types.events import Closed, Dropped, Event, InWay, Opened, Picked, Placed, Refused
from hthor.world import numbers
from hthor.world.carrying.joint_carrying import JointCarrying
from hthor.world.interaction.opening import DoorHandling
from hthor.world.model.composer_env import QPose
from hthor.world.model.geom_index import GeomIndex
from hthor.world.model.geoms import quaternion
from hthor.world.motion.locomotion import TickResult, duration_ticks
from hthor.world.motion.reach import held_pose, out_of_reach, out_of_sight, too_heavy
from hthor.world.perception import view_frustum
from hthor.world.records import HandAction, Handling
from hthor.world.state import support_surfaces
from hthor.world.state.body_state import BodyState
from hthor.world.state.doors import Doors
from hthor.world.state.movable_object import MovableObject
from hthor.world.state.objects import Objects
from hthor.world.state.overlap_test import FLOOR, OverlapTest
from hthor.world.state.support_surfaces import SupportSurfaces

_SPOT_TRIES = 60
"""How many free spots of one surface are tried before the surface counts as out of sight."""
_NO_POSE: QPose = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


class HandMotion:
    """A motion of the hand, which lasts the body's ``handling`` time; ``done`` is how many ticks of it are over."""

    of_hands = True

    def __init__(self, seat: BodyState, motion: HandAction, hands: Manipulation, done: int = 0) -> None:
        self._seat, self._motion, self._hands = seat, motion, hands
        self._done, self._ticks = done, duration_ticks(seat.spec.handling)
        if not done:
            hands.begin(seat, motion)

    def advance(self, tick: int) -> TickResult:
        """Carry the motion on by one tick; it takes effect at its last tick."""
        self._done += 1
        self._hands.during(self._motion, self._done / self._ticks)
        if self._done < self._ticks:
            return None, ()
        name, verb = self._seat.name, motion_name(self._motion)
        held = self._seat.holding
        reason = self._hands.finish(self._seat, self._motion, tick)
        news = self._hands.news()
        if reason:
            by = self._hands.body_in_the_way(self._seat, self._motion, reason)
            return Outcome(motion=verb, ok=False, reason=reason, by=by), refusal_events(tick, name, verb, reason, by)
        return Outcome(motion=verb, ok=True), news or (_event(self._motion, held, tick, name),)

    def state(self) -> Handling:
        """All that it needs to go on later."""
        return Handling(self._motion, self._done)


class Manipulation:
    """Picks, places and drops objects, and opens and closes things, for the bodies of one world."""

    def __init__(
        self,
        house: HouseSpec,
        geoms: GeomIndex,
        objects: Objects,
        doors: Doors,
        surfaces: SupportSurfaces,
        overlap: OverlapTest,
        door_handling: DoorHandling,
        joint_carrying: JointCarrying,
    ) -> None:
        self._things = {thing.id: thing for thing in house.things}
        self._geoms, self._objects, self._doors, self._surfaces = geoms, objects, doors, surfaces
        self._overlap, self._door_handling, self.joint_carrying = overlap, door_handling, joint_carrying
        self._news: tuple[Event, ...] = ()

    def news(self) -> tuple[Event, ...]:
        """The additional events of the motion that ended last, if any; each is returned only once."""
        news, self._news = self._news, ()
        return news

    def refusal(self, seat: BodyState, motion: HandAction) -> str:
        """Why ``seat`` cannot carry out the motion now, empty when it can."""
        if isinstance(motion, (Open, Close)):
            return self._door_handling.refusal(seat, motion)
        if isinstance(motion, Pick):
            return self._pick(seat, motion)
        if self.joint_carrying.of(seat) is not None:
            return self._refused(seat, motion)
        return self._drop(seat) if isinstance(motion, Drop) else self._place(seat, motion)[0]

    def body_in_the_way(self, seat: BodyState, motion: object, reason: str) -> str:
        """The seat of the other body for which a motion of ``seat`` was refused; empty if the reason is another."""
        doors = self._door_handling
        return doors.body_in_the_way(seat, motion, reason) if isinstance(motion, (Open, Close)) else ""

    def begin(self, seat: BodyState, motion: HandAction) -> None:
        """Begin the motion: take hold of a door, if it opens or closes one."""
        if isinstance(motion, (Open, Close)):
            self._door_handling.begin(seat, motion)

    def during(self, motion: HandAction, share: float) -> None:
        """Move doors to where they are after ``share`` of the motion's time."""
        if isinstance(motion, (Open, Close)):
            self._door_handling.during(motion, share)

    def finish(self, seat: BodyState, motion: HandAction, tick: int) -> str:
        """Let the motion take effect at ``tick``, or return the reason if a rule now forbids it."""
        if isinstance(motion, (Open, Close)):
            return self._door_handling.finish(motion)
        if isinstance(motion, Pick):
            return self._pick(seat, motion) or self._take(seat, motion.object, tick)
        if self.joint_carrying.of(seat) is not None:
            return self._refused(seat, motion) or self._let_go(seat, tick)
        if isinstance(motion, Drop):
            return self._drop(seat) or self._put(seat, held_pose(seat, self._held(seat).size), "")
        reason, spot = self._place(seat, motion)
        return reason or self._put(seat, spot, motion.on)

    # ------------------------------------------------------------------------------------------------------- pick

    def _pick(self, seat: BodyState, motion: Pick) -> str:
        if "pick" not in seat.spec.capabilities:
            return f"{seat.spec.title} cannot pick things up"
        if seat.holding:
            return f"{seat.name} already holds {seat.holding}"
        name = motion.object if isinstance(motion.object, str) else ""
        item = self._objects.get(name)
        if item is None and name in self._things and self._objects.known(name) is None:
            return f"{name} is fixed, and cannot be picked up"
        if item is None:
            return f"there is no object '{motion.object!s:.40}' to pick up"
        return self.out_of_hand(seat, item)

    def out_of_hand(self, seat: BodyState, item: MovableObject) -> str:
        """Why ``seat``, from its place and with an empty hand, could not pick up an object; empty when it could."""
        if item.held_by and not item.bearers:
            return f"{item.id} is held by {item.held_by}"
        if self.joint_carrying.takes(seat, item):
            return self.joint_carrying.refusal(seat, item) or out_of_sight(seat, item, self._geoms)
        return (
            out_of_reach(seat, item.id, item.position) or out_of_sight(seat, item, self._geoms) or too_heavy(seat, item)
        )

    def _take(self, seat: BodyState, id: str, tick: int) -> str:
        item = self._objects.get(id)
        if item is not None and self.joint_carrying.takes(seat, item):
            self._news = self.joint_carrying.hold(seat, item, tick)
            return ""
        seat.holding = id
        size = self._held(seat).size
        self._objects.take(id, seat.name, lambda: held_pose(seat, size))
        return ""

    def _held(self, seat: BodyState) -> MovableObject:
        item = self._objects.get(seat.holding)
        assert item is not None, "what is held is in the world"
        return item

    # --------------------------------------------------------------------------------------------- joint carrying

    @staticmethod
    def _refused(seat: BodyState, motion: Place | Drop) -> str:
        """Why a thing held by its handles cannot be put there: it can only be put on the floor below it."""
        if isinstance(motion, Drop) or motion.on == FLOOR:
            return ""
        return f"{seat.holding} is held by its handles; drop it, or place it on '{FLOOR}': it is put down where it is"

    def _let_go(self, seat: BodyState, tick: int) -> str:
        self._news = self.joint_carrying.release(seat, tick)
        return ""

    # ------------------------------------------------------------------------------------------------------- drop

    def _drop(self, seat: BodyState) -> str:
        if "pick" not in seat.spec.capabilities:
            return f"{seat.spec.title} cannot drop things"
        item = self._objects.get(seat.holding)
        if item is None:
            return f"{seat.name} holds nothing to drop"
        where = self._overlap.inside(item)
        if not where:
            x, y, z = item.position
            met = self._geoms.first((seat.pose.x, seat.pose.y, z), (x, y, z), item.id)
            if met:
                return f"{met} is between {seat.name} and {item.id}"
            where = seat.loose.wedged(item) if seat.loose is not None else ""
        return f"{item.id} would be inside {where}" if where else ""

    # ------------------------------------------------------------------------------------------------------ place

    def _place(self, seat: BodyState, motion: Place) -> tuple[str, QPose]:
        if "pick" not in seat.spec.capabilities:
            return f"{seat.spec.title} cannot place things", _NO_POSE
        item = self._objects.get(seat.holding)
        if item is None:
            return f"{seat.name} holds nothing to place", _NO_POSE
        if motion.position is not None and not _is_point(motion.position):
            return f"position must be three finite numbers or None, got {numbers.quoted(motion.position)}", _NO_POSE
        surfaces = self._surfaces.of(motion.on) if isinstance(motion.on, str) else ()
        if not surfaces:
            return f"nothing can be placed on '{motion.on!s:.40}'", _NO_POSE
        surfaces = self._accessible(motion, surfaces)
        return self._spot(seat, item, motion, surfaces) if surfaces else (f"{motion.on} is closed", _NO_POSE)

    def no_spot(self, seat: BodyState, on: str) -> str:
        """Why ``seat`` could not place what it holds on or in a thing from where it stands; empty when it could."""
        motion = Place(on=on)
        return self._refused(seat, motion) if self.joint_carrying.of(seat) is not None else self._place(seat, motion)[0]

    def is_shut(self, on: str) -> bool:
        """Whether nothing can be placed on or in a thing before it is opened."""
        surfaces = self._surfaces.of(on)
        return bool(surfaces) and not self._accessible(Place(on=on), surfaces)

    def _accessible(
        self, motion: Place, surfaces: tuple[support_surfaces.SupportSurface, ...]
    ) -> tuple[support_surfaces.SupportSurface, ...]:
        """The surfaces that are not behind a closed door. If no position is given, a thing's
        open surfaces are preferred to its drawers where objects are put *on* it.
        """
        bare = tuple(place for place in surfaces if not place.inside)
        leaf = self._doors.get(motion.on)
        if leaf is not None and not leaf.open:
            return bare
        on = catalog.kind(self._things[motion.on].kind).relation == "on"
        return bare if bare and on and motion.position is None else surfaces

    def _spot(
        self, seat: BodyState, item: MovableObject, motion: Place, surfaces: tuple[support_surfaces.SupportSurface, ...]
    ) -> tuple[str, QPose]:
        """The free place nearest to the wanted position, or to the hand, on any of the surfaces; or why there is none.

        The object lies along the thing, or across it if it does not fit along. A surface is in reach if its nearest
        point is, so the object's centre may be farther away by half its width.
        """
        wanted = motion.position or held_pose(seat, item.size)[:3]
        nearest = min(surfaces, key=lambda place: place.distance(seat.pose.x, seat.pose.y))
        gap = nearest.distance(seat.pose.x, seat.pose.y)
        if gap > seat.spec.reach:
            return f"{motion.on} is {gap:.2f} m away; reach is {seat.spec.reach:.2f} m", _NO_POSE
        boxes = self._geoms.boxes_but(motion.on)
        lean = max(item.size[:2]) / 2 + rules.GRID_M
        w, d, h = item.size
        reason = f"no room on {motion.on}: {item.id} needs {w:.2f} x {d:.2f} m"
        for size, turn in (((w, d, h), 0.0), ((d, w, h), math.pi / 2)):
            found: list[tuple[float, QPose]] = []
            for place in surfaces:
                free = support_surfaces.free_spots(place, size, boxes, wanted)
                near = [centre for centre in free if not out_of_reach(seat, motion.on, centre, lean)]
                visible = next(self._visible(seat, near), None)
                if visible is not None:
                    pose = (*visible, *quaternion(place.yaw + turn))
                    found.append((round(math.dist(visible, wanted), 6), pose))
                elif near:
                    reason = f"the free part of {motion.on} is out of sight"
                elif free and reason.startswith("no room"):
                    reason = out_of_reach(seat, motion.on, free[0], lean)
            if found:
                return "", min(found)[1]
        return reason, _NO_POSE

    def _visible(self, seat: BodyState, centres: list[Vec3]) -> Iterator[Vec3]:
        eye = view_frustum.eye_position(seat.pose, seat.spec)
        return (centre for centre in centres[:_SPOT_TRIES] if not self._geoms.hidden(eye, centre))

    def _put(self, seat: BodyState, pose: QPose, on: str) -> str:
        id, seat.holding = seat.holding, ""
        self._objects.put(id, pose, on)
        return ""


def refusal_events(tick: int, seat: str, motion: str, reason: str, by: str) -> tuple[Event, ...]:
    """The events of a motion that is refused; ``by`` is the seat of the body in whose way it is, if any."""
    refused = Refused(tick=tick, seat=seat, motion=motion, reason=reason)
    return (refused, InWay(tick=tick, seat=seat, by=by)) if by else (refused,)


def motion_name(motion: object) -> str:
    """The motion's name, such as "pick"."""
    return type(motion).__name__.lower()


def _event(motion: HandAction, held: str, tick: int, seat: str) -> Event:
    """The event of a motion that took effect; ``held``: the object in hand before it."""
    match motion:
        case Pick():
            return Picked(tick=tick, seat=seat, object=motion.object)
        case Place():
            return Placed(tick=tick, seat=seat, object=held, on=motion.on)
        case Drop():
            return Dropped(tick=tick, seat=seat, object=held)
        case Open():
            return Opened(tick=tick, seat=seat, thing=motion.thing)
        case Close():
            return Closed(tick=tick, seat=seat, thing=motion.thing)


def _is_point(position: object) -> bool:
    if not isinstance(position, (tuple, list)):
        return False
    return len(position) == 3 and all(numbers.is_finite(value) for value in position)
