"""Looks up what is in a house by id, kind and room, and what a body could do with it."""

from hthor import catalog
from hthor.errors import UnknownName
from hthor.geometry import plane
from hthor.types import Pose, Room, Thing, ThingState, Vec2, Vec3
from hthor.world.perception import view_frustum
from hthor.world.simulation import Simulation
from hthor.world.state.body_state import BodyState


class Things:
    """The furniture, objects and bodies of one simulation by name; see `World` for each call."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    def objects(self, kind: str = "", room: str = "") -> tuple[ThingState, ...]:
        """See `World.objects`."""
        _check_kind(kind)
        where = self.room(room).polygon if room else ()
        states = (item.state() for item in self._simulation.parts.objects if item.present and kind in ("", item.kind))
        return tuple(state for state in states if not where or plane.inside(state.position[:2], where))

    def furniture(self, kind: str = "", room: str = "") -> tuple[Thing, ...]:
        """See `World.furniture`."""
        _check_kind(kind)
        where = self.room(room).id if room else ""
        things = self._simulation.contents.statics
        return tuple(thing for thing in things if kind in ("", thing.kind) and where in ("", thing.room))

    def state(self, id: str) -> ThingState:
        """See `World.state`."""
        states = {state.id: state for state in self._simulation.truth()}
        if id not in states:
            raise UnknownName("object", id, states)
        return states[id]

    def position(self, id: str) -> Vec3:
        """See `World.position`."""
        bodies = self._simulation.bodies
        if id in bodies:
            pose = self._simulation.pose(id)
            return (pose.x, pose.y, bodies[id].eye)
        places = {thing.id: thing.centre for thing in self._simulation.contents.statics}
        places |= {state.id: state.position for state in self._simulation.truth()}
        if id not in places:
            raise UnknownName("thing", id, places)
        return places[id]

    def room(self, name: str) -> Room:
        """A room by its id or its name.

        Raises:
            UnknownName: when there is none.
        """
        rooms = self._simulation.house.rooms
        for room in rooms:
            if name in (room.id, room.name):
                return room
        raise UnknownName("room", name, [room.name for room in rooms])

    def hindrance(self, seat: str, id: str, place: Vec2 | None = None) -> str:
        """See `World.hindrance`."""
        return self._simulation.parts.usability.hindrance(self._body(seat, id, place), id)

    def in_sight(self, seat: str, id: str, place: Vec2 | None = None, *, picture: bool = False) -> bool:
        """See `World.in_sight`."""
        body = self._body(seat, id, place)
        return (
            self._simulation.parts.usability.shows(body, id)
            if picture
            else self._simulation.parts.usability.sees(body, id)
        )

    def _body(self, seat: str, id: str, place: Vec2 | None) -> BodyState:
        """The body in a seat, or a copy of it that stands at a place and faces a thing."""
        body = self._simulation.parts.seats[seat]
        if place is None:
            return body
        copy = BodyState(body.name, body.spec, body.space)
        copy.holding = body.holding
        pose = Pose(x=place[0], y=place[1], yaw=body.pose.yaw)
        turn = view_frustum.rotation_towards(pose, body.spec, self.position(id))
        copy.pose = Pose(x=pose.x, y=pose.y, yaw=plane.wrap(pose.yaw + turn.yaw), pitch=turn.pitch)
        return copy


def _check_kind(kind: str) -> None:
    """Raise UnknownName for a kind that does not exist; "" means all kinds."""
    if kind:
        catalog.kind(kind)
