"""Checks the consistency of a house file beyond its schema: matching ids, valid polygons.

Whether a body can live in the house is checked in `house_checks`.
"""

import math
from collections.abc import Iterable, Sequence

from hthor.errors import HouseError
from hthor.geometry.plane import inside, signed_area
from hthor.houses.checks.ids import EXTERIOR, id_faults, iter_ids, iter_objects
from hthor.houses.checks.polygons import distance_to_outline, find_crossing, overlap_area, simplify
from hthor.houses.schema import Agent, HouseFile, OpeningRow, RoomRow, WallRow
from hthor.types import Vec2

ROOM_KINDS = {"Kitchen": "kitchen", "LivingRoom": "living_room", "Bedroom": "bedroom", "Bathroom": "bathroom"}
OVERLAP_M2 = 0.01
OUTSIDE_M = 1.0
"""How far the middle of an object may lie outside of every room, above the ceiling or below the floor.

Things on walls reach slightly beyond the floor, and foreign houses may have misplaced things; `house_checks` reports
those.
"""
UPRIGHT_DEG = 1.0
"""Up to this angle something counts as upright: ProcTHOR's physics left at most 0.04 degrees in eight real houses."""
HORIZON_DEG = 60.0
"""How far a person looks up or down at most."""
_SLACK_M = 0.02
_HOLE_M = 0.1
"""How far a hole may reach beyond its wall, which is then open up to that edge."""
_AREA_M2 = 0.01


class StructureFault(Exception):
    """A field and its problem, later reported as a `HouseError`."""

    def __init__(self, field: str, problem: str) -> None:
        self.field, self.problem = field, problem
        super().__init__(problem)


def validate_structure(house: HouseFile, file: str) -> None:
    """Check a house file's structure; raises `HouseError` for the first fault."""
    try:
        _check_ids(house)
        _check_rooms(house.rooms)
        _check_walls(house)
        openings = (*_listed("doors", house.doors), *_listed("windows", house.windows or ()))
        for where, opening in openings:
            _check_opening(where, opening, house)
        _check_objects(house)
        _check_start(house)
    except StructureFault as fault:
        raise HouseError(file, fault.field, fault.problem) from None


def find_start(house: HouseFile) -> tuple[str, Agent] | None:
    """The start pose with its field path: the file's single pose, else the default robot's, else the first robot's."""
    if house.metadata.agent is not None:
        return "metadata.agent", house.metadata.agent
    poses = house.metadata.agent_poses or {}
    for name in ("default", *sorted(poses)):
        pose = poses.get(name)
        if pose is not None:
            return f"metadata.agentPoses.{name}", pose
    return None


def floor_polygon(room: RoomRow) -> tuple[Vec2, ...]:
    """The floor's corners in the house frame."""
    return simplify([(corner.x, corner.z) for corner in room.floor_polygon])


def wall_line(wall: WallRow) -> tuple[Vec2, Vec2]:
    """The wall's line on the floor, from the corner from which openings are measured."""
    a, b = wall.polygon[:2]
    return (a.x, a.z), (b.x, b.z)


def wall_heights(wall: WallRow) -> tuple[float, float]:
    """Lowest and highest point of a wall [m]; exterior walls list their upper corners first."""
    ys = [corner.y for corner in wall.polygon]
    return min(ys), max(ys)


def room_at(point: Vec2, rooms: Sequence[tuple[str, Sequence[Vec2]]], slack: float = OUTSIDE_M) -> str | None:
    """Id of the room that holds the point, else of the nearest room within ``slack`` [m], else None."""
    for name, polygon in rooms:
        if inside(point, polygon):
            return name
    distance, name = min((distance_to_outline(point, polygon), name) for name, polygon in rooms)
    return name if distance <= slack else None


def _listed(name: str, rows: Iterable[OpeningRow]) -> list[tuple[str, OpeningRow]]:
    return [(f"{name}[{index}]", row) for index, row in enumerate(rows)]


def _check_ids(house: HouseFile) -> None:
    for field, problem in id_faults(iter_ids(house)):
        raise StructureFault(field, problem)


def _check_rooms(rooms: list[RoomRow]) -> None:
    if not rooms:
        raise StructureFault("rooms", "is empty; a house needs at least one room")
    for index, room in enumerate(rooms):
        if room.room_type not in ROOM_KINDS:
            valid = ", ".join(ROOM_KINDS)
            raise StructureFault(f"rooms[{index}].roomType", f"unknown room type '{room.room_type}'; valid: {valid}")
        _check_polygon(f"rooms[{index}].floorPolygon", floor_polygon(room))
    floors = [floor_polygon(room) for room in rooms]
    for later in range(len(rooms)):
        for earlier in range(later):
            area = overlap_area(floors[earlier], floors[later])
            if area > OVERLAP_M2:
                names = f"'{rooms[later].id}' overlaps '{rooms[earlier].id}' (rooms[{earlier}])"
                raise StructureFault(
                    f"rooms[{later}].floorPolygon", f"{names} by {area:.2f} m2; rooms must not overlap"
                )


def _check_polygon(where: str, corners: Sequence[Vec2]) -> None:
    if len(corners) < 3:
        raise StructureFault(where, f"needs at least 3 different corners, got {len(corners)}")
    sides = find_crossing(corners)
    if sides is not None:
        raise StructureFault(where, f"crosses itself: sides {sides[0]} and {sides[1]} meet")
    area = abs(signed_area(corners))
    if area < _AREA_M2:
        raise StructureFault(where, f"encloses no area: {area:.4f} m2")


def _check_walls(house: HouseFile) -> None:
    if not house.walls:
        raise StructureFault("walls", "is empty; a house needs walls")
    known = {room.id for room in house.rooms} | {EXTERIOR}
    for index, wall in enumerate(house.walls):
        where = f"walls[{index}]"
        if wall.room_id not in known:
            raise StructureFault(f"{where}.roomId", f"no room has the id '{wall.room_id}'; rooms: {_names(known)}")
        if len(wall.polygon) != 4:
            raise StructureFault(f"{where}.polygon", f"needs 4 corners, got {len(wall.polygon)}")
        low, high = wall_heights(wall)
        if high - low < _SLACK_M:
            raise StructureFault(f"{where}.polygon", f"has no height: its corners lie between {low:g} and {high:g} m")
        if math.dist(*wall_line(wall)) < _SLACK_M:
            raise StructureFault(f"{where}.polygon", "has no length: its first two corners coincide")


def _check_opening(where: str, opening: OpeningRow, house: HouseFile) -> None:
    rooms = {room.id for room in house.rooms} | {EXTERIOR}
    for key, name in (("room0", opening.room0), ("room1", opening.room1)):
        if name not in rooms:
            raise StructureFault(f"{where}.{key}", f"no room has the id '{name}'; rooms: {_names(rooms)}")
    walls = {wall.id: wall for wall in house.walls}
    for key, wall in (("wall0", opening.wall0), ("wall1", opening.wall1)):
        if wall is not None and wall not in walls:
            raise StructureFault(f"{where}.{key}", f"no wall has the id '{wall}'")
    _check_hole(f"{where}.holePolygon", opening, walls[opening.wall0])


def _check_hole(where: str, opening: OpeningRow, wall: WallRow) -> None:
    if len(opening.hole_polygon) != 2:
        raise StructureFault(where, f"needs 2 opposite corners, got {len(opening.hole_polygon)}")
    a, b = opening.hole_polygon
    if abs(b.x - a.x) < _SLACK_M or abs(b.y - a.y) < _SLACK_M:
        raise StructureFault(where, "has no area: its two corners must be opposite")
    low, high = wall_heights(wall)
    for key, span, limit in (("x", (a.x, b.x), math.dist(*wall_line(wall))), ("y", (a.y, b.y), high - low)):
        for index, value in enumerate(span):
            if not -_HOLE_M <= value <= limit + _HOLE_M:
                raise StructureFault(f"{where}[{index}].{key}", f"{value:g} is outside '{wall.id}', 0 to {limit:.3f} m")


def _check_objects(house: HouseFile) -> None:
    rooms = [(room.id, floor_polygon(room)) for room in house.rooms]
    ceiling = max(high for _, high in map(wall_heights, house.walls))
    for where, row, _ in iter_objects(house):
        if room_at((row.position.x, row.position.z), rooms) is None:
            at = f"x {row.position.x:.2f}, z {row.position.z:.2f}"
            raise StructureFault(f"{where}.position", f"'{row.id}' is outside every room, at {at}")
        if not -OUTSIDE_M <= row.position.y <= ceiling + OUTSIDE_M:
            problem = f"'{row.id}' lies at height {row.position.y:.2f}; floor 0, ceiling {ceiling:.2f} m"
            raise StructureFault(f"{where}.position.y", problem)


def _check_start(house: HouseFile) -> None:
    found = find_start(house)
    if found is None:
        raise StructureFault("metadata.agent", "is missing; it gives the start position and rotation")
    where, agent = found
    rooms = [(room.id, floor_polygon(room)) for room in house.rooms]
    if room_at((agent.position.x, agent.position.z), rooms, slack=0.0) is None:
        raise StructureFault(f"{where}.position", "is outside every room")
    for axis in ("x", "z"):
        degrees = math.remainder(getattr(agent.rotation, axis), 360.0)
        if abs(degrees) > UPRIGHT_DEG:
            raise StructureFault(f"{where}.rotation.{axis}", f"bodies start upright, at 0 degrees; got {degrees:g}")
    if abs(agent.horizon) > HORIZON_DEG:
        problem = f"bodies look at most {HORIZON_DEG:g} degrees up or down; got {agent.horizon:g}"
        raise StructureFault(f"{where}.horizon", problem)


def _names(names: Iterable[str]) -> str:
    return ", ".join(sorted(names))
