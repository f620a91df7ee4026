"""A house with bodies and objects in it, one tick at a time."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

from hthor import houses
from hthor.errors import PhysicsError, TaskError, UnknownName
from hthor.gc_freeze import collection_paused
from hthor.houses.space.free_space import FreeSpace
from hthor.types import (
    BodySpec,
    DetectorSpec,
    Event,
    HouseSpec,
    Motion,
    Outcome,
    Placement,
    Pose,
    RobotSpec,
    Snapshot,
    TaskSpec,
    ThingState,
    Vec2,
    Vec3,
)
from hthor.world import numbers
from hthor.world.interaction import manipulation
from hthor.world.model import inventory
from hthor.world.model.bodies import avatar, bodies
from hthor.world.motion import spawn
from hthor.world.perception import detector_noise
from hthor.world.simulation_parts import SimulationParts
from hthor.world.state.body_state import BodyState


class Simulation:
    """A house, one person and any number of robots.

    The model is compiled once, here; `reset` only writes poses. After a reset, the same motions give the same states,
    bit for bit.

    Args:
        house: a floor plan, or the name of one.
        robots: the robots' bodies or their names; they sit at "robot", "robot2", ...
        objects: (id, kind) pairs of the movable objects that tasks may place, besides the house's own.
        detectors: how the robots' detectors err, in their order: records, or what `hthor.types.detector_specs.parse`
            takes; "own", the default, is what the body declares.

    Attributes:
        house: the floor plan. seats: names of all seats, the person's first. bodies: what each seat's body can do.
        tick: ticks since the last reset. space: each seat's free-space grid.
    """

    def __init__(
        self,
        house: HouseSpec | str,
        robots: Iterable[RobotSpec | str] = (),
        objects: Iterable[tuple[str, str]] = inventory.DEFAULT_OBJECTS,
        detectors: Iterable[DetectorSpec | str] = (),
    ) -> None:
        self.house = houses.load(house) if isinstance(house, str) else house
        specs: list[BodySpec] = [avatar.HUMAN]
        robots = (robots,) if isinstance(robots, str) else robots
        specs += [bodies.load_robot(robot) if isinstance(robot, str) else robot for robot in robots]
        self.seats = bodies.seat_names(len(specs) - 1)
        self.bodies = dict(zip(self.seats, specs, strict=True))
        self.space = {seat: FreeSpace.of(self.house, spec.radius, spec.height) for seat, spec in self.bodies.items()}
        self.detectors = detector_noise.assign_detectors(self.seats[1:], self.bodies, detectors)
        self._contents = inventory.split_things(self.house, objects)
        with collection_paused():
            parts = SimulationParts(self.house, self._contents, self.bodies, self.space, self.detectors)
        self._task, self._env, self._truth = parts.task, parts.env, parts.truth
        self._geoms, self._objects, self._seats = parts.geoms, parts.objects, parts.seats
        self._rooms, self._doorways, self._doors = parts.rooms, parts.doorways, parts.doors
        self._door_handling, self._joint_carrying = parts.door_handling, parts.joint_carrying
        self._manipulation, self._dispatch, self._editor = parts.manipulation, parts.dispatch, parts.editor
        self._scanners, self._visibility, self._detectors = parts.scanners, parts.visibility, parts.detectors
        self.tick, self._episode = 0, 0
        spawn.place_bodies(tuple(self._seats.values()), self.house.start, ())
        self._begin({})

    @property
    def model(self) -> Any:
        """The compiled `mujoco.MjModel`; changing it makes results undefined."""
        return self._env.model

    def reset(self, task: TaskSpec, seed: int = 0) -> None:
        """Begin a task: all objects in place and asleep, things closed, doorways open.

        A body whose start is not free stands at the nearest free place; a robot without a start in the task, at the
        nearest place to the first robot's start that is clear of the others. ``seed`` decides all chance in the
        episode, which is the errors of noisy detectors.

        Raises:
            TaskError: when the task belongs to another house or places an object that this world does not have.
        """
        spawn.check_task(task, self.house)
        self._begin({placement.id: placement for placement in task.objects}, task.id)
        self._seed = seed
        spawn.place_bodies(tuple(self._seats.values()), task.human_start, task.robot_starts)

    def _begin(self, placements: dict[str, Placement], task: str = "") -> None:
        movables = {movable.id: movable for movable in self._contents.movables}
        for id in placements:
            if id not in movables:
                raise TaskError(task, "objects", str(UnknownName("object", id, movables)))
        self._rooms.reset()
        self._seed = 0
        begin: dict[str, tuple[Vec3, float, str]] = {}
        for id, movable in movables.items():
            if (placed := placements.get(id)) is not None:
                begin[id] = (placed.position, placed.yaw, placed.support)
            elif movable.home is not None:
                begin[id] = (movable.home, movable.yaw, movable.support)
        self._task.starts = {id: begin[id][:2] for id in placements}
        self._env.reset()
        self._objects.reset(begin)
        self._joint_carrying.reset()
        self._doors.reset()
        self._doorways.update({})
        self.tick = 0
        self._episode += 1
        self._events: list[Event] = []

    def idle(self, seat: str) -> bool:
        """Whether the seat's body is free for a new motion."""
        return self._seats[seat].activity is None

    def start(self, seat: str, action: Motion) -> None:
        """Begin a motion. One that a rule forbids is refused: see `outcome`, and the next `advance` reports it."""
        body = self._seats[seat]
        reason = (
            f"{seat} is busy with another motion" if body.activity is not None else self._dispatch.refusal(body, action)
        )
        if reason:
            verb = manipulation.motion_name(action)
            body.outcome = Outcome(motion=verb, ok=False, reason=reason)
            data = {"motion": verb, "reason": reason}
            self._events.append(Event(tick=self.tick, seat=seat, kind="refused", data=data))
            return
        body.activity = self._dispatch.activity(body, action)

    def outcome(self, seat: str) -> Outcome | None:
        """How the seat's last motion ended, None before any has."""
        return self._seats[seat].outcome

    def advance(self) -> tuple[Event, ...]:
        """Let one tick pass: every busy body moves, in the order of the seats, then objects fall and doors swing.

        Returns:
            what happened: picked, placed, dropped, opened, closed, refused, blocked (by the house), in_way (of another
            body); held, lifted, lowered, released, see `hthor.world.carrying.joint_carrying`.

        Raises:
            PhysicsError: when the engine loses the state. All objects are then where they were a tick before, at rest,
                and the next call goes on from there; what else happened in this tick, it returns.
        """
        self.tick += 1
        events, self._events = self._events, []
        for seat in self._seats.values():
            if seat.activity is None:
                continue
            pose = seat.pose
            outcome, news = seat.activity.advance(self.tick)
            if news:
                events.extend(news)
            if outcome is not None:
                seat.activity, seat.outcome = None, outcome
            if seat.holding and seat.pose is not pose:
                self._objects.follow(seat.holding)
        if self._env.tick():
            self._check(events)
            self._objects.settle()
        return tuple(sorted(events, key=lambda event: event.tick)) if events else ()

    def _check(self, events: list[Event]) -> None:
        """Recover when the engine has lost the state, and say so; nothing that happened in the tick is lost."""
        complaints = self._env.warnings()
        if not complaints:
            return
        lost = [f"{name} at {self._objects.at(where) or where}" for name, where in complaints.items()]
        self._env.recover()
        self._objects.reread()
        self._events = events
        raise PhysicsError(
            f"the physics engine lost the state of house '{self.house.id}' at tick {self.tick} ({', '.join(lost)}). "
            "All objects are back where they were one tick before, at rest: go on, move that object, or reset."
        )

    def out_of_hand(self, seat: str, id: str, place: Vec2 | None = None) -> str:
        """Why a body could not pick an object up, or get at a thing's door, with an empty hand; empty when it could.

        Args:
            seat: whose body. id: the object or thing; "" is the answer for what can be neither picked up nor opened,
                and for a body that does neither.
            place: (x, y) [m] where the body would stand, facing it; None for where it stands, as it stands.
        """
        body = self._seats[seat]
        return self._manipulation.out_of_hand(body if place is None else self._imagined(body, id, place), id)

    def _imagined(self, body: BodyState, id: str, place: Vec2) -> BodyState:
        """A copy of a body that stands at a place and faces an object or a thing that opens."""
        item, door = self._objects.get(id), self._doors.get(id)
        x, y, _ = item.position if item is not None else door.thing.centre if door is not None else (*place, 0.0)
        copy = BodyState(body.name, body.spec, body.space)
        copy.pose = Pose(x=place[0], y=place[1], yaw=math.atan2(y - place[1], x - place[0]))
        return copy

    def teleport(self, seat: str, pose: Pose) -> None:
        """Put a body somewhere at once; what it was doing ends.

        Raises:
            HthorError: when the body does not fit there, another is there, or a number is not finite or out of range.
        """
        body, pose = self._seats[seat], numbers.pose(pose)
        spawn.check_fits(body, pose, self._seats.values())
        body.pose, body.activity = pose, None
        self._door_handling.release(seat)
        self._joint_carrying.release(body)
        if body.holding:
            self._objects.follow(body.holding)

    def put_object(
        self,
        id: str,
        position: Sequence[float] | None = None,
        *,
        on: str = "",
        yaw: float = 0.0,
        velocity: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> None:
        """Set one of this world's objects somewhere at once; the engine takes it from there.

        Args:
            id: an object of the house or of ``objects``, whether it is in the episode by now or not.
            position: [m] of its centre; with ``on``, where it should be as nearly as there is room.
            on: id of a thing to put it on, or in when it has no top, along the thing's edges when ``yaw`` is 0.
            yaw: [rad] its heading; with ``on``, relative to the thing.
            velocity: [m/s] to throw it with.

        Raises:
            UnknownName: when there is no such object, or nothing can be put on that thing.
            HthorError: when it is in someone's hand, would be outdoors or inside something, has no room there, or is
                to fly faster than anyone throws.
        """
        self._editor.put(id, position, on, yaw, velocity)

    def remove_object(self, id: str) -> None:
        """Take an object out of the episode; `put_object` brings it back.

        Raises:
            UnknownName: when there is no such object. HthorError: when it is in a hand.
        """
        self._editor.remove(id)

    def set_open(self, thing: str, wanted: bool = True) -> None:
        """Open or close a fridge, a drawer or a door at once.

        Raises:
            UnknownName: when no such thing opens. HthorError: when something is in its way.
        """
        self._door_handling.put(thing, wanted)

    @property
    def still(self) -> bool:
        """Whether every object and door is at rest, apart from what is carried."""
        return self._env.still

    @property
    def moment(self) -> tuple[int, int]:
        """Episode and tick: what an observation belongs to."""
        return (self._episode, self.tick)

    def pose(self, seat: str) -> Pose:
        """Where the seat's body is."""
        return self._seats[seat].pose

    def poses(self) -> dict[str, Pose]:
        """Where every seat's body is, the person first."""
        return {name: seat.pose for name, seat in self._seats.items()}

    def holding(self, seat: str) -> str:
        """Id of the object in the seat's hand, empty for none."""
        return self._seats[seat].holding

    def room(self, seat: str) -> str:
        """Id of the room the seat's body is in, the last one while it is between rooms."""
        return self._rooms.room(seat, self._seats[seat].pose)

    def truth(self) -> tuple[ThingState, ...]:
        """True states of all objects and openable things, by id."""
        return tuple(self._truth.states().values())

    def snapshot(self) -> Snapshot:
        """The true state at this tick, for judging and logging."""
        return self._truth.snapshot(self.tick)
