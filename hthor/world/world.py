"""The world: a house with bodies and objects in it, one tick at a time; knows nothing of minds, messages or goals."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from hthor import geometry, houses, rules
from hthor.errors import HthorError, TaskError, UnknownName
from hthor.houses.freespace import FreeSpace
from hthor.types import (
    HUMAN,
    BodySpec,
    Close,
    Detection,
    Event,
    HouseSpec,
    Motion,
    Move,
    Open,
    Outcome,
    Pick,
    Place,
    Placement,
    Pose,
    RobotSpec,
    Rotate,
    Scan,
    Senses,
    Snapshot,
    TaskSpec,
    ThingState,
    Vec2,
    Vec3,
    Wait,
)
from hthor.world import avatar, bodies, contents, interaction, motion, starts
from hthor.world.doors import Doors
from hthor.world.env import FastEnv
from hthor.world.gaze import Gaze
from hthor.world.interaction import Hands
from hthor.world.objects import Objects
from hthor.world.obstacles import Obstacles
from hthor.world.pictures import IMAGE_SIZE, Pictures
from hthor.world.places import Places
from hthor.world.scan import Scanner
from hthor.world.scene import Scene
from hthor.world.seats import Activity, Seat
from hthor.world.senses import Senses as SeatSenses
from hthor.world.task import HouseTask


class World:
    """A house, one person and any number of robots.

    The model is compiled once, here; `reset` only writes poses. After it a world gives the same states for the same
    motions, bit for bit, however often it was reset before.

    Args:
        house: a floor plan, or the name of one.
        robots: the robots' bodies or their names; they sit at "robot", "robot2", ...
        objects: (id, kind) pairs of the movable objects that tasks may place, besides the house's own.

    Attributes:
        house: the floor plan. seats: names of all seats, the person's first. bodies: what each seat's body can do.
        tick: ticks since the last reset. space: each seat's free-space grid.
    """

    def __init__(
        self,
        house: HouseSpec | str,
        robots: Iterable[RobotSpec | str] = (),
        objects: Iterable[tuple[str, str]] = contents.DEFAULT_OBJECTS,
    ) -> None:
        self.house = houses.load(house) if isinstance(house, str) else house
        specs: list[BodySpec] = [avatar.HUMAN]
        specs += [bodies.robot(robot) if isinstance(robot, str) else robot for robot in robots]
        self.seats = bodies.seat_names(len(specs) - 1)
        self.bodies = dict(zip(self.seats, specs, strict=True))
        self.space = {seat: FreeSpace.of(self.house, spec.radius, spec.height) for seat, spec in self.bodies.items()}
        self._contents = contents.split(self.house, objects)
        self._task = HouseTask(self.house, self._contents, self.bodies)
        self._env = FastEnv(self._task)
        self._assemble()
        self.tick, self._episode = 0, 0
        starts.stand(tuple(self._seats.values()), self.house.start, ())
        self._begin({})

    def _assemble(self) -> None:
        """The parts that share the compiled model."""
        statics, env = self._contents.statics, self._env
        places = Places(statics)
        self._scene = Scene(env, self._task)
        self._objects = Objects(self._contents.movables, env, self._scene, places)
        self._doors = Doors(self._task.doors, env)
        self._seats = {name: Seat(name, spec, self.space[name]) for name, spec in self.bodies.items()}
        self._scanners = {name: Scanner(seat.spec, seat.space, self.house) for name, seat in self._seats.items()}
        self._hands = Hands(self.house, self._scene, self._objects, self._doors, places)
        seats = tuple(self._seats.values())
        self._gaze = Gaze(self._scene, self._objects, self._doors, statics, self.house.openings, seats)
        self._others = {seat.name: tuple(other for other in seats if other is not seat) for seat in seats}
        self._obstacles = Obstacles(self.house)
        self._pictures = Pictures(self.house, env, self._scene, self._seats)

    @property
    def model(self) -> Any:
        """The compiled `mujoco.MjModel`, for whoever wants the engine itself; changing it voids every promise here."""
        return self._env.model

    # ------------------------------------------------------------------------------------------------------- episodes

    def reset(self, task: TaskSpec) -> None:
        """Begin a task: its objects in place and asleep, the house's own where the house has them, all doors closed.

        A body whose start is not free stands at the nearest free place; a robot for which the task gives no start,
        at the nearest place to the first robot's start that keeps clear of the others.

        Raises:
            TaskError: when the task belongs to another house or places an object that this world does not have.
        """
        if task.house_sha256 and self.house.sha256 and task.house_sha256 != self.house.sha256:
            raise TaskError(task.id, "house_sha256", f"made for another version of house '{task.house}'; make it anew")
        self._begin({placement.id: placement for placement in task.objects}, task.id)
        starts.stand(tuple(self._seats.values()), task.human_start, task.robot_starts)

    def _begin(self, placements: dict[str, Placement], task: str = "") -> None:
        movables = {movable.id: movable for movable in self._contents.movables}
        for id in placements:
            if id not in movables:
                raise TaskError(task, "objects", str(UnknownName("object", id, movables)))
        self._rooms = dict.fromkeys(self.seats, 0)
        begin: dict[str, tuple[Vec3, float, str]] = {}
        for id, movable in movables.items():
            placed = placements.get(id)
            if placed is not None:
                begin[id] = (placed.position, placed.yaw, placed.support)
            elif movable.home is not None:
                begin[id] = (movable.home, movable.yaw, movable.support)
        self._task.starts = {id: (position, yaw) for id, (position, yaw, _) in begin.items()}
        self._env.reset()
        self._objects.reset(begin)
        self._doors.reset()
        self.tick = 0
        self._episode += 1
        self._events: list[Event] = []
        self._things: dict[str, ThingState] = {}
        self._things_version = (-1, -1)
        self._view: tuple[Any, tuple[str, ...]] = (None, ())

    # -------------------------------------------------------------------------------------------------------- motions

    def idle(self, seat: str) -> bool:
        """Whether the seat's body is free for a new motion."""
        return self._seats[seat].activity is None

    def start(self, seat: str, action: Motion) -> None:
        """Begin a motion. One that a law forbids is refused: see `outcome`, and the next `advance` reports it."""
        body = self._seats[seat]
        verb = interaction.verb_of(action)
        reason = f"{seat} is busy with another motion" if body.activity is not None else self._refusal(body, action)
        if reason:
            body.outcome = Outcome(motion=verb, ok=False, reason=reason)
            data = {"motion": verb, "reason": reason}
            self._events.append(Event(tick=self.tick, seat=seat, kind="refused", data=data))
            return
        body.activity = self._activity(body, action)

    def _refusal(self, seat: Seat, action: object) -> str:
        if isinstance(action, (Pick, Place, Open, Close)):
            return self._hands.refusal(seat, action)
        if isinstance(action, (Move, Rotate, Wait)):
            return motion.refusal(seat, action)
        return f"{type(action).__name__} is not a motion; valid: Move, Rotate, Pick, Place, Open, Close, Wait"

    def _activity(self, seat: Seat, action: Motion) -> Activity:
        if isinstance(action, Move):
            return motion.Going(seat, action, self._others[seat.name], self._culprit)
        if isinstance(action, Rotate):
            return motion.Turning(seat, action)
        if isinstance(action, Wait):
            return motion.Waiting(action)
        return interaction.Handing(seat, action, self._hands)

    def outcome(self, seat: str) -> Outcome | None:
        """How the seat's last motion ended, None before any has."""
        return self._seats[seat].outcome

    def advance(self) -> tuple[Event, ...]:
        """Let one tick pass: every busy body moves, in the order of the seats, then objects fall and doors swing.

        Returns:
            what happened: picked, placed, opened, closed, refused, blocked (by the house), in_way (of another body).

        Raises:
            RuntimeError: when the engine reports a state it cannot go on from.
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
            self._objects.settle()
            self._check()
        return tuple(sorted(events, key=lambda event: event.tick))

    def _check(self) -> None:
        complaints = self._env.warnings()
        if complaints:
            raise RuntimeError(
                f"the physics of house '{self.house.id}' broke down at tick {self.tick}: {', '.join(complaints)}; "
                "most likely two objects were placed into each other, see `houses.check` and the task's objects"
            )

    def _culprit(self, seat: Seat, step: Vec2) -> str:
        """What the body would have run into: the nearest thing's id, or "wall"."""
        return self._obstacles.nearest((seat.pose.x + step[0], seat.pose.y + step[1]), seat.spec.height)

    def teleport(self, seat: str, pose: Pose) -> None:
        """Put a body somewhere at once; what it was doing ends.

        Raises:
            HthorError: when its body does not fit there.
        """
        body = self._seats[seat]
        if not body.space.is_free(pose.x, pose.y):
            raise HthorError(f"({pose.x:.2f}, {pose.y:.2f}) is not free for {seat}; try space['{seat}'].nearest_free")
        body.pose, body.activity = pose, None
        if body.holding:
            self._objects.follow(body.holding)

    # ---------------------------------------------------------------------------------------------------------- truth

    @property
    def still(self) -> bool:
        """Whether every object and door is at rest, but for what someone carries."""
        return self._env.still

    @property
    def moment(self) -> tuple[int, int]:
        """Episode and tick: what an observation belongs to."""
        return (self._episode, self.tick)

    def pose(self, seat: str) -> Pose:
        """Where the seat's body is."""
        return self._seats[seat].pose

    def holding(self, seat: str) -> str:
        """Id of the object in the seat's hand, empty for none."""
        return self._seats[seat].holding

    def room(self, seat: str) -> str:
        """Id of the room the seat's body is in, the last one while it is between rooms."""
        rooms, place = self.house.rooms, self._seats[seat].pose
        last = self._rooms[seat]
        if not geometry.inside((place.x, place.y), rooms[last].polygon):
            for number, room in enumerate(rooms):
                if geometry.inside((place.x, place.y), room.polygon):
                    self._rooms[seat] = last = number
                    break
        return rooms[last].id

    def truth(self) -> tuple[ThingState, ...]:
        """True states of all objects and openable things, by id."""
        return tuple(self._states().values())

    def snapshot(self) -> Snapshot:
        """The truth at this tick, for the umpire and the log."""
        seats = self._seats.values()
        return Snapshot(
            tick=self.tick,
            poses={seat.name: seat.pose for seat in seats},
            things=self._states(),
            in_view={HUMAN: self._in_view()},
            holding={seat.name: seat.holding for seat in seats},
        )

    def _states(self) -> dict[str, ThingState]:
        """A fresh dict whenever anything changed, the same one as long as nothing did."""
        version = (self._objects.changes, self._doors.changes)
        if version != self._things_version:
            states = [*(item.state() for item in self._objects if item.present), *self._doors.states()]
            self._things = {state.id: state for state in sorted(states, key=lambda state: state.id)}
            self._things_version = version
        return self._things

    def _in_view(self) -> tuple[str, ...]:
        seat = self._seats[HUMAN]
        key = (seat.pose, self._objects.changes, self._doors.changes)
        if self._view[0] is None or key != self._view[0]:
            self._view = (key, self._gaze.in_view(seat, rules.FIND_RANGE_M))
        return self._view[1]

    # -------------------------------------------------------------------------------------------------------- senses

    def senses(self, seat: str) -> Senses:
        """What the seat perceives at this tick."""
        return SeatSenses(self, seat)

    def detections(self, seat: str) -> tuple[Detection, ...]:
        """What the seat's detector reports now, by id."""
        return self._gaze.detections(self._seats[seat])

    def scan(self, seat: str) -> Scan:
        """What the seat's range scanner measures now."""
        return self._scanners[seat].scan(self._seats[seat].pose)

    # ------------------------------------------------------------------------------------------------------ pictures

    @property
    def names(self) -> tuple[str, ...]:
        """What the numbers of a segmentation stand for: things, seats, rooms, walls and openings."""
        return self._scene.names

    def picture(self, seat: str, mode: str = "rgb", size: tuple[int, int] = IMAGE_SIZE) -> Any:
        """The seat's own view now; ``mode`` is rgb, depth or segmentation, ``size`` (width, height) in pixels.

        Raises:
            RenderingUnavailable: when no OpenGL back end works.
        """
        return self._pictures.view(seat, mode, size)

    def frame(self, seat: str, size: tuple[int, int] = IMAGE_SIZE) -> Callable[[], Any]:
        """The seat's own view of this very moment, (H, W, 3) uint8, drawn if and when it is called."""
        return self._pictures.frame(seat, size)

    def top_view(self, pixels_per_metre: float = 50.0) -> Any:
        """The house from above without its ceilings, (H, W, 3) uint8, covering `top_view_bounds`; north (+y) is up."""
        return self._pictures.top_view(pixels_per_metre)

    @property
    def top_view_bounds(self) -> tuple[float, float, float, float]:
        """x0, y0, x1, y1 [m] of the top view: the rooms and a small margin."""
        return self._pictures.bounds
