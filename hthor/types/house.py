"""Houses as data: rooms, walls, openings and things, with their frames and units."""

from typing import Literal

from msgspec import UNSET, Struct, UnsetType

Vec2 = tuple[float, float]
Vec3 = tuple[float, float, float]
Rgba = tuple[float, float, float, float]

HUMAN = "human"
"""The first person's seat; other people sit at ``human2``, ``human3`` ..., robots at ``robot``, ``robot2`` ..."""


def is_person(seat: str) -> bool:
    """Whether a person sits at this seat."""
    return seat.startswith(HUMAN)


class Pose(Struct, frozen=True, kw_only=True):
    """A body's place and heading in the house frame, and where its head points.

    Attributes:
        x, y: [m]. yaw: [rad] the body's heading, counter-clockwise from +x.
        pitch: [rad] of the camera, up positive.
        head: [rad] heading of the head relative to the body, left positive; unset while both point the same way.
    """

    x: float
    y: float
    yaw: float = 0.0
    pitch: float = 0.0
    head: float | UnsetType = UNSET

    @property
    def gaze(self) -> float:
        """Heading of the camera [rad], house frame."""
        return self.yaw if self.head is UNSET else self.yaw + self.head


class Part(Struct, frozen=True, kw_only=True):
    """One solid that a thing consists of, in the thing's local frame.

    ``half`` [m] holds the half extents of its bounding box: (r, r, half height) of an upright cylinder, (r, r, r) of a
    sphere. ``axis`` is a cylinder's direction. ``moves`` names the `Joint` that moves the solid, empty for none.
    """

    shape: Literal["box", "cylinder", "sphere"]
    centre: Vec3
    half: Vec3
    rgba: Rgba
    axis: Literal["x", "y", "z"] = "z"
    moves: str = ""


class Surface(Struct, frozen=True, kw_only=True):
    """A flat place of a thing where objects can rest, in the thing's local frame.

    ``centre`` [m] is the middle of the surface, ``half`` [m] its half extents along local x and y, ``clearance`` [m]
    the free height above it. ``inside`` marks a surface that is accessible only while a door is open. ``moves`` names
    the `Joint` that moves the surface, such as a drawer's floor; ``centre`` is then its place while closed.
    """

    name: str
    centre: Vec3
    half: Vec2
    clearance: float
    inside: bool = False
    moves: str = ""


class Joint(Struct, frozen=True, kw_only=True):
    """How a door turns or a drawer slides, in the thing's local frame: position 0 is closed, ``travel`` is open.

    A hinge turns by ``travel`` [rad] about the unit vector ``axis`` through ``anchor`` [m], right-handed; a slide goes
    ``travel`` [m] along ``axis``. All joints of a thing move together.
    """

    name: str
    kind: Literal["hinge", "slide"]
    anchor: Vec3
    axis: Vec3
    travel: float


class Thing(Struct, frozen=True, kw_only=True):
    """A piece of furniture or a small object of a house, at the place where it stands or lies.

    ``centre`` [m] house frame is the middle of the bounding box, ``size`` [m] its extents along the thing's local
    x (width), y (depth) and z (height) axes. ``variant`` picks one of the kind's finishes, for looks only.
    ``lift`` [m] is how far it was lowered from its height in the house's file (`hthor.houses.laying`).
    ``tilt`` [rad] are the file's turns about its own x and z axes: hthor puts everything upright, so that they change
    nothing here. ``source`` is the thing's field in the file, such as ``objects[3].children[0]``; empty without one.
    """

    id: str
    kind: str
    asset: str
    variant: int = 0
    centre: Vec3
    size: Vec3
    yaw: float
    room: str = ""
    parent: str = ""
    lift: float = 0.0
    tilt: Vec2 = (0.0, 0.0)
    source: str = ""


class Room(Struct, frozen=True, kw_only=True):
    """A room: ``kind`` is one of kitchen, living_room, bedroom, bathroom; ``polygon`` [m] runs counter-clockwise."""

    id: str
    kind: str
    name: str
    polygon: tuple[Vec2, ...]
    floor: str = ""


class Wall(Struct, frozen=True, kw_only=True):
    """A rectangular wall face on the side of ``room`` (or "exterior"), from ``a`` to ``b`` and ``height`` tall [m]."""

    id: str
    room: str
    a: Vec2
    b: Vec2
    height: float
    material: str = ""
    rgb: Vec3 | None = None


class Opening(Struct, frozen=True, kw_only=True):
    """A hole in a wall, above the floor segment from ``a`` to ``b`` [m], between the heights ``low`` and ``high`` [m].

    A ``passable`` opening is an open doorway; windows and the closed outside door are not passable. An ``openable``
    doorway has a door, which stands open when a trial begins; other doorways have none. ``asset`` is what fills it.
    """

    id: str
    kind: Literal["door", "window"]
    rooms: tuple[str, str]
    a: Vec2
    b: Vec2
    low: float
    high: float
    passable: bool
    openable: bool = False
    asset: str = ""


class HouseSpec(Struct, frozen=True, kw_only=True):
    """A floor plan with everything in it.

    Attributes:
        id: the house's name. sha256: hash of the canonical JSON of the house's file.
        rooms, walls, openings, things: its contents, in the house frame [m]; ids are unique within the house.
        height: [m] of the ceilings. start: where bodies stand unless a task gives other starts.
        start_source: the start's field in the house's file; empty without one.
    """

    id: str
    sha256: str
    rooms: tuple[Room, ...]
    walls: tuple[Wall, ...]
    openings: tuple[Opening, ...]
    things: tuple[Thing, ...]
    height: float
    start: Pose
    start_source: str = ""
