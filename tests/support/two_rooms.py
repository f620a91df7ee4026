"""A house of two bare rooms with a doorway between them, and things to put into it."""

from __future__ import annotations

from hthor import catalog
from hthor.geometry.plane import to_house
from hthor.types import HouseSpec, Opening, Pose, Room, Thing, Vec2, Wall

SIDE = 5.0


def thing(id: str, kind: str, x: float, y: float, yaw: float = 0.0, bottom: float = 0.0, **more: object) -> Thing:
    size = catalog.kind(kind).size
    centre = (x, y, bottom + size[2] / 2)
    row: dict[str, object] = {"id": id, "kind": kind, "asset": "", "centre": centre, "size": size, "yaw": yaw}
    return Thing(**{**row, "room": "a" if x < SIDE else "b", **more})  # type: ignore[arg-type]


def on(id: str, kind: str, support: Thing, u: float = 0.0, v: float = 0.0, surface: int = 0) -> Thing:
    """A small thing on a surface of another, at shares of its half extents."""
    rest = catalog.kind(support.kind).surfaces(support.size)[surface]
    local = (rest.centre[0] + u * rest.half[0], rest.centre[1] + v * rest.half[1], rest.centre[2])
    x, y, z = to_house(local, support.centre, support.yaw)
    return thing(id, kind, x, y, support.yaw, z, parent=support.id, room=support.room)


def house(*things: Thing, door: float = 0.9, start: Vec2 = (2.5, 0.7), width: float = SIDE) -> HouseSpec:
    """Two square rooms side by side with a doorway in the middle of the wall between them."""
    rooms, walls = [], []
    for name, x0, x1 in (("a", 0.0, SIDE), ("b", SIDE, SIDE + width)):
        corners = ((x0, 0.0), (x1, 0.0), (x1, SIDE), (x0, SIDE))
        rooms.append(Room(id=name, kind="bedroom", name=name, polygon=corners))
        for k in range(4):
            walls.append(Wall(id=f"{name}{k}", room=name, a=corners[k], b=corners[(k + 1) % 4], height=2.6))
    low, high = SIDE / 2 - door / 2, SIDE / 2 + door / 2
    doorway = Opening(
        id="door", kind="door", rooms=("a", "b"), a=(SIDE, low), b=(SIDE, high), low=0.0, high=2.05, passable=True
    )
    pose = Pose(x=start[0], y=start[1])
    return HouseSpec(
        id="made",
        sha256="",
        rooms=tuple(rooms),
        walls=tuple(walls),
        openings=(doorway,),
        things=things,
        height=2.6,
        start=pose,
    )


TABLE = thing("table", "dining_table", 2.5, 2.5)
