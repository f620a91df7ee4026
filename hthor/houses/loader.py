"""From the content of a house file to a `HouseSpec`: frames turned, rooms named, doors classified.

Unity's (x, y up, z) becomes the house frame's (x, z, y), and its clockwise yaw a counter-clockwise one.
"""

import math
from collections import Counter
from pathlib import Path
from typing import Any

from hthor import jsonio
from hthor.errors import HouseError
from hthor.geometry.plane import signed_area, wrap
from hthor.houses import laying, schema, worktops
from hthor.houses.assets import Assets
from hthor.houses.checks import structure
from hthor.houses.checks.structure import EXTERIOR, ROOM_KINDS
from hthor.houses.schema import Agent, HouseFile, OpeningRow, RoomRow, WallRow
from hthor.types import HouseSpec, Opening, Pose, Room, Thing, Vec3, Wall


def house_from_document(document: Any, name: str) -> HouseSpec:
    """A house from a document in memory, such as `hthor.houses.generator` makes; ``name`` becomes its id.

    Raises:
        HouseError: naming ``name`` as the file, and the field.
    """
    house = schema.convert_document(document, name)
    structure.validate_structure(house, name)
    return convert_house(house, name, jsonio.sha256(document), name, Assets(Path()))


def convert_house(house: HouseFile, name: str, sha256: str, file: str, assets: Assets) -> HouseSpec:
    """A house from the valid content of a house file.

    Args:
        name: the house's id. sha256: of the file's document. file: what errors call it. assets: kinds and sizes.

    Raises:
        HouseError: naming ``file`` and the field.
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
    )
    return laying.snap_objects(spec)


def _rooms(rows: list[RoomRow]) -> tuple[Room, ...]:
    """Rooms named by their kind, numbered where a kind comes more than once: kitchen, bedroom 1, bedroom 2."""
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
    # ProcTHOR gives the outer face of an outer wall the id of the room behind it; only the wall's own id shows it.
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
    # Door frames carry no openness: nothing hangs in them. A door that can be opened stands open when a trial begins.
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
    for where, row, parent in structure.iter_objects(house):
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
            parent=worktops.unit_below((at.x, at.z), units[parent]).id if parent in units else parent,
        )
        units[row.id] = worktops.split_worktop(thing, asset.plan)
        things += units[row.id]
    return tuple(things)


def _pose(agent: Agent) -> Pose:
    heading = wrap(math.pi / 2 - math.radians(agent.rotation.y))
    return Pose(x=agent.position.x, y=agent.position.z, yaw=heading, pitch=0.0 - math.radians(agent.horizon))
