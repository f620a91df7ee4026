"""Converts the content of a house file to a `HouseSpec`: turns frames, names rooms, classifies doors.

Unity's (x, y up, z) becomes the house frame's (x, z, y), and its clockwise yaw a counter-clockwise one.

An L- or C-shaped worktop, for which ProcTHOR's database gives one bounding box up to 3 m square, becomes the straight
units that it is made of, each a separate thing with its front to the inside. So it has a worktop's depth everywhere,
for walking, reaching, seeing and searching.
"""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec

from hthor import jsonio
from hthor.errors import HouseError
from hthor.geometry.plane import distance_to_rectangle, signed_area, to_house, wrap
from hthor.houses import laying, schema
from hthor.houses.assets import Assets
from hthor.houses.checks import ids, structure
from hthor.houses.checks.ids import EXTERIOR
from hthor.houses.checks.structure import ROOM_KINDS
from hthor.houses.schema import Agent, HouseFile, OpeningRow, RoomRow, WallRow
from hthor.types import HouseSpec, Opening, Pose, Room, Thing, Vec2, Vec3, Wall

DEPTH_M = 0.61
"""Depth of a worktop: that of ProcTHOR's straight worktops."""
_LEAST_M = 0.1


def house_from_document(document: Any, name: str) -> HouseSpec:
    """A house from a document in memory, such as `hthor.houses.generator` makes; ``name`` becomes its id.

    Raises:
        HouseError: names ``name`` as the file, and the field.
    """
    house = schema.convert_document(document, name)
    structure.validate_structure(house, name)
    return convert_house(house, name, jsonio.sha256(document), name, Assets(Path()))


def convert_house(house: HouseFile, name: str, sha256: str, file: str, assets: Assets) -> HouseSpec:
    """A house with the id ``name``, from the valid content of a house file, which errors call ``file``.

    Raises:
        HouseError: names ``file`` and the field.
    """
    walls = {wall.id: wall for wall in house.walls}
    found = structure.find_start(house)
    if found is None:
        raise HouseError(file, "metadata.agent", "is missing")
    spec = HouseSpec(
        id=name,
        sha256=sha256,
        rooms=_rooms(house.rooms),
        walls=tuple(_wall(wall) for wall in house.walls if not wall.empty),
        openings=(
            *(_opening(row, walls[row.wall0], door=True) for row in house.doors),
            *(_opening(row, walls[row.wall0], door=False) for row in house.windows or ()),
        ),
        things=_things(house, file, assets),
        height=max(high for _, high in map(structure.wall_heights, house.walls)),
        start=_pose(found[1]),
        start_source=found[0],
    )
    return laying.snap_objects(spec)


def _rooms(rows: list[RoomRow]) -> tuple[Room, ...]:
    """Rooms named by their kind, numbered if a kind occurs more than once: kitchen, bedroom 1, bedroom 2."""
    total = Counter(row.room_type for row in rows)
    seen: Counter[str] = Counter()
    rooms = []
    for row in rows:
        seen[row.room_type] += 1
        kind = ROOM_KINDS[row.room_type]
        title = kind.replace("_", " ")
        number = f" {seen[row.room_type]}" if total[row.room_type] > 1 else ""
        corners = structure.floor_polygon(row)
        polygon = corners if signed_area(corners) > 0.0 else corners[::-1]
        material = row.floor_material.name if row.floor_material is not None else ""
        rooms.append(Room(id=row.id, kind=kind, name=title + number, polygon=polygon, floor=material))
    return tuple(rooms)


def _wall(row: WallRow) -> Wall:
    a, b = structure.wall_line(row)
    low, high = structure.wall_heights(row)
    material = row.material if row.material is not None else schema.Material()
    color = material.color
    rgb: Vec3 | None = None if color is None else (color.r, color.g, color.b)
    # ProcTHOR gives the outer face of an outer wall the id of the room behind it; only the wall's own id differs.
    room = EXTERIOR if row.id.startswith(f"wall|{EXTERIOR}|") else row.room_id
    return Wall(id=row.id, room=room, a=a, b=b, height=high - low, material=material.name, rgb=rgb)


def _opening(row: OpeningRow, wall: WallRow, *, door: bool) -> Opening:
    start, end = structure.wall_line(wall)
    length = math.dist(start, end)
    ux, uy = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    near, far = sorted(corner.x for corner in row.hole_polygon)
    low, high = sorted(corner.y for corner in row.hole_polygon)
    beyond = EXTERIOR if row.room1 == row.room0 else row.room1
    indoors = EXTERIOR not in (row.room0, beyond)
    # Door frames have no openness, as they have no leaf. A door that can be opened stands open when a trial begins.
    passable = door and indoors and (row.openness is None or row.openness > 0.0 or bool(row.openable))
    return Opening(
        id=row.id,
        kind="door" if door else "window",
        rooms=(row.room0, beyond),
        a=(start[0] + ux * near, start[1] + uy * near),
        b=(start[0] + ux * far, start[1] + uy * far),
        low=low,
        high=high,
        passable=passable,
        openable=passable and bool(row.openable),
        asset=row.asset_id,
    )


def _things(house: HouseFile, file: str, assets: Assets) -> tuple[Thing, ...]:
    rooms = [(room.id, structure.floor_polygon(room)) for room in house.rooms]
    things: list[Thing] = []
    units: dict[str, tuple[Thing, ...]] = {}
    for where, row, parent in ids.iter_objects(house):
        asset = assets.find(row.asset_id, file, f"{where}.assetId")
        at = row.position
        thing = Thing(
            id=row.id,
            kind=asset.kind,
            asset=row.asset_id,
            variant=asset.variant,
            centre=(at.x, at.z, at.y),
            size=asset.size,
            yaw=wrap(0.0 - math.radians(row.rotation.y)),
            room=structure.room_at((at.x, at.z), rooms) or "",
            parent=unit_below((at.x, at.z), units[parent]).id if parent in units else parent,
            tilt=(wrap(math.radians(row.rotation.x)), wrap(math.radians(row.rotation.z))),
            source=where,
        )
        units[row.id] = split_worktop(thing, asset.plan)
        things += units[row.id]
    _check_units(house, file, units)
    return tuple(things)


def _check_units(house: HouseFile, file: str, units: Mapping[str, Sequence[Thing]]) -> None:
    """Refuse an id that hthor gives to a unit of a worktop."""
    named = {unit.id: first for first, *others in units.values() for unit in others}
    for where, name in ids.iter_ids(house):
        if name in named:
            problem = f"the id '{name}' is taken by a part of the worktop '{named[name].id}' ({named[name].source})"
            raise HouseError(file, f"{where}.id", f"{problem}; choose another id")


def _pose(agent: Agent) -> Pose:
    heading = wrap(math.pi / 2 - math.radians(agent.rotation.y))
    return Pose(x=agent.position.x, y=agent.position.z, yaw=heading, pitch=0.0 - math.radians(agent.horizon))


def split_worktop(thing: Thing, plan: str) -> tuple[Thing, ...]:
    """The units of a worktop whose bounding box is ``thing``; the first is along the back and has the worktop's id.

    Args:
        plan: "L", along the back and forward on the right, as seen from behind; "C", along the back and forward on
            both sides; anything else, or a box too small for units, gives the thing itself.
    """
    w, d, _ = thing.size
    wide = DEPTH_M * {"L": 1, "C": 2}.get(plan, 0)
    if not wide or w < wide + _LEAST_M or d < DEPTH_M + _LEAST_M:
        return (thing,)
    return tuple(_units(thing, plan))


def unit_below(place: Vec2, parts: Sequence[Thing]) -> Thing:
    """The unit under a place [m] on the plan, or the nearest unit."""
    return min(parts, key=lambda one: distance_to_rectangle(place, one.centre[:2], one.size[:2], one.yaw))


def _units(thing: Thing, plan: str) -> Iterator[Thing]:
    w, d, _ = thing.size
    left = -w / 2 + (DEPTH_M if plan == "C" else 0.0)
    right, front = w / 2 - DEPTH_M, DEPTH_M - d / 2
    yield _unit(thing, "", (left, -d / 2), (right, front), 0)
    yield _unit(thing, "right_corner", (right, -d / 2), (w / 2, front), 0)
    yield _unit(thing, "right", (right, front), (w / 2, d / 2), 1)
    if plan == "C":
        yield _unit(thing, "left_corner", (-w / 2, -d / 2), (left, front), 0)
        yield _unit(thing, "left", (-w / 2, front), (left, d / 2), -1)


def _unit(thing: Thing, name: str, low: Vec2, high: Vec2, turns: int) -> Thing:
    """The unit between two corners [m] of the worktop's frame, turned by this number of quarter turns."""
    (x0, y0), (x1, y1) = low, high
    across, along = (x1 - x0, y1 - y0) if not turns else (y1 - y0, x1 - x0)
    return msgspec.structs.replace(
        thing,
        id=f"{thing.id}|{name}" if name else thing.id,
        centre=to_house(((x0 + x1) / 2, (y0 + y1) / 2, 0.0), thing.centre, thing.yaw),
        size=(across, along, thing.size[2]),
        yaw=wrap(thing.yaw + turns * math.pi / 2),
    )
