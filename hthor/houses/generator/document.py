"""A generated house as a document in ProcTHOR's schema 1.0.0.

The house frame's (x, y, z) becomes Unity's (x, z, y), and its counter-clockwise yaw a clockwise one in degrees.
"""

import itertools
import math
from collections import Counter
from collections.abc import Iterator, Sequence, Set
from typing import Any

import msgspec

from hthor.geometry.plane import turn
from hthor.houses.generator.finishes import Finish
from hthor.houses.generator.floorplan.doors import HIGH_M, Door
from hthor.houses.generator.floorplan.layout import OUTSIDE, FloorPlan, Seam
from hthor.houses.generator.furnishing.pieces import Piece
from hthor.houses.generator.furnishing.wall_items import Window
from hthor.types import Vec2

_ASSETS = {"leaf": "hthor_door", "frame": "hthor_doorframe", "outside": "hthor_frontdoor"}


def _round(value: float, digits: int = 4) -> float:
    return round(value, digits) + 0.0


def rooms(plan: FloorPlan, finish: Finish) -> list[dict[str, Any]]:
    """The rows of ``rooms``."""
    return [
        {
            "id": f"room|{room.number}",
            "roomType": room.kind,
            "floorPolygon": [{"x": x, "y": 0, "z": y} for x, y in room.polygon],
            "floorMaterial": finish.floor(room.number),
            "ceilings": [],
            "children": [],
            "layer": f"Procedural{number % 4}",
        }
        for number, room in enumerate(plan.rooms)
    ]


class Walls:
    """The rows of ``walls``, and the places of openings on them. Every stretch of wall has a face on each side.

    A face runs from ``a`` to ``b`` of its opening, so that a leaf's hinge is the first of the two ends.
    """

    def __init__(self, plan: FloorPlan, finish: Finish, doors: Sequence[Door]) -> None:
        self.rows: list[dict[str, Any]] = []
        self._names: dict[tuple[int, Vec2, Vec2], str] = {}
        self._ends: dict[tuple[Vec2, Vec2], tuple[Vec2, Vec2]] = {}
        for seam in plan.seams:
            door = next((door for door in doors if door.seam == seam), None)
            along = door is None or math.dist(seam.a, door.a) <= math.dist(seam.a, door.b)
            a, b = (seam.a, seam.b) if along else (seam.b, seam.a)
            self._ends[seam.a, seam.b] = (a, b)
            cuts = [a, b] if door is None or door.sort != "open" else [a, door.a, door.b, b]
            for k, (p, q) in enumerate(itertools.pairwise(cuts)):
                for room in (seam.left, seam.right):
                    self._face(room, p, q, finish, empty=len(cuts) > 2 and k == 1)
                if len(cuts) == 2:
                    self._names[seam.left, seam.a, seam.b] = self.rows[-2]["id"]
                    self._names[seam.right, seam.a, seam.b] = self.rows[-1]["id"]

    def _face(self, room: int, p: Vec2, q: Vec2, finish: Finish, *, empty: bool) -> None:
        name = "exterior" if room == OUTSIDE else str(room)
        place = "|".join(f"{value:.2f}" for value in (*p, *q))
        row: dict[str, Any] = {
            "id": f"wall|{name}|{place}",
            "roomId": name if room == OUTSIDE else f"room|{room}",
            "polygon": [{"x": x, "y": z, "z": y} for z in (0, finish.height) for x, y in (p, q)],
            "material": finish.wall(room),
        }
        if empty:
            row["empty"] = True
        self.rows.append(row)

    def name(self, seam: Seam, room: int) -> str:
        """The id of a room's face on a seam that has no open stretch."""
        return self._names[room, seam.a, seam.b]

    def hole(self, seam: Seam, a: Vec2, b: Vec2, low: float, high: float) -> dict[str, Any]:
        """The place of an opening on its face: the keys ``holePolygon`` and ``assetPosition``."""
        start = self._ends[seam.a, seam.b][0]
        near, far = sorted(math.dist(start, end) for end in (a, b))
        return {
            "holePolygon": [{"x": _round(near), "y": low, "z": 0}, {"x": _round(far), "y": high, "z": 0}],
            "assetPosition": {"x": _round((near + far) / 2), "y": _round((low + high) / 2), "z": 0},
        }


def doors(found: Sequence[Door], walls: Walls, style: int) -> list[dict[str, Any]]:
    """The rows of ``doors``; openings without a wall have no row."""
    rows = []
    for door in found:
        if door.sort == "open":
            continue
        far = OUTSIDE if door.sort == "outside" else door.room1
        number = min(door.room0, far), max(door.room0, far)
        wide = round(door.width * 100)
        row: dict[str, Any] = {
            "id": f"door|{number[0]}|{number[1]}",
            "room0": f"room|{door.room0}",
            "room1": f"room|{door.room1}",
            "wall0": walls.name(door.seam, door.room0),
            "wall1": walls.name(door.seam, far),
            "assetId": f"{_ASSETS[door.sort]}_{wide}x{round(HIGH_M * 100)}_v{style}",
            **walls.hole(door.seam, door.a, door.b, 0, HIGH_M),
        }
        if door.sort != "frame":
            row |= {"openable": door.sort == "leaf", "openness": int(door.sort == "leaf")}
        rows.append(row)
    return rows


def windows(found: Sequence[Window], walls: Walls) -> list[dict[str, Any]]:
    """The rows of ``windows``."""
    seen: Counter[int] = Counter()
    rows = []
    for window in found:
        size = f"{round(math.dist(window.a, window.b) * 100)}x{round((window.high - window.low) * 100)}"
        rows.append(
            {
                "id": f"window|{window.room}|{seen[window.room]}",
                "room0": f"room|{window.room}",
                "room1": f"room|{window.room}",
                "wall0": walls.name(window.seam, window.room),
                "wall1": walls.name(window.seam, OUTSIDE),
                "assetId": f"hthor_window_{size}",
                **walls.hole(window.seam, window.a, window.b, window.low, window.high),
            }
        )
        seen[window.room] += 1
    return rows


def names(pieces: Sequence[Piece]) -> Iterator[str]:
    """Ids of the pieces, each followed by its children's: kinds, with a number if a kind occurs more than once."""
    kinds = [each.kind for piece in pieces for each in (piece, *piece.children)]
    total, seen = Counter(kinds), Counter[str]()
    for kind in kinds:
        seen[kind] += 1
        yield f"{kind}_{seen[kind]}" if total[kind] > 1 else kind


def without(pieces: Sequence[Piece], gone: Set[str]) -> list[Piece]:
    """The pieces, without pieces whose ids are in ``gone``."""
    name, left = names(pieces), []
    for piece in pieces:
        stays = next(name) not in gone
        children = tuple(child for child in piece.children if next(name) not in gone)
        if stays:
            left.append(msgspec.structs.replace(piece, children=children))
    return left


def objects(pieces: Sequence[Piece]) -> list[dict[str, Any]]:
    """The rows of ``objects``."""
    name, rows = names(pieces), []
    for piece in pieces:
        row = _object(piece, next(name), piece.middle, piece.yaw)
        children = []
        for child in piece.children:
            x, y = turn(child.middle, piece.yaw)
            at = (piece.middle[0] + x, piece.middle[1] + y)
            children.append(_object(child, next(name), at, piece.yaw + child.yaw))
        rows.append(row | ({"children": children} if children else {}))
    return rows


def _object(piece: Piece, name: str, at: Vec2, yaw: float) -> dict[str, Any]:
    degrees = _round(math.degrees(-yaw) % 360.0, 2)
    return {
        "id": name,
        "assetId": piece.asset,
        "position": {"x": _round(at[0]), "y": _round(piece.bottom + piece.size[2] / 2, 5), "z": _round(at[1])},
        "rotation": {"x": 0, "y": degrees % 360.0, "z": 0},
        "kinematic": not piece.sort.pickable,
    }


def metadata(spec: str, start: tuple[float, float, int], generator: dict[str, Any]) -> dict[str, Any]:
    """The ``metadata``: version, start pose and the generator's record."""
    x, y, quarter = start
    return {
        "schema": "1.0.0",
        "roomSpecId": spec,
        "agent": {
            "position": {"x": _round(x), "y": 0.95, "z": _round(y)},
            "rotation": {"x": 0, "y": 90 * quarter, "z": 0},
            "horizon": 0,
            "standing": True,
        },
        "generator": generator,
        "warnings": {},
    }
