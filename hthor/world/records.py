"""The state of a world as records, from which `hthor.world.saved_state` makes bytes.

Every part of a world that changes during an episode saves its state in a record and can be restored from it. What can
be computed from the rest is not saved. Positions are in the house frame [m], angles in [rad].
"""

from msgspec import Struct

from hthor.types import Close, Drive, Drop, Open, Outcome, Pick, Place, Pose, Rotate, Vec2, Vec3
from hthor.types.events import Event

HandAction = Pick | Place | Drop | Open | Close


class Waiting(Struct, tag="wait", frozen=True):
    """A wait under way: how many ticks are left."""

    left: int


class Moving(Struct, tag="move", frozen=True):
    """A move under way: the way left [m], its direction, and whether a body was in the way. ``load`` is the id of the
    thing that is carried jointly, empty for none.
    """

    left: float
    along: Vec2
    hindered: bool = False
    load: str = ""


class Rotating(Struct, tag="rotate", frozen=True):
    """A rotation under way: the pose at its start, and how many ticks are done."""

    motion: Rotate
    begun: Pose
    done: int


class Turning(Struct, tag="turn", frozen=True):
    """A rotation under way of a body that carries something jointly: the angles left [rad]."""

    yaw: float
    pitch: float


class Handling(Struct, tag="hand", frozen=True):
    """A motion of the hand under way: how many ticks are done."""

    motion: HandAction
    done: int


ActivityState = Waiting | Moving | Rotating | Turning | Handling


class Driving(Struct, frozen=True):
    """A set-point, what the body is in contact with, and since when; see `hthor.world.motion.driving`."""

    drive: Drive
    met: tuple[str, ...] = ()
    towards: Vec2 = (0.0, 0.0)
    clear: float = 0.0


class BodyRecord(Struct, frozen=True):
    """One body; ``room`` is the number of the room that it was in last, ``within`` (x, y, distance) a disc [m] in which
    it surely still is in that room.
    """

    pose: Pose
    holding: str
    outcome: Outcome | None
    activity: ActivityState | None
    drive: Driving | None
    room: int
    within: Vec3


class ObjectRecord(Struct, frozen=True):
    """A movable object of the episode; ``loose`` while it may move, ``ghost`` while nothing collides with it."""

    id: str
    position: Vec3
    yaw: float
    support: str
    held_by: str
    bearers: tuple[str, ...]
    loose: bool
    ghost: bool


class DoorRecord(Struct, frozen=True):
    """The doors of one thing or doorway: how far open (0 to 1), whether they count as open, and who is moving them."""

    id: str
    share: float
    open: bool
    user: str


class LoadRecord(Struct, frozen=True):
    """A thing that bodies hold by its handles; the fields are those of `hthor.world.carrying.trailer.TrailerLoad`."""

    item: str
    ends: dict[str, int]
    up: bool
    leader: str
    tick: int
    z: float
    state: Vec3
    paths: dict[str, tuple[Vec2, ...]]
    steer_angle: float
    steer_left: int


class EngineRecord(Struct, frozen=True):
    """The engine: its arrays and counts by name, and whether and for how long things have been moving."""

    arrays: dict[str, bytes]
    counts: dict[str, float]
    still: bool
    restless: int


class WorldRecord(Struct, frozen=True):
    """The whole world. ``events`` are those that the next `advance` will return; ``steps`` of the tick are done.

    ``spares`` are the objects that were not in the house when the episode began.
    """

    tick: int
    seed: int
    spares: tuple[str, ...]
    steps: int
    events: tuple[Event, ...]
    bodies: dict[str, BodyRecord]
    objects: tuple[ObjectRecord, ...]
    doors: tuple[DoorRecord, ...]
    loads: tuple[LoadRecord, ...]
    engine: EngineRecord
