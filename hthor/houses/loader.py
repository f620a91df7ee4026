"""From a house file to a `HouseSpec`: frames turned, names given, doors judged.

Unity's (x, y up, z) becomes the house frame's (x, z, y), and its clockwise yaw a counter-clockwise one.
"""

from __future__ import annotations

import math
from collections import Counter
from importlib import resources
from pathlib import Path
from typing import Any, Literal

from hthor import jsonio
from hthor.errors import HouseError, UnknownName
from hthor.geometry.plane import signed_area, wrap
from hthor.houses import laying, schema, worktops
from hthor.houses.assets import DATABASE, Assets
from hthor.houses.checks import structure
from hthor.houses.checks.structure import EXTERIOR, ROOM_KINDS
from hthor.houses.schema import Agent, HouseFile, OpeningRow, RoomRow, WallRow
from hthor.types import HouseSpec, Opening, Pose, Room, Thing, Vec3, Wall

_OWN = {
    name: Path(str(resources.files("hthor.houses").joinpath(folder)))
    for name, folder in (("scenes", "data"), ("unseen", "unseen"))
}
_shelves: dict[Path, None] = {}


def names(group: Literal["scenes", "unseen"] = "scenes") -> tuple[str, ...]:
    """The houses that come with hthor: the benchmark's ten scenes, or the ``unseen`` ones that stand beside them."""
    return tuple(sorted(path.stem for path in _OWN[group].glob("*.json")))


def shelve(folder: Path) -> None:
    """Let `load` find the houses of a folder by name, in this process, after those that come with hthor.

    A suite that brings its own houses is read so. Of two folders with a house of one name the one shelved last counts;
    a task holds its house's hash, so that a house that is not the one it was made for is refused.
    """
    _shelves.pop(folder.resolve(), None)
    _shelves[folder.resolve()] = None


def shelves() -> tuple[Path, ...]:
    """The folders given to `shelve`, in order: what another process has to be told."""
    return tuple(_shelves)


def load(name_or_path: str | Path, assets: Path | None = None) -> HouseSpec:
    """A house by name, or from a ProcTHOR house file, JSON schema 1.0.0.

    Args:
        name_or_path: one of `names`, of either group; the name of a house in a folder given to `shelve`; or the path of
            a file.
        assets: a ProcTHOR asset database, or the folder it lies in, for files with foreign assets. Without it the
            database is looked for where the environment variable HTHOR_ASSETS says, then beside the file and in the
            folders above, in ``shared/houses/databases`` of any folder above the current one, and in an installed
            ``procthor`` package.

    Raises:
        UnknownName: when it is neither a name nor a file.
        HouseError: when the file cannot be used; names the file and the field.
    """
    path, file = _locate(str(name_or_path))
    document, house = schema.read(path, file)
    structure.validate(house, file)
    return _build(house, path.stem, jsonio.sha256(document), file, Assets(path, assets))


def build(document: Any, name: str) -> HouseSpec:
    """A house from a document in memory, such as `hthor.houses.generator` makes; ``name`` becomes its id.

    Raises:
        HouseError: as `load`, naming ``name`` as the file.
    """
    house = schema.convert(document, name)
    structure.validate(house, name)
    return _build(house, name, jsonio.sha256(document), name, Assets(Path()))


def _locate(given: str) -> tuple[Path, str]:
    for folder in (*_OWN.values(), *reversed(_shelves)):
        if _plain(given) and (folder / f"{given}.json").is_file():
            return folder / f"{given}.json", f"{given}.json"
    path = Path(given)
    if path.suffix == ".json" or path.is_file():
        return path, given
    known = (
        *names(),
        *names("unseen"),
        *(path.stem for shelf in _shelves for path in sorted(shelf.glob("*.json")) if path.name != DATABASE),
    )
    raise UnknownName("house", given, known, "Or give the path of a ProcTHOR house file (.json).")


def _plain(name: str) -> bool:
    """Whether a name is no path in disguise."""
    return name == Path(name).name and bool(name)


def _build(house: HouseFile, name: str, sha256: str, file: str, assets: Assets) -> HouseSpec:
    walls = {wall.id: wall for wall in house.walls}
    found = structure.start(house)
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
    return laying.lay(spec)


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
        corners = structure.floor(row)
        polygon = corners if signed_area(corners) > 0.0 else corners[::-1]
        material = row.floor_material.name if row.floor_material is not None else ""
        rooms.append(Room(id=row.id, kind=kind, name=title + number, polygon=polygon, floor=material))
    return tuple(rooms)


def _wall(row: WallRow) -> Wall:
    a, b = structure.wall_line(row)
    low, high = structure.wall_heights(row)
    material = row.material if row.material is not None else schema.Material()
    colour = material.color
    rgb: Vec3 | None = None if colour is None else (colour.r, colour.g, colour.b)
    # ProcTHOR gives the outer face of an outer wall the id of the room behind it; only its own id tells.
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
    rooms = [(room.id, structure.floor(room)) for room in house.rooms]
    things: list[Thing] = []
    units: dict[str, tuple[Thing, ...]] = {}
    for where, row, parent in structure.objects(house):
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
            parent=worktops.beneath((at.x, at.z), units[parent]).id if parent in units else parent,
        )
        units[row.id] = worktops.units(thing, asset.plan)
        things += units[row.id]
    return tuple(things)


def _pose(agent: Agent) -> Pose:
    heading = wrap(math.pi / 2 - math.radians(agent.rotation.y))
    return Pose(x=agent.position.x, y=agent.position.z, yaw=heading, pitch=0.0 - math.radians(agent.horizon))
