"""One attempt at a house, stage by stage."""

from typing import Any

import msgspec
import numpy as np

from hthor.houses import loader
from hthor.houses.generator import document, validity
from hthor.houses.generator.draws import Dice
from hthor.houses.generator.finishes import Finish
from hthor.houses.generator.floorplan import doors, growth, layout
from hthor.houses.generator.floorplan.doors import Door
from hthor.houses.generator.floorplan.growth import draw_boundary
from hthor.houses.generator.floorplan.layout import FloorPlan
from hthor.houses.generator.floorplan.room_specs import LIVING, RoomSpec, iter_leaves
from hthor.houses.generator.furnishing import clutter
from hthor.houses.generator.furnishing.clutter import Table
from hthor.houses.generator.furnishing.floor_space import RADIUS_M, RoomSpace
from hthor.houses.generator.furnishing.furnish import furnish_rooms
from hthor.houses.generator.furnishing.item_styles import ItemStyler
from hthor.houses.generator.furnishing.pieces import Piece
from hthor.houses.generator.furnishing.requirements import Requirements
from hthor.houses.generator.furnishing.wall_items import WallDecorator
from hthor.houses.space.free_space import Bools, FreeSpace
from hthor.types import HouseSpec

_OUTLINES, _DIVISIONS, _DOORINGS = 40, 60, 10
_PASSAGE = 0.2
"""How much a door to a living room adds to a plan's quality."""
_START_GRID_M, _START_CLEAR_M = 0.25, 0.45
"""Grid of start places, and radius of free floor around them."""
_START_WEIGHTS = {"living_room": 4.0, "kitchen": 3.0, "bedroom": 2.0, "bathroom": 0.4}


class AttemptFailed(Exception):
    """An attempt failed: the ``rule`` that it broke, and how."""

    def __init__(self, rule: str, problem: str) -> None:
        self.rule, self.problem = rule, problem
        super().__init__(f"{problem} ({rule})")


def build_document(spec: RoomSpec, wants: Requirements, dice: Dice, record: dict[str, Any]) -> dict[str, Any]:
    """A house file's document; ``record`` is written into its metadata.

    Raises:
        AttemptFailed: names the rule that is broken.
    """
    plan, found = _floor_plan(spec, dice)
    finish, maker = Finish(plan, dice.of("finish")), ItemStyler(dice.of("maker"))
    walls = document.Walls(plan, finish, found)
    shell: dict[str, Any] = {
        "rooms": document.rooms(plan, finish),
        "walls": walls.rows,
        "doors": document.doors(found, walls, dice.whole(0, 3, "door style")),
        "windows": [],
        "objects": [],
        "metadata": document.metadata(spec.name, _middle(plan), record),
    }
    space = FreeSpace(loader.house_from_document(shell, "house"), RADIUS_M, validity.HEIGHT_M)
    rooms = [RoomSpace(room, plan, found, space) for room in plan.rooms]
    if missing := furnish_rooms(rooms, wants, maker, dice.of("furnish")):
        raise AttemptFailed("furniture-place", f"no place was found for the {missing.replace('_', ' ')}")
    work = [WallDecorator(room, plan, found, maker, finish.height) for room in rooms]
    for wall, room in zip(work, rooms, strict=True):
        wall.glaze(dice.of("windows", room.room.number))
        wall.decorate(dice.of("decoration", room.room.number))
    pieces = _laid(rooms, wants, maker, dice.of("clutter"))
    shell |= {
        "windows": document.windows([window for wall in work for window in wall.windows], walls),
        "objects": document.objects(pieces),
        "proceduralParameters": {
            "floorColliderThickness": 1,
            "receptacleHeight": 0.7,
            "ceilingMaterial": {"name": "PlasterWhite"},
            "skyboxId": finish.sky,
            "reflections": [],
            "lights": finish.lights(plan),
        },
    }
    hidden = _judged(shell, spec, dice, record)
    if hidden:
        pieces = document.without(pieces, hidden)
        shell["objects"] = document.objects(pieces)
        kinds = {each.kind for piece in pieces for each in (piece, *piece.children)}
        if gone := next(iter(sorted(wants.must - kinds)), ""):
            raise AttemptFailed("object-visible", f"the only {gone.replace('_', ' ')} cannot be seen from the floor")
        if _judged(shell, spec, dice, record):
            raise AttemptFailed("object-visible", "removing things hid others")
    return shell


def _judged(shell: dict[str, Any], spec: RoomSpec, dice: Dice, record: dict[str, Any]) -> set[str]:
    """Set the document's start; return the ids of small things that cannot be seen, when nothing else is wrong."""
    house = loader.house_from_document(shell, "house")
    space, free = validity.floor(house)
    walkable = validity.reached(free)
    start = _start(house, space, walkable, dice.of("start"))
    if start is None:
        raise AttemptFailed("start-free", "no free floor is large enough to start on")
    shell["metadata"] = document.metadata(spec.name, start, record)
    pose = msgspec.structs.replace(house.start, x=start[0], y=start[1])
    placed: HouseSpec = msgspec.structs.replace(house, start=pose)
    hidden = set()
    for rule, where, problem in validity.find_faults(placed, space, walkable):
        if rule != "object-visible":
            raise AttemptFailed(rule, f"{where}: {problem}")
        hidden.add(where)
    return hidden


def _floor_plan(spec: RoomSpec, dice: Dice) -> tuple[FloorPlan, list[Door]]:
    """The best division of the first outline that can be divided, and its doors."""
    count = sum(1 for _ in iter_leaves(spec.tree))
    for outline in range(_OUTLINES):
        own = dice.of("outline", outline)
        shape = draw_boundary(count, own)
        if shape is None:
            continue
        best: tuple[float, FloorPlan, list[tuple[int, int]]] | None = None
        for number in range(_DIVISIONS):
            labels = growth.grow_rooms(shape.cells, spec.tree, own.of("rooms", number))
            plan = None if labels is None else layout.plan_rooms(shape, labels, spec.tree)
            if labels is None or plan is None:
                continue
            pairs = doors.choose_doors(spec.tree, plan, own.of("links", number))
            if pairs is None:
                continue
            passages = sum(LIVING in (plan.room(one).kind, plan.room(two).kind) for one, two in pairs)
            score = layout.plan_quality(labels, spec.tree) + _PASSAGE * passages
            if best is None or score > best[0]:
                best = (score, plan, pairs)
        for number in range(_DOORINGS if best is not None else 0):
            found = doors.place(best[2], best[1], own.of("doors", number)) if best is not None else None
            if best is not None and found is not None:
                return best[1], found
    raise AttemptFailed("floor-plan", f"none of {_OUTLINES} outlines could be divided into the rooms of '{spec.name}'")


def _middle(plan: FloorPlan) -> tuple[float, float, int]:
    """A provisional start: a place indoors, for a house that has no start yet."""
    row, column = next((j, i) for j, line in enumerate(plan.labels) for i, mark in enumerate(line) if mark)
    return ((column + 0.5) * plan.scale, (row + 0.5) * plan.scale, 0)


def _laid(rooms: list[RoomSpace], wants: Requirements, maker: ItemStyler, dice: Dice) -> list[Piece]:
    """All pieces with the small things on them."""
    tables = [Table(piece, room.room.kind) for room in rooms for piece in room.pieces]
    if missing := clutter.place_clutter(tables, wants, maker, dice):
        raise AttemptFailed("clutter-place", f"no place was found for the {missing.replace('_', ' ')}")
    return [msgspec.structs.replace(table.piece, children=tuple(table.children)) for table in tables]


def _start(house: HouseSpec, space: FreeSpace, reached: Bools, dice: Dice) -> tuple[float, float, int] | None:
    """A place (x, y) [m] on the quarter-metre grid and quarter turns clockwise from +y; or None."""
    weights = [_START_WEIGHTS[room.kind] for room in house.rooms]
    for attempt in range(20):
        room = dice.weighted(house.rooms, weights, "room", attempt)
        spots = _start_places(space, reached & space.room_mask(room))
        if len(spots):
            x, y = spots[dice.whole(0, len(spots) - 1, "spot", attempt)]
            return float(x), float(y), dice.whole(0, 3, "turn", attempt)
    return None


def _start_places(space: FreeSpace, floor: Bools) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """(N, 2) places of the quarter-metre grid with enough free floor around them."""
    reach = round((_START_CLEAR_M - space.radius) / space.cell)
    roomy = floor.copy()
    for shift in range(1, reach + 1):
        roomy[shift:, :] &= floor[:-shift, :]
        roomy[:-shift, :] &= floor[shift:, :]
        roomy[:, shift:] &= floor[:, :-shift]
        roomy[:, :-shift] &= floor[:, shift:]
    places = np.unique(np.round(space.centres(roomy) / _START_GRID_M), axis=0) * _START_GRID_M
    return np.array([place for place in places if roomy[space.cell_of(place[0], place[1])]]).reshape(-1, 2)
