"""Houses in the manner of ProcTHOR's files, with assets of their own, and with the faults that such files have.

The same seed gives the same document. `DATABASE` is the asset database that goes with all of them.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

from procthor_plan import FIRST, OUTSIDE, Plan, Point, Side, draw_plan, wall_rows

Row = dict[str, Any]

_BIG = {
    "Bed": (1.45, 0.9, 2.05),
    "Sofa": (1.9, 0.85, 0.9),
    "ArmChair": (0.9, 0.9, 0.8),
    "DiningTable": (1.5, 0.78, 0.95),
    "Chair": (0.45, 0.92, 0.48),
    "Desk": (1.3, 0.75, 0.65),
    "Dresser": (1.1, 0.85, 0.45),
    "ShelvingUnit": (0.8, 1.6, 0.4),
    "SideTable": (0.5, 0.55, 0.45),
    "CoffeeTable": (0.9, 0.45, 0.6),
    "TVStand": (1.3, 0.55, 0.45),
    "Fridge": (0.9, 1.8, 0.75),
    "CounterTop": (1.8, 0.95, 0.65),
    "Sink": (0.7, 1.0, 0.6),
    "Toilet": (0.45, 0.9, 0.7),
    "Television": (0.9, 0.55, 0.12),
    "GarbageCan": (0.35, 0.5, 0.3),
    "HousePlant": (0.4, 0.7, 0.4),
    "Painting": (0.6, 0.7, 0.04),
    "Faucet": (0.1, 0.22, 0.2),
    "FloorLamp": (0.4, 1.5, 0.4),
    "Stool": (0.4, 0.6, 0.4),
    "Microwave": (0.5, 0.3, 0.38),
    "ShowerHead": (0.2, 0.2, 0.2),
}
_SMALL = {
    "Apple": (0.08, 0.08, 0.08),
    "Tomato": (0.07, 0.06, 0.07),
    "Lettuce": (0.16, 0.15, 0.16),
    "Book": (0.22, 0.04, 0.16),
    "RemoteControl": (0.06, 0.02, 0.18),
    "Mug": (0.12, 0.1, 0.09),
    "Plate": (0.24, 0.02, 0.24),
    "Bowl": (0.18, 0.08, 0.18),
    "Cup": (0.09, 0.12, 0.09),
    "Pencil": (0.01, 0.01, 0.16),
    "CellPhone": (0.08, 0.01, 0.15),
    "Laptop": (0.34, 0.25, 0.26),
    "Vase": (0.12, 0.25, 0.12),
    "Candle": (0.06, 0.12, 0.06),
    "SoapBar": (0.08, 0.03, 0.05),
    "ToiletPaper": (0.11, 0.1, 0.11),
    "Pan": (0.28, 0.06, 0.45),
    "Egg": (0.045, 0.06, 0.045),
    "Bread": (0.12, 0.11, 0.22),
    "Watch": (0.06, 0.03, 0.08),
}
_KITCHEN = ["Fridge", "CounterTop", "CounterTop", "Sink", "DiningTable", "GarbageCan", "Stool"]
_WORKTOPS = ("Countertop_I_4x2", "Countertop_L_8x6", "Countertop_C_8x6")
_ROOMS = {
    "Kitchen": _KITCHEN,
    "LivingRoom": ["Sofa", "TVStand", "CoffeeTable", "ArmChair", "ShelvingUnit", "FloorLamp", "HousePlant", "Painting"],
    "Bedroom": ["Bed", "SideTable", "Dresser", "Desk", "Chair", "Painting", "GarbageCan"],
    "Bathroom": ["Toilet", "Sink", "SideTable", "GarbageCan", "ShowerHead"],
}
_CARRIERS = ("Bed", "Sofa", "DiningTable", "Desk", "Dresser", "ShelvingUnit", "SideTable", "CoffeeTable", "TVStand",
             "CounterTop", "ArmChair", "Fridge", "Toilet")  # fmt: skip


def _assets() -> tuple[dict[str, list[Row]], dict[str, tuple[str, Point, float]]]:
    """The database, and type, footprint and height of each of its assets."""
    types: dict[str, list[Row]] = {}
    flat: dict[str, tuple[str, Point, float]] = {}
    for name, (x, y, z) in {**_BIG, **_SMALL}.items():
        for number, scale in enumerate((0.9, 1.0, 1.12), start=1):
            asset = _WORKTOPS[number - 1] if name == "CounterTop" else f"{name}_{number}"
            box = (2.4, y, 1.9) if asset[:12] in ("Countertop_L", "Countertop_C") else (x * scale, y * scale, z * scale)
            row = {"assetId": asset, "objectType": name, "boundingBox": dict(zip("xyz", box, strict=True))}
            types.setdefault(name, []).append({**row, "primaryProperty": "CanPickup" if name in _SMALL else "Static"})
            flat[asset] = (name, (box[0], box[2]), box[1])
    return types, flat


DATABASE, _FLAT = _assets()


def procthor_house(seed: int, spoil: bool = True) -> tuple[Row, tuple[str, ...]]:
    """A house file's document, and the faults that were put into it."""
    dice = random.Random(f"a house of the ProcTHOR kind {seed}")
    plan, height = draw_plan(dice, dice.randint(2, 7)), round(dice.uniform(2.5, 4.0), 6)
    types = _room_types(dice, plan)
    doors, holes = _doors(dice, plan)
    objects = [row for room in plan.rooms() for row in _furnish(dice, plan, room, types[room], holes)]
    document = {
        "rooms": [
            {
                "id": f"room|{room}",
                "roomType": types[room],
                "floorPolygon": [{"x": x, "y": 0, "z": z} for x, z in reversed(plan.polygon(room))],
                "floorMaterial": {"name": "DarkWoodSmooth2"},
                "children": [],
                "ceilings": [],
            }
            for room in plan.rooms()
        ],
        "walls": wall_rows(plan, height),
        "doors": doors,
        "windows": _windows(dice, plan, holes),
        "objects": objects,
        "proceduralParameters": {"ceilingMaterial": {"name": "Walldrywall"}, "skyboxId": "SkyAlbany"},
        "metadata": {"schema": "1.0.0", "roomSpecId": f"{len(types)}-room", "warnings": {}},
    }
    agent = {"position": _start(plan, objects), "rotation": {"x": 0, "y": 90 * dice.randint(0, 3), "z": 0}}
    agent |= {"standing": True, "horizon": dice.choice((0, 30, 30))}
    if dice.random() < 0.5:
        document["metadata"]["agent"] = agent
    else:
        document["metadata"]["agentPoses"] = {"arm": agent, "default": agent, "locobot": None}
    faults = dice.sample(sorted(SMALL_FAULTS), dice.randint(0, 3)) if spoil else []
    if spoil and dice.random() < 0.35:
        faults += dice.sample(sorted(GRAVE_FAULTS), dice.randint(1, 2))
    for name in faults:
        {**SMALL_FAULTS, **GRAVE_FAULTS}[name](dice, document)
    return document, tuple(faults)


def _room_types(dice: random.Random, plan: Plan) -> dict[int, str]:
    rooms = plan.rooms()
    sorts = ["Kitchen", "LivingRoom", "Bedroom", "Bathroom", *dice.choices(sorted(_ROOMS), k=len(rooms))]
    area = {room: sum(owner == room for owner in plan.cells.values()) for room in rooms}
    order = sorted(rooms, key=lambda room: -area[room])
    return {room: sorts[number] for number, room in enumerate(order)}


def _doors(dice: random.Random, plan: Plan) -> tuple[list[Row], list[tuple[Point, Point]]]:
    """Doors that connect all rooms and a few more, and one to the outside; also the middle of each, with its size."""
    sides = [side for room in plan.rooms() for side in plan.sides(room)]
    joined, rows, holes = {FIRST}, [], []
    inner = [side for side in sides if side.beyond not in (OUTSIDE, side.room) and side.length > 1.2]
    dice.shuffle(inner)
    while True:
        side = next((one for one in inner if one.room in joined and one.beyond not in joined), None)
        if side is None:
            break
        joined.add(side.beyond)
        leaf = dice.choice(((True, 1), (True, 0), (True, 0.4), (False, 1), (None, None), (False, None)))
        rows.append(_opening(dice, side, "Doorway", (min(1.0, side.length - 0.1), 2.1), 0.0, holes))
        low, high = sorted((side.room, side.beyond))
        rows[-1] |= {"id": f"door|{low}|{high}", "room1": f"room|{side.beyond}", "wall1": _other(side).wall()}
        rows[-1] |= {key: value for key, value in zip(("openable", "openness"), leaf, strict=True) if value is not None}
    outer = [side for side in sides if side.beyond == OUTSIDE and side.length > 1.2]
    side = dice.choice(outer)
    rows.append(_opening(dice, side, "Doorway", (1.0, 2.1), 0.0, holes))
    rows[-1] |= {"id": f"door|1|{side.room}", "wall1": side.wall(outer=True), "openable": dice.random() < 0.5}
    rows[-1] |= {"openness": 0}
    return rows, holes


def _windows(dice: random.Random, plan: Plan, holes: list[tuple[Point, Point]]) -> list[Row]:
    rows = []
    for room in plan.rooms():
        outer = [side for side in plan.sides(room) if side.beyond == OUTSIDE and side.length > 1.5]
        for number, side in enumerate(dice.sample(outer, min(len(outer), dice.randint(0, 2)))):
            row = _opening(dice, side, "Window_Slider", (dice.uniform(0.6, 1.4), 1.2), dice.uniform(0.7, 1.1), [])
            if all(math.dist(_middle(side), middle) > 1.5 for middle, _ in holes):
                rows.append({**row, "id": f"window|{room}|{number}", "wall1": side.wall(outer=True)})
    return rows


def _opening(
    dice: random.Random, side: Side, asset: str, size: Point, low: float, holes: list[tuple[Point, Point]]
) -> Row:
    """A door or window in the wall along a side; distances run from the wall's first corner."""
    begin = dice.uniform(0.05, max(0.06, side.length - size[0] - 0.05))
    (ax, az), (bx, bz) = sorted((side.a, side.b))
    share = (begin + size[0] / 2) / side.length
    holes.append(((ax + share * (bx - ax), az + share * (bz - az)), size))
    hole = [{"x": begin, "y": low, "z": 0}, {"x": begin + size[0], "y": low + size[1], "z": 0}]
    row = {"room0": f"room|{side.room}", "room1": f"room|{side.room}", "wall0": side.wall(), "holePolygon": hole}
    return {**row, "assetId": f"{asset}_{dice.randint(1, 9)}", "assetPosition": {"x": begin, "y": low, "z": 0}}


def _other(side: Side) -> Side:
    return Side(side.beyond, side.room, side.b, side.a)


def _middle(side: Side) -> Point:
    return ((side.a[0] + side.b[0]) / 2, (side.a[1] + side.b[1]) / 2)


def _furnish(dice: random.Random, plan: Plan, room: int, sort: str, holes: list[tuple[Point, Point]]) -> list[Row]:
    """The furniture along the walls of a room, each where nothing else and no door is, with small things on it."""
    rows: list[Row] = []
    small = iter(range(1000))
    taken = [(x, z, 0.9, 0.9) for (x, z), _ in holes]
    for name in dice.sample(_ROOMS[sort], dice.randint(4, len(_ROOMS[sort]))):
        asset = dice.choice([row["assetId"] for row in DATABASE[name]])
        _, (wide, deep), tall = _FLAT[asset]
        for _ in range(30):
            side = dice.choice(plan.sides(room))
            if side.length < wide + 0.2:
                continue
            nx, nz = side.inward
            share = dice.uniform(wide / 2 + 0.1, side.length - wide / 2 - 0.1) / side.length
            x = side.a[0] + share * (side.b[0] - side.a[0]) + nx * (deep / 2 + 0.06)
            z = side.a[1] + share * (side.b[1] - side.a[1]) + nz * (deep / 2 + 0.06)
            half = (wide / 2, deep / 2) if nz else (deep / 2, wide / 2)
            free = all(abs(x - u) > half[0] + w or abs(z - v) > half[1] + d for u, v, w, d in taken)
            if free and plan.cells.get((int((x + nx) / plan.cell), int((z + nz) / plan.cell))) == room:
                break
        else:
            continue
        taken.append((x, z, half[0] + 0.05, half[1] + 0.05))
        hung = name in ("Painting", "ShowerHead")
        y = dice.uniform(1.3, 1.7) if hung else tall / 2
        row = _row(f"{room}|{len(rows)}", asset, (x, y, z), round(math.degrees(math.atan2(nx, nz))) % 360)
        if name in _CARRIERS:
            row["children"] = [_on(dice, f"small|{room}|{next(small)}", row, y) for _ in range(dice.randint(0, 4))]
        elif name == "Sink":
            row["children"] = [_row(f"{room}|{len(rows)}|0", "Faucet_2", (x, tall + 0.1, z), 0)]
        if name in ("Fridge", "Dresser", "Toilet", "Laptop"):
            row["openness"] = dice.choice((0, 0.3, 1, None))
        rows.append(row)
    return rows


def _on(dice: random.Random, id: str, support: Row, height: float) -> Row:
    """A small thing, maybe with another on it, at a height that was measured on furniture of another shape."""
    _, (wide, deep), tall = _FLAT[support["assetId"]]
    turned = support["rotation"]["y"] % 180 == 90
    name = dice.choice(sorted(_SMALL))
    asset = f"{name}_{dice.randint(1, 3)}"
    rise = _FLAT[asset][2]
    at = support["position"]
    dx, dz = dice.uniform(-0.35, 0.35) * wide, dice.uniform(-0.35, 0.35) * deep
    dx, dz = (dz, dx) if turned else (dx, dz)
    y = height + tall / 2 + rise / 2 + dice.choice((0.0, 0.001, 0.03, -0.05, 0.15))
    row = _row(id, asset, (at["x"] + dx, y, at["z"] + dz), dice.choice((0, 90, 217.3)))
    row["rotation"] |= {"x": dice.choice((0, -0.0, 359.977)), "z": dice.choice((0, 0.009, 360))}
    if name in ("Plate", "Book", "Bowl") and dice.random() < 0.5:
        top = _FLAT["Egg_1"][2]
        row["children"] = [_row(f"{id}|0", "Egg_1", (at["x"] + dx, y + rise / 2 + top / 2, at["z"] + dz), 0)]
    return row


def _row(id: str, asset: str, at: tuple[float, float, float], yaw: float) -> Row:
    position = dict(zip("xyz", at, strict=True))
    return {"id": id, "assetId": asset, "position": position, "rotation": {"x": 0, "y": yaw, "z": 0}, "kinematic": True}


def _start(plan: Plan, objects: list[Row]) -> Row:
    """The place of the first room that is farthest from all furniture, on ProcTHOR's grid of a quarter metre."""
    cells = sorted(cell for cell, room in plan.cells.items() if room == FIRST)
    places = [
        (0.25 * round(4 * (x + u) * plan.cell), 0.25 * round(4 * (y + v) * plan.cell))
        for x, y in cells
        for u in (0.3, 0.5, 0.7)
        for v in (0.3, 0.5, 0.7)
    ]
    spots = [(row["position"]["x"], row["position"]["z"]) for row in objects] or [(0.0, 0.0)]
    x, z = max(places, key=lambda place: min(math.dist(place, spot) for spot in spots))
    return {"x": x, "y": 0.95, "z": z}


# -------------------------------------------------------------------------------------------------------------- faults


def _all(document: Row) -> list[Row]:
    rows, found = list(document["objects"]), []
    while rows:
        row = rows.pop()
        found.append(row)
        rows += row.get("children") or []
    return found


def _small(document: Row) -> list[Row]:
    return [row for row in _all(document) if _FLAT[row["assetId"]][0] in _SMALL]


def _tilt(dice: random.Random, document: Row) -> None:
    for row in dice.sample(_all(document), 3):
        row["rotation"][dice.choice("xz")] = dice.choice((90, -35, 180, 4.0, 270))


def _float(dice: random.Random, document: Row) -> None:
    for row in dice.sample(_small(document), min(5, len(_small(document)))):
        row["position"]["y"] += 0.6


def _hover(dice: random.Random, document: Row) -> None:
    dice.choice(document["objects"])["position"]["y"] += 0.9


def _named(names: Callable[[Row], list[str]]) -> Callable[[random.Random, Row], None]:
    def rename(dice: random.Random, document: Row) -> None:
        dice.choice(_all(document))["id"] = dice.choice(names(document))

    return rename


def _taken_id(document: Row) -> list[str]:
    lists = ("rooms", "walls", "doors", "objects")
    return [document[name][0]["id"] for name in lists] + [document["objects"][-1]["id"]]


def _start_in_furniture(dice: random.Random, document: Row) -> None:
    where, metadata = dice.choice(document["objects"])["position"], document["metadata"]
    pose = metadata.get("agent") or metadata["agentPoses"]["default"]
    pose["position"] = {"x": where["x"], "y": 0.95, "z": where["z"]}


def _start_looks_up(dice: random.Random, document: Row) -> None:
    metadata = document["metadata"]
    (metadata.get("agent") or metadata["agentPoses"]["default"])["horizon"] = dice.choice((-75, 80, 140))


def _shut_off(dice: random.Random, document: Row) -> None:
    del document["doors"][dice.randrange(max(1, len(document["doors"]) - 1))]


def _far_hole(dice: random.Random, document: Row) -> None:
    dice.choice(document["doors"])["holePolygon"][1]["x"] += 30


def _outdoors(dice: random.Random, document: Row) -> None:
    dice.choice(document["objects"])["position"]["x"] -= dice.choice((0.5, 40))


def _unknown_asset(dice: random.Random, document: Row) -> None:
    dice.choice(_all(document))["assetId"] = "0a1f5b7c9d3e4f60a1b2c3d4e5f60718"


def _no_children(dice: random.Random, document: Row) -> None:
    for row in _all(document):
        row.setdefault("children", None)


SMALL_FAULTS: dict[str, Callable[[random.Random, Row], None]] = {
    "tilted things": _tilt,
    "floating small things": _float,
    "hovering furniture": _hover,
    "an odd id": _named(lambda _: ["plaît-il", "a/b", 'the "table"', "日本 <b>", "Human", "x" * 200, "../x", "None"]),
    "children that are null": _no_children,
}
"""With these a house can be played in."""
GRAVE_FAULTS: dict[str, Callable[[random.Random, Row], None]] = {
    "an id of something else": _named(_taken_id),
    "an id of hthor's": _named(lambda _: ["floor", "human", "robot2", "wall", "outdoors", "floor of room|2", "apple"]),
    "an id that is no name": _named(lambda _: ["", " ", "\n", "a\x00b", "x" * 300, "\u202eegg"]),
    "a start in furniture": _start_in_furniture,
    "a start that looks too far": _start_looks_up,
    "a room without a door": _shut_off,
    "a hole far beyond its wall": _far_hole,
    "a thing outdoors": _outdoors,
    "an unknown asset": _unknown_asset,
}
"""Most of these make a house unfit."""
