"""The simulation of a house with bodies and objects, one tick at a time."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from hthor import houses, seeds
from hthor.errors import HthorError, PhysicsError, TaskError, UnknownName, WorldClosed
from hthor.gc_freeze import collection_paused
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
from hthor.types.events import Event
from hthor.world import numbers
from hthor.world.interaction import manipulation
from hthor.world.model import inventory
from hthor.world.model.bodies import avatar, bodies
from hthor.world.motion import spawn
from hthor.world.perception import detector_noise
from hthor.world.saved_state import StateKeeper
from hthor.world.simulation_parts import SimulationParts

PEOPLE_MAX = 20
"""The most people in one world."""


class Closed:
    """Stands for the parts of a world that was closed: all but what it was made with raises WorldClosed."""

    def __init__(self, house: str, **kept: Any) -> None:
        self._house = house
        vars(self).update(kept)

    def __getattr__(self, name: str) -> Any:
        raise WorldClosed.of(self._house)


class Simulation:
    """A house with people and robots.

    The constructor compiles the model; `reset` only writes poses. After a reset, the same motions give bitwise the same
    states.

    Args:
        house: a floor plan, the name of one, or the path of a house file.
        robots: the robots' bodies, their names or files; their seats are "robot", "robot2", ...
        objects: (id, kind) pairs of the movable objects that tasks may place, besides the house's own.
        detectors: the robots' detectors, in the order of the robots: records, or texts that
            `hthor.types.detector_specs.parse` reads; the default "own" is the detector that the body declares.
        people: how many people there are; their seats are "human", "human2", ...

    Attributes:
        house: the floor plan. seats: names of all seats, the people's first. bodies: the body in each seat.
        robots: names of the robots' seats.
        detectors: of the robots, by seat. contents: the house's things, split into movable and static ones.
        parts: what it is made of. seed: of the episode's random draws. spares: objects not in the house when it began.
        tick: ticks since the last reset. space: each seat's free-space grid.
        moment: the numbers of the episode, the tick and its step, to which an observation belongs.
    """

    def __init__(
        self,
        house: HouseSpec | str | Path,
        robots: Iterable[RobotSpec | str | Path] = (),
        objects: Iterable[tuple[str, str]] = inventory.DEFAULT_OBJECTS,
        detectors: Iterable[DetectorSpec | str] = (),
        people: int = 1,
    ) -> None:
        self.house = _load_house(house)
        specs: list[BodySpec] = [avatar.HUMAN] * numbers.whole_number("people", people, 1, PEOPLE_MAX)
        robots = (robots,) if isinstance(robots, (str, Path)) else robots
        specs += [bodies.robot_spec(robot) for robot in robots]
        self.seats = bodies.seat_names(people, len(specs) - people)
        self.robots = tuple(seat for seat in self.seats if not is_person(seat))
        self.bodies = dict(zip(self.seats, specs, strict=True))
        self.space = {seat: FreeSpace.of(self.house, spec.radius, spec.height) for seat, spec in self.bodies.items()}
        self.detectors = detector_noise.assign_detectors(self.robots, self.bodies, detectors)
        self.contents = inventory.split_things(self.house, objects)
        with collection_paused():
            self.parts = parts = SimulationParts(self.house, self.contents, self.bodies, self.space, self.detectors)
        self._env, self._objects, self._seats, self._truth = parts.env, parts.objects, parts.seats, parts.truth
        self._rooms, self._dispatch, self._driven, self._mocap = parts.rooms, parts.dispatch, parts.driven, parts.mocap
        self._keeper = StateKeeper(self.house, parts, self.bodies, self.detectors)
        self.tick, self._episode, self.seed = 0, 0, 0
        self.spares: frozenset[str] = frozenset()
        self.clear()

    def reset(self, task: TaskSpec, seed: int = 0) -> None:
        """Begin a task; see `World.reset`."""
        if not isinstance(task, TaskSpec):
            raise HthorError(f"task must be a TaskSpec, one of `hthor.tasks.load_suite(...).tasks`, got {task!r:.60}")
        spawn.check_task(task, self.house)
        seed = seeds.check_seed(seed)
        self._begin({placement.id: placement for placement in task.objects}, task.id)
        self.seed = seed
        self._place_bodies((task.human_start, *task.other_human_starts), task.robot_starts)

    def clear(self, seed: int = 0) -> None:
        """Begin an episode of the house as it is, with every body at the house's start."""
        seed = seeds.check_seed(seed)
        self._begin({})
        self.seed = seed
        self._place_bodies((self.house.start,), ())

    def restart(self, task: TaskSpec) -> None:
        """Begin a task between two ticks; see `World.restart`."""
        spawn.check_task(task, self.house)
        tick, seed = self.tick, self.seed
        self._begin({placement.id: placement for placement in task.objects}, task.id)
        self.seed = seed
        people = (task.human_start, *task.other_human_starts)
        spawn.place_bodies(tuple(self._seats.values()), people, task.robot_starts)
        self._begin_moment(tick)

    def _begin(self, placements: dict[str, Placement], task: str = "") -> None:
        movables = {movable.id: movable for movable in self.contents.movables}
        for id in placements:
            if id not in movables:
                raise TaskError(task, "objects", str(UnknownName("object", id, movables)))
        self._rooms.reset()
        self.seed = 0
        begin: dict[str, tuple[Vec3, float, str]] = {}
        for id, movable in movables.items():
            if (placed := placements.get(id)) is not None:
                begin[id] = (placed.position, placed.yaw, placed.support)
            elif movable.home is not None:
                begin[id] = (movable.home, movable.yaw, movable.support)
        self.spares = frozenset(movables.keys() - begin.keys())
        self.parts.task.starts = {id: begin[id][:2] for id in placements}
        self._env.begin()
        self._objects.reset(begin)
        self.parts.joint_carrying.reset()
        self.parts.doors.reset()
        self.parts.doorways.update({})
        self._driven.reset()
        self._episode += 1
        self._begin_moment(0)
        self._events: list[Event] = []

    def _place_bodies(self, people: Sequence[Pose], robots: Sequence[Pose]) -> None:
        spawn.place_bodies(tuple(self._seats.values()), people, robots)
        self._mocap.rewrite()

    def idle(self, seat: str) -> bool:
        """See `World.idle`."""
        return self._seats[seat].activity is None

    def start(self, seat: str, action: Motion) -> None:
        """See `World.start`."""
        body = self._seats[seat]
        if isinstance(action, Drive):
            self._driven.start(body, action)
            return
        reason = (
            f"{seat} is busy with another motion" if body.activity is not None else self._dispatch.refusal(body, action)
        )
        if reason:
            verb = manipulation.motion_name(action)
            by = self._dispatch.manipulation.body_in_the_way(body, action, reason)
            body.outcome = Outcome(motion=verb, ok=False, reason=reason, by=by)
            self._events += manipulation.refusal_events(self.tick, seat, verb, reason, by)
            return
        if body.drive is not None and isinstance(action, (Move, Rotate, Wait)):
            self._driven.stop(body)
        body.activity = self._dispatch.activity(body, action)

    def outcome(self, seat: str) -> Outcome | None:
        """See `World.outcome`."""
        return self._seats[seat].outcome

    def substep(self) -> None:
        """See `World.substep`."""
        self._events += self._driven.step(self.tick + 1)
        self._mocap.write()
        self._begin_moment(self.tick)

    def advance(self) -> tuple[Event, ...]:
        """See `World.advance`."""
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
            self.parts.loose_things.keep_off(self._objects.settle())
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
        """See `World.still`."""
        return self._env.still

    def pose(self, seat: str) -> Pose:
        """See `World.pose`."""
        return self._seats[seat].pose

    def poses(self) -> dict[str, Pose]:
        """See `World.poses`."""
        return {name: seat.pose for name, seat in self._seats.items()}

    def holding(self, seat: str) -> str:
        """See `World.holding`."""
        return self._seats[seat].holding

    def room(self, seat: str) -> str:
        """See `World.room`."""
        return self._rooms.room(seat, self._seats[seat].pose)

    def truth(self) -> tuple[ThingState, ...]:
        """See `World.truth`."""
        return tuple(self._truth.states().values())

    def snapshot(self) -> Snapshot:
        """See `World.snapshot`."""
        return self._truth.snapshot(self.tick)

    def save_state(self) -> bytes:
        """See `World.save_state`."""
        return self._keeper.save(self.tick, self.seed, self.spares, self._events)

    def load_state(self, state: bytes) -> None:
        """See `World.load_state`."""
        record = self._keeper.load(state)
        self.seed, self._events = record.seed, list(record.events)
        self.spares = frozenset(record.spares)
        self._episode += 1
        self._begin_moment(record.tick)

    def _begin_moment(self, tick: int) -> None:
        self.tick, self.moment = tick, (self._episode, tick, self._driven.steps)

    def close(self) -> None:
        """Free the engine; from then on, whatever needs it raises WorldClosed."""
        self._env.shut(self.house.id)
        closed: Any = Closed(self.house.id)
        self.parts = self._keeper = self._env = self._objects = self._seats = self._truth = closed
        self._rooms = self._dispatch = self._driven = self._mocap = closed


def _load_house(given: HouseSpec | str | Path) -> HouseSpec:
    """The house that a caller names."""
    if isinstance(given, HouseSpec):
        return given
    if not isinstance(given, (str, Path)):
        raise HthorError(f"house must be a name, the path of a house file or a HouseSpec, got {given!r:.60}")
    return houses.load(given)
