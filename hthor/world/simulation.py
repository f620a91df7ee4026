"""The simulation of a house with bodies and objects, one tick at a time."""

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

    The constructor compiles the model; `reset` only writes poses. After a reset, the same motions give bitwise the same
    states.

    Args:
        house: a floor plan, or the name of one.
        robots: the robots' bodies or their names; their seats are "robot", "robot2", ...
        objects: (id, kind) pairs of the movable objects that tasks may place, besides the house's own.
        detectors: the robots' detectors, in the order of the robots: records, or texts that
            `hthor.types.detector_specs.parse` reads; the default "own" is the detector that the body declares.

    Attributes:
        house: the floor plan. seats: names of all seats, the person's first. bodies: the body in each seat.
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
        """Begin a task: all objects in place and at rest, things closed, doorways open.

        A body whose start is not free stands at the nearest free place. A robot without a start in the task stands at
        the free place nearest to the first robot's start. ``seed`` decides all random draws of the episode, which are
        the errors of noisy detectors and the numbers of segmentations.

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
        """Begin a motion. If a rule forbids it, `outcome` says why and the next `advance` returns a "refused" event."""
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
        """How the seat's last motion ended; None before any motion has ended."""
        return self._seats[seat].outcome

    def advance(self) -> tuple[Event, ...]:
        """Let one tick pass: every busy body moves, in the order of the seats, then objects fall and doors swing.

        Returns:
            the tick's events: picked, placed, dropped, opened, closed, refused, blocked (by the house), in_way (by
            another body); held, lifted, lowered, released, see `hthor.world.carrying.joint_carrying`.

        Raises:
            PhysicsError: when the engine loses the state. All objects are then at rest where they were a tick before.
                The next call goes on from there and also returns the other events of this tick.
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
        """Recover and raise PhysicsError if the engine has lost the state; the tick's ``events`` are kept."""
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
        """Why a body could not pick an object up or reach a thing's door with an empty hand; empty when it could.

        Args:
            seat: the body's seat. id: the object or thing; the result is also "" if it can be neither picked up nor
                opened, or if the body can do neither.
            place: (x, y) [m] where the body would stand, facing the thing; None for its present pose.
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
        """Put a body somewhere at once; its motion under way ends.

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
        """Put one of this world's objects somewhere at once; from then on the engine moves it.

        Args:
            id: an object of the house or of ``objects``; it need not be in the episode yet.
            position: [m] of its centre; with ``on``, it is put as near to this point as there is room.
            on: id of a thing to put it on (or in, if the thing has no top), along the thing's edges when ``yaw`` is 0.
            yaw: [rad] its heading; with ``on``, relative to the thing.
            velocity: [m/s] its initial velocity.

        Raises:
            UnknownName: when there is no object with this id, or nothing can be put on the thing ``on``.
            HthorError: when the object is in someone's hand, would be outdoors or inside something, has no room there,
                or its velocity is too high.
        """
        self._editor.put(id, position, on, yaw, velocity)

    def remove_object(self, id: str) -> None:
        """Take an object out of the episode; `put_object` brings it back.

        Raises:
            UnknownName: when there is no object with this id. HthorError: when it is in a hand.
        """
        self._editor.remove(id)

    def set_open(self, thing: str, wanted: bool = True) -> None:
        """Open or close a fridge, a drawer or a door at once.

        Raises:
            UnknownName: when no thing with this id opens. HthorError: when something is in its way.
        """
        self._door_handling.put(thing, wanted)

    @property
    def still(self) -> bool:
        """Whether every door and every object that is not carried is at rest."""
        return self._env.still

    @property
    def moment(self) -> tuple[int, int]:
        """The numbers of the episode and the tick, to which an observation belongs."""
        return (self._episode, self.tick)

    def pose(self, seat: str) -> Pose:
        """The pose of the seat's body."""
        return self._seats[seat].pose

    def poses(self) -> dict[str, Pose]:
        """The pose of every seat's body, the person's first."""
        return {name: seat.pose for name, seat in self._seats.items()}

    def holding(self, seat: str) -> str:
        """Id of the object in the seat's hand, empty for none."""
        return self._seats[seat].holding

    def room(self, seat: str) -> str:
        """Id of the room that the seat's body is in; between rooms, of the room that it was in last."""
        return self._rooms.room(seat, self._seats[seat].pose)

    def truth(self) -> tuple[ThingState, ...]:
        """True states of all objects and openable things, by id."""
        return tuple(self._truth.states().values())

    def snapshot(self) -> Snapshot:
        """The true state at this tick, for judging and logging."""
        return self._truth.snapshot(self.tick)
