"""Materials, colors, lights and the ceiling's height."""

from typing import Any

from hthor.houses.generator.draws import Dice
from hthor.houses.generator.floorplan.layout import OUTSIDE, FloorPlan, RoomPlan
from hthor.houses.generator.floorplan.room_specs import BATHROOM, BEDROOM, KITCHEN, LIVING

Rgb = tuple[float, float, float]

_WOODS = ("WoodOak", "WoodWalnut", "WoodBirch", "WoodGrey")
_TILES = ("TileWhite", "TileGrey", "TileSlate", "TileTerracotta", "TileCream")
_CARPETS = ("CarpetGrey", "CarpetBeige", "CarpetBlue", "CarpetSage")
_FLOORS = {
    KITCHEN: ((_TILES, 0.65), (_WOODS, 0.35)),
    LIVING: ((_WOODS, 0.8), (_CARPETS, 0.2)),
    BEDROOM: ((_WOODS, 0.5), (_CARPETS, 0.5)),
    BATHROOM: ((_TILES, 1.0),),
}
_PLASTERS: tuple[tuple[str, Rgb], ...] = (
    ("PlasterWhite", (0.94, 0.93, 0.90)),
    ("PlasterWarm", (0.93, 0.88, 0.79)),
    ("PlasterCream", (0.95, 0.91, 0.80)),
    ("PlasterGrey", (0.84, 0.85, 0.86)),
    ("PlasterSage", (0.80, 0.86, 0.77)),
    ("PlasterSky", (0.79, 0.86, 0.91)),
    ("PlasterBlush", (0.93, 0.83, 0.79)),
    ("PlasterSand", (0.88, 0.80, 0.68)),
    ("PlasterLilac", (0.86, 0.83, 0.91)),
    ("PlasterMint", (0.82, 0.91, 0.86)),
)
_WALL_TILES: tuple[tuple[str, Rgb], ...] = (
    ("WallTileWhite", (0.92, 0.94, 0.94)),
    ("WallTileBlue", (0.72, 0.83, 0.89)),
    ("WallTileGreen", (0.75, 0.86, 0.80)),
    ("WallTileCream", (0.92, 0.88, 0.79)),
)
_OUTDOORS: tuple[tuple[str, Rgb], ...] = (
    ("BrickRed", (0.62, 0.38, 0.31)),
    ("BrickBrown", (0.55, 0.43, 0.35)),
    ("BrickGrey", (0.60, 0.58, 0.55)),
    ("PlasterOutside", (0.88, 0.85, 0.78)),
)
_SAME_WALLS, _SAME_FLOORS = 0.35, 0.15
_CEILING_M = (2.45, 0.6)
_LIGHT_M = 0.2
_SKIES = ("SkyMidday", "SkyMorning", "SkyCloudy")


class Finish:
    """The looks of one house.

    Attributes:
        height: height of the ceiling [m]. outdoors: material of the outer walls.
    """

    def __init__(self, plan: FloorPlan, dice: Dice) -> None:
        self.height = round(_CEILING_M[0] + _CEILING_M[1] * dice.beta(1.25, 2.5, "ceiling"), 2)
        self.outdoors = material(*dice.pick(_OUTDOORS, "outdoors"))
        self.sky = dice.pick(_SKIES, "sky")
        plaster, wood = dice.pick(_PLASTERS, "plaster"), dice.pick(_WOODS, "wood")
        same_walls, same_floors = dice.chance(_SAME_WALLS, "same walls"), dice.chance(_SAME_FLOORS, "same floors")
        self._floors: dict[int, str] = {}
        self._walls: dict[int, dict[str, Any]] = {}
        main = dice.pick(_WOODS, "main")
        for room in plan.rooms:
            own = dice.of(room.number)
            options = _FLOORS[room.kind]
            palette = own.weighted([o for o, _ in options], [w for _, w in options], "floor")
            floor = main if palette is _WOODS else own.pick(palette, "floor name")
            bath = room.kind == BATHROOM
            self._floors[room.number] = wood if same_floors and not bath else floor
            wall = own.pick(_WALL_TILES, "tiles") if bath else plaster if same_walls else own.pick(_PLASTERS, "wall")
            self._walls[room.number] = material(*wall)

    def floor(self, room: int) -> dict[str, Any]:
        """Material of a room's floor."""
        return {"name": self._floors[room]}

    def wall(self, room: int) -> dict[str, Any]:
        """Material of a room's walls, or of the outer walls."""
        return self.outdoors if room == OUTSIDE else self._walls[room]

    def lights(self, plan: FloorPlan) -> list[dict[str, Any]]:
        """The sun, and one lamp under each ceiling."""
        sun = {
            "id": "DirectionalLight",
            "type": "directional",
            "position": {"x": 0.84, "y": 0.1855, "z": -1.09},
            "rotation": {"x": 66, "y": 75, "z": 0},
            "intensity": 1,
            "rgb": {"r": 1.0, "g": 1.0, "b": 1.0},
        }
        return [sun, *(_lamp(room, plan, self.height) for room in plan.rooms)]


def material(name: str, rgb: Rgb) -> dict[str, Any]:
    """A wall's material with its color."""
    return {"name": name, "color": dict(zip("rgb", rgb, strict=True))}


def _lamp(room: RoomPlan, plan: FloorPlan, height: float) -> dict[str, Any]:
    """A lamp in the middle of the room's cell that is nearest to the room's middle."""
    cells = [(i, j) for j, row in enumerate(plan.labels) for i, mark in enumerate(row) if mark == room.number]
    u, v = (sum(axis) / len(cells) for axis in zip(*cells, strict=True))
    whole = (round(u), round(v)) in cells and (int(u), int(v)) in cells
    i, j = (u, v) if whole else min(cells, key=lambda cell: ((cell[0] - u) ** 2 + (cell[1] - v) ** 2, cell))
    return {
        "id": f"light_{room.number}",
        "type": "point",
        "position": {
            "x": round((i + 0.5) * plan.scale, 3),
            "y": round(height - _LIGHT_M, 3),
            "z": round((j + 0.5) * plan.scale, 3),
        },
        "intensity": 0.75,
        "range": 15,
        "rgb": {"r": 1.0, "g": 0.855, "b": 0.722},
    }
