"""The simulation of a house with bodies and objects, one tick at a time."""

from collections.abc import Iterable, Sequence
from typing import Any

from hthor import houses, seeds
from hthor.errors import PhysicsError, TaskError, UnknownName
from hthor.gc_freeze import collect_after_close, collection_paused
from hthor.houses.space.free_space import FreeSpace
from hthor.types import (
    BodySpec,
    DetectorSpec,
    Drive,
    HouseSpec,
    Motion,
    Move,
    Outcome,
    Placement,
    Pose,
    RobotSpec,
    Rotate,
    Snapshot,
    TaskSpec,
    ThingState,
    Vec3,
    Wait,
    is_person,
)
from hthor.types.events import Event, Refused
from hthor.world import numbers
from hthor.world.interaction import manipulation
from hthor.world.model import inventory
from hthor.world.model.bodies import avatar, bodies
from hthor.world.model.composer_env import LazyComposerEnv
from hthor.world.motion import spawn
from hthor.world.perception import detector_noise
from hthor.world.saved_state import StateKeeper
from hthor.world.simulation_parts import SimulationParts

PEOPLE_MAX = 20
"""The most people in one world."""


class Simulation:
    """A house with people and robots.

    The constructor compiles the model; `reset` only writes poses. After a reset, the same motions give bitwise the same
    states.

    Args:
        house: a floor plan, or the name of one.
        robots: the robots' bodies or their names; their seats are "robot", "robot2", ...
        objects: (id, kind) pairs of the movable objects that tasks may place, besides the house's own.
        detectors: the robots' detectors, in the order of the robots: records, or texts that
            `hthor.types.detector_specs.parse` reads; the default "own" is the detector that the body declares.
        people: how many people there are; their seats are "human", "human2", ...

    Attributes:
        house: the floor plan. seats: names of all seats, the people's first. bodies: the body in each seat.
        robots: names of the robots' seats.
        tick: ticks since the last reset. space: each seat's free-space grid.
        moment: the numbers of the episode, the tick and its step, to which an observation belongs.
    """

    def __init__(
        self,
        house: HouseSpec | str,
        robots: Iterable[RobotSpec | str] = (),
        objects: Iterable[tuple[str, str]] = inventory.DEFAULT_OBJECTS,
        detectors: Iterable[DetectorSpec | str] = (),
        people: int = 1,
    ) -> None:
        self.house = houses.load(house) if isinstance(house, str) else house
        specs: list[BodySpec] = [avatar.HUMAN] * numbers.whole_number("people", people, 1, PEOPLE_MAX)
        robots = (robots,) if isinstance(robots, str) else robots
        specs += [bodies.load_robot(robot) if isinstance(robot, str) else robot for robot in robots]
        self.seats = bodies.seat_names(people, len(specs) - people)
        self.robots = tuple(seat for seat in self.seats if not is_person(seat))
        self.bodies = dict(zip(self.seats, specs, strict=True))
        self.space = {seat: FreeSpace.of(self.house, spec.radius, spec.height) for seat, spec in self.bodies.items()}
        self.detectors = detector_noise.assign_detectors(self.robots, self.bodies, detectors)
        self._contents = inventory.split_things(self.house, objects)
        with collection_paused():
            parts = SimulationParts(self.house, self._contents, self.bodies, self.space, self.detectors)
        self._task, self._env, self._truth = parts.task, parts.env, parts.truth
        self._geoms, self._objects, self._seats = parts.geoms, parts.objects, parts.seats
        self._rooms, self._doorways, self._doors = parts.rooms, parts.doorways, parts.doors
        self._door_handling, self._joint_carrying = parts.door_handling, parts.joint_carrying
        self._dispatch, self._editor, self._usability = parts.dispatch, parts.editor, parts.usability
        self._scanners, self._visibility, self._detectors = parts.scanners, parts.visibility, parts.detectors
        self._loose_things, self._mocap, self._driven = parts.loose_things, parts.mocap, parts.driven
        self._keeper = StateKeeper(self.house, parts, self.bodies, self.detectors)
        self.tick, self._episode = 0, 0
        self._begin({})
        self._place_bodies((self.house.start,), ())
        collect_after_close(self)

    @property
    def model(self) -> Any:
        """The compiled `mujoco.MjModel`; changing it makes results undefined."""
        return self._env.model

    @property
    def nbytes(self) -> int:
        """About how much memory it takes: that of the engine's buffers and of its arena.

        The arena stays nearly empty, and Python's objects take about as much instead: for the houses that ship, 15 to
        41 MB were measured, and this gives 26 to 43 MB.
        """
        model, data = self._env.model, self._env.data
        return int(model.nbuffer + data.nbuffer + data.narena)

    @property
    def env(self) -> LazyComposerEnv:
        """The `dm_env` environment in which everything is; `hthor.envs.trial_environment` gives it a trial."""
        return self._env

    def reset(self, task: TaskSpec, seed: int = 0) -> None:
        """Begin a task: all objects in place and at rest, things closed, doorways open.

        A body whose start is not free stands at the nearest free place. A person without a start in the task stands at
        the free place nearest to the first person's start, such a robot at that nearest to the first robot's start.
        ``seed`` decides all random draws of the episode, which are the errors of noisy detectors and the numbers of
        segmentations.

        Raises:
            TaskError: when the task belongs to another house or places an object that this world does not have.
            HthorError: when the seed is not a whole number from 0.
        """
        spawn.check_task(task, self.house)
        seed = seeds.check_seed(seed)
        self._begin({placement.id: placement for placement in task.objects}, task.id)
        self._seed = seed
        self._place_bodies((task.human_start, *task.other_human_starts), task.robot_starts)

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
        self._spares = frozenset(movables.keys() - begin.keys())
        self._task.starts = {id: begin[id][:2] for id in placements}
        self._env.begin()
        self._objects.reset(begin)
        self._joint_carrying.reset()
        self._doors.reset()
        self._doorways.update({})
        self._driven.reset()
        self._episode += 1
        self._begin_moment(0)
        self._events: list[Event] = []

    def _place_bodies(self, people: Sequence[Pose], robots: Sequence[Pose]) -> None:
        spawn.place_bodies(tuple(self._seats.values()), people, robots)
        self._mocap.rewrite()

    def idle(self, seat: str) -> bool:
        """Whether the seat's body is free for a new motion; a body that drives is, while its hands are free."""
        return self._seats[seat].activity is None

    def start(self, seat: str, action: Motion) -> None:
        """Begin a motion. If a rule forbids it, `outcome` says why and the next `advance` returns a "refused" event.

        A `Drive` is never refused, and replaces any motion but those of the hands. It is replaced by a `Move`, `Rotate`
        or `Wait`; during a motion of the hands, the body stands.
        """
        body = self._seats[seat]
        if isinstance(action, Drive):
            self._driven.start(body, action)
            return
        reason = (
            f"{seat} is busy with another motion" if body.activity is not None else self._dispatch.refusal(body, action)
        )
        if reason:
            verb = manipulation.motion_name(action)
            body.outcome = Outcome(motion=verb, ok=False, reason=reason)
            self._events.append(Refused(tick=self.tick, seat=seat, motion=verb, reason=reason))
            return
        if body.drive is not None and isinstance(action, (Move, Rotate, Wait)):
            self._driven.stop(body)
        body.activity = self._dispatch.activity(body, action)

    def outcome(self, seat: str) -> Outcome | None:
        """How the seat's last motion ended; None before any motion has ended."""
        return self._seats[seat].outcome

    def substep(self) -> None:
        """Move the bodies that drive by one of a tick's `hthor.types.SUBTICKS` steps; `advance` makes those left.

        With the same set-points at the same steps, the states are the same, whoever makes the steps. After the last
        step of a tick this does nothing until `advance` was called.
        """
        self._events += self._driven.step(self.tick + 1)
        self._mocap.write()
        self._begin_moment(self.tick)

    def advance(self) -> tuple[Event, ...]:
        """Let one tick pass: first all bodies that drive move, then every busy body, in the order of the seats, then
        objects fall and doors swing.

        Returns:
            the tick's events: picked, placed, dropped, opened, closed, refused, blocked (by the house), in_way (by
            another body); held, lifted, lowered, released, see `hthor.world.carrying.joint_carrying`.

        Raises:
            PhysicsError: when the engine loses the state. All objects are then at rest where they were a tick before.
                The next call goes on from there and also returns the other events of this tick.
        """
        events, self._events = self._events, []
        if self._driven.active or self._driven.steps:
            events += self._driven.finish(self.tick + 1)
        self._begin_moment(self.tick + 1)
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
        self._mocap.write()
        if self._env.tick():
            self._check(events)
            self._loose_things.keep_off(self._objects.settle())
        return tuple(sorted(events, key=lambda event: event.tick)) if events else ()

    def _check(self, events: list[Event]) -> None:
        """Recover and raise PhysicsError if the engine has lost the state; the tick's ``events`` are kept."""
        complaints = self._env.warnings()
        if not complaints:
            return
        lost = [f"{name} at {self._objects.at(where) or where}" for name, where in complaints.items()]
        self._env.recover()
        self._mocap.rewrite()
        self._objects.reread()
        self._events = events
        raise PhysicsError(
            f"the physics engine lost the state of house '{self.house.id}' at tick {self.tick} ({', '.join(lost)}). "
            "All objects are back where they were one tick before, at rest: go on, move that object, or reset."
        )

    @property
    def still(self) -> bool:
        """Whether every door and every object that is not carried is at rest."""
        return self._env.still

    def pose(self, seat: str) -> Pose:
        """The pose of the seat's body."""
        return self._seats[seat].pose

    def poses(self) -> dict[str, Pose]:
        """The pose of every seat's body, the people's first."""
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

    def save_state(self) -> bytes:
        """The whole state of the world, for `load_state`; pictures and readings of sensors are not in it."""
        return self._keeper.save(self.tick, self._seed, self._spares, self._events)

    def load_state(self, state: bytes) -> None:
        """Go back to a state that `save_state` returned: the same motions then have the same results, byte for byte.

        The state may also be of another world of the same house, bodies, objects and detectors.

        Raises:
            HthorError: when the bytes are damaged, or belong to a different world; nothing has changed then.
        """
        record = self._keeper.load(state)
        self._seed, self._events = record.seed, list(record.events)
        self._spares = frozenset(record.spares)
        self._episode += 1
        self._begin_moment(record.tick)

    def _begin_moment(self, tick: int) -> None:
        self.tick, self.moment = tick, (self._episode, tick, self._driven.steps)
