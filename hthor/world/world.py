"""A simulation to control by hand: set up a house, move bodies, take pictures, pass messages.

from hthor.world import World

with World("hazel", robots=["tender"]) as world:
    world.robot.go_to("fridge")
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from hthor import gc_freeze, houses, rules
from hthor.comms import map_picture
from hthor.comms.display import Displays
from hthor.comms.mailbox import Mailbox
from hthor.errors import HthorError, UnknownName
from hthor.houses.space.free_space import FreeSpace
from hthor.looks.pack import Pack
from hthor.types import (
    HUMAN,
    Camera,
    CameraSpec,
    Detection,
    DetectorSpec,
    Display,
    Drive,
    HouseSpec,
    Message,
    Motion,
    Outcome,
    Placement,
    Pose,
    Receipt,
    RobotSpec,
    Scan,
    Senses,
    Sighting,
    Snapshot,
    TaskSpec,
    Thing,
    ThingState,
    Vec2,
    Vec3,
    View,
)
from hthor.types.events import Event
from hthor.world import numbers
from hthor.world.actor import Actor
from hthor.world.conversation import Conversation
from hthor.world.model import inventory
from hthor.world.model.composer_env import LazyComposerEnv
from hthor.world.pictures import Pictures
from hthor.world.rendering.lazy_images import Size
from hthor.world.rendering.scene.scene_parts import SceneParts
from hthor.world.rendering.viewpoint import Viewpoint
from hthor.world.scene_setup import SceneSetup
from hthor.world.sensors import Sensors, SurveyReading
from hthor.world.simulation import Closed, Simulation
from hthor.world.things import Things
from hthor.world.walk_planner import WalkPlanner

_MOTION_TICKS_MAX = 36_000
"""[ticks] An hour: the most that `run` waits for the end of a motion."""
_STEP_TICKS_MAX = 864_000
"""[ticks] A day: the most that one call of `step` accepts."""


class World:
    """A house with people and robots in it, for trials, notebooks, studies and scripts.

    ``human``, ``robot`` and ``actor(seat)`` are the bodies; a call on one of them lets time pass until its motion ends.
    Each call here is one of a part, which does the work: ``simulation`` lets ticks pass, ``scene_setup`` changes the
    scene at once, ``things`` looks things up, ``walks`` plans `Actor.go_to`, ``sensors`` and ``pictures`` show what
    seats sense, and ``conversation`` keeps messages and events.

    Args:
        house: a name of `scenes`, the path of a house file, or a `HouseSpec`.
        robots: the robots' bodies, by name, by path or as `RobotSpec`; their seats are "robot", "robot2", ...
        objects: (id, kind) pairs of spare objects, which `put_object` brings into the house; by default the benchmark's
            six targets, each with its kind's name as id.
        detectors: the robots' detectors, in the order of the robots: records, or texts that
            `hthor.types.detector_specs.parse` reads; the default "own" is the detector that the body declares.
        profile: how pictures are drawn unless a call names another profile: "fast" needs only the processor, "nice" is
            for people and needs OpenGL.
        assets: a furniture pack, or its name; the profile "nice" shows its furniture where it has any, else our own.
        cameras: the robots' cameras, in the order of the robots: records, or texts that `hthor.types.cameras.parse`
            reads; by default each body's own.
        people: how many people there are; their seats are "human", "human2", ...

    Attributes:
        house: the floor plan. seats: names of all seats, the people's first. bodies: the body in each seat.
        robots: names of the robots' seats. detectors, cameras: of the robots, by seat.
    """

    def __init__(
        self,
        house: HouseSpec | str | Path,
        robots: Iterable[RobotSpec | str | Path] = (),
        objects: Iterable[tuple[str, str]] = inventory.DEFAULT_OBJECTS,
        detectors: Iterable[DetectorSpec | str] = (),
        profile: str = "fast",
        assets: Pack | str = "",
        cameras: Iterable[CameraSpec | str] = (),
        people: int = 1,
    ) -> None:
        self.simulation = simulation = Simulation(house, robots, objects, detectors, people)
        self.pictures = Pictures(simulation, profile, assets, cameras)
        self.sensors = Sensors(simulation, self.pictures)
        self.scene_setup, self.things = SceneSetup(simulation), Things(simulation)
        self.walks = WalkPlanner(simulation, self.things)
        self.conversation = Conversation(simulation.seats, simulation.pose)
        self.house, self.seats, self.bodies = simulation.house, simulation.seats, simulation.bodies
        self.robots, self.detectors, self.cameras = simulation.robots, simulation.detectors, self.pictures.cameras
        gc_freeze.collect_after_close(self)

    @staticmethod
    def scenes() -> tuple[str, ...]:
        """Names of the houses that come with hthor."""
        return houses.names()

    def close(self) -> None:
        """Give back the memory of the renderers, and, when a fifth of the open worlds were closed, of their engines.

        Pictures, observations and records that were read before stay valid. ``house``, ``seats``, ``robots``,
        ``bodies``, ``detectors``, ``cameras``, ``tick``, ``events`` and ``messages`` can still be read; everything else
        raises `hthor.errors.WorldClosed`, also a picture of before that is drawn only now. Closing twice is fine.
        """
        if isinstance(self.simulation, Closed):
            return
        self.pictures.close()
        self.simulation.close()
        closed: Any = Closed(self.house.id, tick=self.tick, mail=self.mail, events=self.events)
        self.simulation = self.pictures = self.sensors = self.scene_setup = closed
        self.things = self.walks = self.conversation = closed
        gc_freeze.collect_closed(self)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    # ------------------------------------------------------------------------------------------------------- the bodies

    def actor(self, seat: str) -> Actor:
        """The body in a seat.

        Raises:
            UnknownName: when this world has no such seat.
        """
        if seat not in self.bodies:
            raise UnknownName("seat", seat, self.seats, "Give robots=[...] or people=... when you make the world.")
        return Actor(self, seat)

    @property
    def human(self) -> Actor:
        """The first person."""
        return self.actor(HUMAN)

    @property
    def robot(self) -> Actor:
        """The first robot."""
        return self.actor("robot")

    # ------------------------------------------------------------------------------------------------------- the engine

    @property
    def parts(self) -> Any:
        """The `SimulationParts`, each with its own state, for tests and tools; changes to them go unchecked."""
        return self.simulation.parts

    @property
    def env(self) -> LazyComposerEnv:
        """The `dm_env` environment in which everything is; `hthor.envs.trial_environment` gives it a trial."""
        return self.simulation.parts.env

    @property
    def model(self) -> Any:
        """The compiled `mujoco.MjModel`; changing it makes results undefined."""
        return self.env.model

    @property
    def nbytes(self) -> int:
        """About how much memory it takes: that of the engine's buffers and of its arena.

        The arena stays nearly empty, and Python's objects take about as much instead: for the houses that ship, 15 to
        41 MB were measured, and this gives 26 to 43 MB.
        """
        model, data = self.env.model, self.env.data
        return int(model.nbuffer + data.nbuffer + data.narena)

    # ------------------------------------------------------------------------------------------------ episodes and time

    def reset(self, task: TaskSpec | None = None, seed: int = 0) -> None:
        """Begin an episode of a task: all objects in place and at rest, things closed, doorways open.

        A body whose start is not free stands at the nearest free place. A person without a start in the task stands at
        the free place nearest to the first person's start, such a robot at that nearest to the first robot's start.

        Args:
            task: None for the house as it is, with every body at the house's start.
            seed: decides all random draws of the episode, which are the errors of noisy detectors and the numbers of
                segmentations.

        Raises:
            TaskError: when the task belongs to another house or places an object that this world does not have.
            HthorError: when the task is no `TaskSpec`, or the seed is not a whole number from 0.
        """
        if task is None:
            self.simulation.clear(seed)
        else:
            self.simulation.reset(task, seed)
        self.conversation.begin()

    @property
    def tick(self) -> int:
        """Ticks of 0.1 s since the last reset."""
        return self.simulation.tick

    @property
    def moment(self) -> tuple[int, int, int]:
        """The numbers of the episode, the tick and its step, to which an observation belongs."""
        return self.simulation.moment

    @property
    def space(self) -> dict[str, FreeSpace]:
        """Each seat's free-space grid now, in which shut doorways are obstacles."""
        return self.simulation.space

    def restart(self, task: TaskSpec) -> None:
        """Begin a task as `reset` does, but between two ticks: the ticks and the random draws go on.

        Raises:
            TaskError: as `reset`.
        """
        self.simulation.restart(task)
        self.conversation.begin()

    def idle(self, seat: str) -> bool:
        """Whether the seat's body is free for a new motion; a body that drives is, while its hands are free."""
        return self.simulation.idle(seat)

    def start(self, seat: str, action: Motion) -> None:
        """Begin a motion. If a rule forbids it, `outcome` says why and the next `advance` returns a "refused" event.

        A `Drive` is never refused, and replaces any motion but those of the hands. It is replaced by a `Move`, `Rotate`
        or `Wait`; during a motion of the hands, the body stands.
        """
        self.simulation.start(seat, action)

    def outcome(self, seat: str) -> Outcome | None:
        """How the seat's last motion ended; None before any motion has ended."""
        return self.simulation.outcome(seat)

    def substep(self) -> None:
        """Move the bodies that drive by one of a tick's `hthor.types.SUBTICKS` steps; `advance` makes those left.

        With the same set-points at the same steps, the states are the same, whoever makes the steps. After the last
        step of a tick this does nothing until `advance` was called.
        """
        self.simulation.substep()

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
        return self.simulation.advance()

    @property
    def still(self) -> bool:
        """Whether every door and every object that is not carried is at rest."""
        return self.simulation.still

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

    # -------------------------------------------------------------------------------------------------------- the scene

    def teleport(self, seat: str, pose: Pose) -> None:
        """Put a body somewhere at once; its motion under way, and its drive, end.

        Raises:
            HthorError: when the body does not fit there, another is there, a number is not finite or out of range, or
                the head of a robot is turned.
        """
        self.scene_setup.teleport(seat, pose)

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
        self.scene_setup.put_object(id, position, on=on, yaw=yaw, velocity=velocity)

    def remove_object(self, id: str) -> None:
        """Take an object out of the episode; `put_object` brings it back.

        Raises:
            UnknownName: when there is no object with this id. HthorError: when it is in a hand.
        """
        self.scene_setup.remove_object(id)

    def set_open(self, thing: str, wanted: bool = True) -> None:
        """Open or close a fridge, a drawer or a door at once.

        Raises:
            UnknownName: when no thing with this id opens. HthorError: when something is in its way, or ``wanted`` is
                no bool.
        """
        self.scene_setup.set_open(thing, wanted)

    def rearrange(self, before: Sequence[Placement], after: Sequence[Placement]) -> None:
        """Move the objects whose places differ between two arrangements, also out of hands, and let them rest there.

        Everything else stays as it is: bodies, doors, and objects that have the same place in both arrangements, even
        if they were carried elsewhere. An object that ``after`` leaves out leaves the house. Where somebody has put
        something in the meantime, an object gets the free place nearest to its own on the same support.

        Raises:
            UnknownName: when there is no object with this id. HthorError: when there is no room for an object.
        """
        self.scene_setup.rearrange(before, after)

    def save_state(self) -> bytes:
        """The whole state of the world, for `load_state`; pictures and readings of sensors are not in it."""
        return self.simulation.save_state()

    def load_state(self, state: bytes) -> None:
        """Go back to a state that `save_state` returned: the same motions then have the same results, byte for byte.

        The state may also be of another world of the same house, bodies, objects and detectors.

        Raises:
            HthorError: when the bytes are damaged, or belong to a different world; nothing has changed then.
        """
        self.simulation.load_state(state)

    # ---------------------------------------------------------------------------------------------------- what is where

    def pose(self, seat: str) -> Pose:
        """The pose of the seat's body."""
        return self.simulation.pose(seat)

    def poses(self) -> dict[str, Pose]:
        """The pose of every seat's body, the people's first."""
        return self.simulation.poses()

    def holding(self, seat: str) -> str:
        """Id of the object in the seat's hand, empty for none."""
        return self.simulation.holding(seat)

    def room(self, seat: str) -> str:
        """Id of the room that the seat's body is in; between rooms, of the room that it was in last."""
        return self.simulation.room(seat)

    def truth(self) -> tuple[ThingState, ...]:
        """True states of all objects and openable things, by id."""
        return self.simulation.truth()

    def snapshot(self) -> Snapshot:
        """The true state at this tick, for judging and logging."""
        return self.simulation.snapshot()

    def objects(self, kind: str = "", room: str = "") -> tuple[ThingState, ...]:
        """True states of the objects that can be picked up, by id; only of ``kind`` and in ``room`` (id) if given.

        Raises:
            UnknownName: when there is no such room or kind.
        """
        return self.things.objects(kind, room)

    def furniture(self, kind: str = "", room: str = "") -> tuple[Thing, ...]:
        """The things that never move, as in the house's file; only those of ``kind`` and in ``room`` if given.

        Raises:
            UnknownName: when there is no such room or kind.
        """
        return self.things.furniture(kind, room)

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
        return self.things.state(id)

    def position(self, id: str) -> Vec3:
        """Centre [m], house frame, of an object, a thing, a doorway or a seat's body (at the height of its eye).

        Raises:
            UnknownName: when nothing has this id.
        """
        return self.things.position(id)

    def hindrance(self, seat: str, id: str, place: Vec2 | None = None) -> str:
        """Why a body could not use a thing with what it has in hand now; empty when it could.

        An object is used by picking it up, as if the hand were empty. Furniture is used by placing on or in it what the
        body holds, else by opening or closing it. Whatever the body has no skill for is no hindrance.

        Args:
            seat: the body's seat. id: the thing or object.
            place: (x, y) [m] where the body would stand, facing the thing; None for its present pose.
        """
        return self.things.hindrance(seat, id, place)

    def in_sight(self, seat: str, id: str, place: Vec2 | None = None, *, picture: bool = False) -> bool:
        """Whether a body has a free line of sight to a thing, an object or another body.

        Args:
            seat: the body's seat. id: the thing, object or body.
            place: (x, y) [m] where the body would stand, facing it; None for its present pose.
            picture: whether what is in sight has to be in the picture of its camera as well.
        """
        return self.things.in_sight(seat, id, place, picture=picture)

    # ----------------------------------------------------------------------------------------------------------- senses

    def senses(self, seat: str) -> Senses:
        """The seat's sensors at this tick."""
        return self.sensors.senses(seat)

    def frozen_senses(self, seat: str) -> Senses:
        """The seat's sensors as they are now, to be read at any later time and in any thread.

        What they measure is measured now; pictures are drawn from poses of now when they are read, one after another if
        several threads read them.
        """
        return self.sensors.frozen_senses(seat)

    def detections(self, seat: str) -> tuple[Detection, ...]:
        """Detections of the seat's detector now, by id, with the detector's errors."""
        return self.sensors.detections(seat)

    def sighting(self, seat: str, id: str) -> Sighting:
        """How visible an object is to the seat now; a share of 0 if it is not in view or not an object."""
        return self.sensors.sighting(seat, id)

    def hidden(self, id: str, eye: Vec3) -> bool:
        """Whether furniture, walls or other objects hide an object from an eye at (x, y, z) [m].

        Raises:
            UnknownName: when there is no object with this id.
        """
        return self.sensors.hidden(id, eye)

    def scan(self, seat: str) -> Scan:
        """The seat's range scan now."""
        return self.sensors.scan(seat)

    def survey(self, seat: str, poses: Iterable[Pose], *, colours: bool = False) -> Iterator[SurveyReading]:
        """What the seat would sense from each of these poses if no other body were in the house.

        For data sets: no time passes, nothing is pushed, and the poses need not be free. The detector is ideal and the
        camera the body's own. Afterwards all bodies are where they were.

        Args:
            colours: whether the readings have colour pictures, too; drawing them takes longer.
        """
        return self.sensors.survey(seat, poses, colours=colours)

    # --------------------------------------------------------------------------------------------------------- pictures

    @property
    def names(self) -> tuple[str, ...]:
        """Ids that the numbers of a segmentation stand for: of things, seats, rooms, walls and openings.

        Every episode shuffles the numbers by its seed. Objects that were not in the house when it began come last.
        """
        return self.pictures.names

    @property
    def label_kinds(self) -> tuple[str, ...]:
        """The kind of what each number of a segmentation stands for, in the order of `names`.

        For things and objects the kind that detections report; else "floor", "ceiling", "wall", "door", "window",
        "person", a robot's name, "ground", "outdoors" or "roof".
        """
        return self.pictures.label_kinds

    @property
    def profile(self) -> str:
        """How pictures are drawn unless a call names another profile."""
        return self.pictures.profile

    def picture(self, seat: str, mode: str = "rgb", size: Size = None, profile: str | None = None) -> NDArray[Any]:
        """The picture of the seat's camera now, without the seat's own body.

        Args:
            mode: rgb (H, W, 3) uint8, depth (H, W) float32 [m] along the optical axis, or segmentation (H, W) int32,
                indices into `names`, -1 for nothing. Depth and segmentation look through glass.
            size: (width, height) [pixels]; None for the camera's own. Pixels are square: a picture whose
                shape differs from that of the body's field of view shows the middle of it.
            profile: "fast", "nice", or None for the world's own.

        Raises:
            ValueError: when mode, size or profile is invalid.
            RenderingUnavailable: when the profile is nice and no OpenGL back end works.
        """
        return self.pictures.picture(seat, mode, size, profile)

    def look(self, seat: str, size: Size = None, profile: str | None = None) -> View:
        """All three pictures of this moment, and the camera that took them; see `picture`."""
        return self.pictures.look(seat, size, profile)

    def camera(self, seat: str, size: Size = None) -> Camera:
        """The pose of the seat's camera now, and its projection for pictures of ``size`` (width, height) [pixels]."""
        return self.pictures.camera(seat, size)

    def frame(self, seat: str, size: Size = None, profile: str | None = None) -> Callable[[], NDArray[np.uint8]]:
        """A function that draws the seat's view of this moment, (H, W, 3) uint8; it may be called later."""
        return self.pictures.frame(seat, size, profile)

    def top_view(self, pixels_per_metre: float = 50.0, profile: str | None = None) -> NDArray[np.uint8]:
        """The house from above without its ceilings, (H, W, 3) uint8, covering `top_view_bounds`; north (+y) is up."""
        return self.pictures.top_view(pixels_per_metre, profile)

    @property
    def top_view_bounds(self) -> tuple[float, float, float, float]:
        """x0, y0, x1, y1 [m] of the top view: the rooms and a small margin."""
        return self.pictures.top_view_bounds

    def overview(
        self, viewpoint: Viewpoint, mode: str = "rgb", size: tuple[int, int] = (640, 480), profile: str | None = None
    ) -> NDArray[Any]:
        """The house now from any viewpoint, without its ceilings; for figures, no seat ever sees it.

        Args:
            mode: rgb (H, W, 3) uint8, or depth (H, W) float32 [m] along the optical axis.
            size: (width, height) [pixels]. profile: "fast", which cuts walls at 1 m, "nice", which shows them whole, or
                None for the world's own.
        """
        return self.pictures.overview(viewpoint, mode, size, profile)

    @property
    def scene(self) -> SceneParts:
        """Everything that can be seen, as plain meshes, for a program that draws the house itself."""
        return self.pictures.scene

    def scene_poses(self) -> NDArray[np.float64]:
        """Where everything in `scene` that moves is now, see `SceneParts.poses`."""
        return self.pictures.scene_poses()

    # ----------------------------------------------------------------------------------------------------- conversation

    @property
    def mail(self) -> Mailbox:
        """The mailbox that `Actor.send` and `Actor.reply` use."""
        return self.conversation.mail

    @property
    def events(self) -> list[Event]:
        """Everything that has happened since the last reset, in order."""
        return self.conversation.events

    @property
    def displays(self) -> Displays:
        """Which parts of the people's displays are shown."""
        return self.conversation.displays

    @property
    def messages(self) -> tuple[tuple[Message, Receipt], ...]:
        """Every message since the last reset, each with its status."""
        return self.mail.messages

    def display(self, seat: str) -> Display:
        """What a person's display shows now.

        Raises:
            HthorError: for a seat that has no display, because it is a robot's.
        """
        return self.conversation.display(seat)

    def map_view(self, seat: str, size: int = map_picture.SIZE_PX) -> NDArray[np.uint8]:
        """The picture of the map on a person's display now, (size, size, 3) uint8.

        The person is in the middle and looks up; around them are the senders of the messages that they confirmed, where
        they are now, and the places that these messages name.

        Raises:
            HthorError: while no map is shown to this seat, or for a size that is no whole number from 40 to 4000.
        """
        return self.conversation.map_view(seat, size)

    def note(self, events: Iterable[Event]) -> None:
        """Add events to `events`."""
        self.conversation.note(events)
