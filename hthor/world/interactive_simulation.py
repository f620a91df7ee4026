"""A simulation to use by hand: positions by id, motions that run until they end, and the mailbox."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from hthor import catalog, rules, seeds
from hthor.comms import map_picture
from hthor.comms.display import Displays
from hthor.comms.display_contents import display_contents
from hthor.comms.mailbox import Mailbox
from hthor.errors import HthorError, UnknownName
from hthor.geometry import plane
from hthor.types import (
    Display,
    Drive,
    Message,
    Motion,
    Outcome,
    Placement,
    Pose,
    Receipt,
    Room,
    TaskSpec,
    Thing,
    ThingState,
    Vec2,
    Vec3,
    is_person,
)
from hthor.types.events import Event
from hthor.world import numbers
from hthor.world.perception import view_frustum
from hthor.world.sensing_simulation import SensingSimulation
from hthor.world.state.body_state import BodyState

_MOTION_TICKS_MAX = 36_000
"""[ticks] An hour: the most that `run` waits for the end of a motion."""
_STEP_TICKS_MAX = 864_000
"""[ticks] A day: the most that one call of `step` accepts."""


class InteractiveSimulation(SensingSimulation):
    """A `SensingSimulation` whose calls let time pass, with look-up by id, kind and room, and a mailbox.

    Attributes:
        mail: the mailbox that `hthor.world.actor.Actor` uses.
        displays: which parts of the people's displays are shown.
        events: everything that has happened since the last reset, in order.
    """

    def reset(self, task: TaskSpec | None = None, seed: int = 0) -> None:
        """Begin an episode of a task; without a task, of the house as it is, with every body at the house's start."""
        if task is not None:
            super().reset(task, seed)
            return
        seed = seeds.check_seed(seed)
        self._begin({})
        self._seed = seed
        self._place_bodies((self.house.start,), ())

    def objects(self, kind: str = "", room: str = "") -> tuple[ThingState, ...]:
        """True states of the objects that can be picked up, by id; only of ``kind`` and in ``room`` (id) if given.

        Raises:
            UnknownName: when there is no such room or kind.
        """
        _check_kind(kind)
        where = self._room(room).polygon if room else ()
        states = (item.state() for item in self._objects if item.present and kind in ("", item.kind))
        return tuple(state for state in states if not where or plane.inside(state.position[:2], where))

    def furniture(self, kind: str = "", room: str = "") -> tuple[Thing, ...]:
        """The things that never move, as in the house's file; only those of ``kind`` and in ``room`` if given.

        Raises:
            UnknownName: when there is no such room or kind.
        """
        _check_kind(kind)
        where = self._room(room).id if room else ""
        things = self._contents.statics
        return tuple(thing for thing in things if kind in ("", thing.kind) and where in ("", thing.room))

    def count(self, kind: str) -> int:
        """How many things of a kind are in the house now, including those in hands.

        Raises:
            UnknownName: when there is no such kind.
        """
        return len(self.objects(kind)) + len(self.furniture(kind))

    def state(self, id: str) -> ThingState:
        """True state of an object or of a thing that opens: its position, support, holder, and whether it is open.

        Raises:
            UnknownName: when nothing with this id is in the house now.
        """
        states = {state.id: state for state in self.truth()}
        if id not in states:
            raise UnknownName("object", id, states)
        return states[id]

    def position(self, id: str) -> Vec3:
        """Centre [m], house frame, of an object, a thing, a doorway or a seat's body (at the height of its eye).

        Raises:
            UnknownName: when nothing has this id.
        """
        if id in self.bodies:
            pose = self.pose(id)
            return (pose.x, pose.y, self.bodies[id].eye)
        places = {thing.id: thing.centre for thing in self._contents.statics}
        places |= {state.id: state.position for state in self.truth()}
        if id not in places:
            raise UnknownName("thing", id, places)
        return places[id]

    def hindrance(self, seat: str, id: str, place: Vec2 | None = None) -> str:
        """Why a body could not use a thing with what it has in hand now; empty when it could.

        An object is used by picking it up, as if the hand were empty. Furniture is used by placing on or in it what the
        body holds, else by opening or closing it. Whatever the body has no skill for is no hindrance.

        Args:
            seat: the body's seat. id: the thing or object.
            place: (x, y) [m] where the body would stand, facing the thing; None for its present pose.
        """
        body = self._seats[seat]
        return self._usability.hindrance(body if place is None else self._imagined(body, id, place), id)

    def in_sight(self, seat: str, id: str, place: Vec2 | None = None, *, picture: bool = False) -> bool:
        """Whether a body has a free line of sight to a thing, an object or another body.

        Args:
            seat, id, place: see `hindrance`.
            picture: whether what is in sight has to be in the picture of its camera as well.
        """
        body = self._seats[seat]
        body = body if place is None else self._imagined(body, id, place)
        return self._usability.shows(body, id) if picture else self._usability.sees(body, id)

    def _imagined(self, body: BodyState, id: str, place: Vec2) -> BodyState:
        """A copy of a body that stands at a place and faces a thing."""
        copy = BodyState(body.name, body.spec, body.space)
        copy.holding = body.holding
        pose = Pose(x=place[0], y=place[1], yaw=body.pose.yaw)
        turn = view_frustum.rotation_towards(pose, body.spec, self.position(id))
        copy.pose = Pose(x=pose.x, y=pose.y, yaw=plane.wrap(pose.yaw + turn.yaw), pitch=turn.pitch)
        return copy

    def run(self, seat: str, motion: Motion) -> Outcome:
        """Start a motion and let ticks pass until it has ended.

        Raises:
            HthorError: for a `Drive`, which never ends.
        """
        if isinstance(motion, Drive):
            raise HthorError("a Drive does not end by itself; begin it with start, and let time pass with step")
        self.start(seat, motion)
        for _ in range(_MOTION_TICKS_MAX):
            self.step()
            if self.idle(seat):
                break
        outcome = self.outcome(seat)
        assert outcome is not None
        return outcome

    def step(self, ticks: int = 1) -> tuple[Event, ...]:
        """Let ``ticks`` of 0.1 s pass; returns their events, which are also added to `events`."""
        news: list[Event] = []
        for _ in range(numbers.whole_number("ticks", ticks, 0, _STEP_TICKS_MAX)):
            happened = self.advance()
            self.note(happened)
            news += happened
        return tuple(news)

    def settle(self, seconds: float = 10.0) -> bool:
        """Let time pass until nothing falls, rolls or swings, at most ``seconds``; returns whether all is at rest."""
        for _ in range(
            round(numbers.number("seconds", seconds, "seconds", 0.0, _MOTION_TICKS_MAX * rules.TICK_S) * 10)
        ):
            self.step()
            if self.still:
                return True
        return self.still

    @property
    def messages(self) -> tuple[tuple[Message, Receipt], ...]:
        """Every message since the last reset, each with its status."""
        return self.mail.messages

    def display(self, seat: str) -> Display:
        """What a person's display shows now.

        Raises:
            HthorError: for a seat that has no display, because it is a robot's.
        """
        state = self.displays.state(seat)
        if state is None:
            raise HthorError(f"{seat} has no display; only people have: {', '.join(self.displays.people)}")
        return display_contents(state, self.mail, self.pose)

    def map_view(self, seat: str, size: int = map_picture.SIZE_PX) -> NDArray[np.uint8]:
        """The picture of the map on a person's display now, (size, size, 3) uint8.

        The person is in the middle and looks up; around them are the senders of the messages that they confirmed, where
        they are now, and the places that these messages name.

        Raises:
            HthorError: while no map is shown to this seat, or for a size that is no whole number from 40 to 4000.
        """
        shown, side = self.display(seat).map, numbers.whole_number("size", size, 40, 4000)
        if shown is None:
            has = self.displays.state(seat)
            what = "it is hidden: show('map') shows it" if has and has.confirmed else "no message was confirmed yet"
            raise HthorError(f"there is no map on the display of {seat}; {what}")
        return map_picture.draw_map(shown, side)

    def note(self, events: Iterable[Event]) -> None:
        """Add events to `events`."""
        self.events.extend(events)

    def _begin(self, placements: dict[str, Placement], task: str = "") -> None:
        super()._begin(placements, task)
        people = tuple(seat for seat in self.seats if is_person(seat))
        self.mail = Mailbox(self.seats[len(people) :], people)
        self.events: list[Event] = []
        self.displays = Displays(people, self.events)

    def _room(self, name: str) -> Room:
        """A room by its id or its name."""
        for room in self.house.rooms:
            if name in (room.id, room.name):
                return room
        raise UnknownName("room", name, [room.name for room in self.house.rooms])


def _check_kind(kind: str) -> None:
    """Raise UnknownName for a kind that does not exist; "" means all kinds."""
    if kind:
        catalog.kind(kind)
