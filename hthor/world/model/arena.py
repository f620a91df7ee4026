"""The static part of a house's model: floors, walls, openings and everything that never moves.

All static geoms belong to the world body, so that the engine has no bodies to process for them.
"""

import itertools
from collections.abc import Iterable
from typing import Any

from msgspec import structs

from hthor import catalog
from hthor.geometry import plane
from hthor.houses.space.obstacles import STEP_M
from hthor.looks import finishes
from hthor.types import HouseSpec, Part, Rgba, Thing
from hthor.world.model import geoms, walls
from hthor.world.model.engine import Arena

_CEILING: Rgba = (0.96, 0.96, 0.95, 1.0)
_GROUND: Rgba = (0.62, 0.68, 0.58, 1.0)
NEAR_M = 0.02
"""[m] Pictures show nothing that is nearer to the eye, such as a door that a body passes."""
_EXTENT_M = 10.0
"""[m] The engine's unit for how near and how far pictures show things."""
_SLAB_M = 0.01
"""[m] Thickness of the drawn floors and ceilings."""
_ROOF_M = 1.0
"""[m] Thickness of an invisible roof, so that a thrown object cannot pass through it between two steps."""
_ROOT_M = 0.1
"""[m] How far what lies flat on the floor goes on below it: the engine presses things out of each other by the shortest
way, and that out of the edge of a rug would lead down, into the floor.
"""
_TILT = (1.0, 5e-6, 5e-6, 0.0)
"""Quaternion of the ground, which falls by 0.1 mm in 10 m: on an exactly level plane the contact points of an upright
cylinder would depend on rounding errors.
"""
_LIGHT = {"ambient": (0.50, 0.50, 0.50), "diffuse": (0.34, 0.34, 0.33), "specular": (0.04, 0.04, 0.04)}
_SKY = {"rgb1": (0.80, 0.88, 0.94), "rgb2": (0.93, 0.94, 0.93)}
_DARK = (0.0, 0.0, 0.0)
_SUNS = (((0.3, 0.5, -1.0), (0.20, 0.19, 0.17)), ((-0.6, -0.3, -0.5), (0.12, 0.12, 0.13)))
"""Direction and colour of the two lights from the sky."""


class HouseArena(Arena):
    """The model of a house without its movable things.

    Attributes:
        owners: name of each geom -> id of the thing, room, wall or opening that it belongs to.
    """

    def _build(self, house: HouseSpec, statics: Iterable[Thing]) -> None:  # type: ignore[override]
        super()._build(name="house")
        self.owners: dict[str, str] = {}
        self._serial = itertools.count()
        self._settings()
        self._floors(house)
        self._walls(house)
        for thing in statics:
            self._thing(thing)

    def _settings(self) -> None:
        """Set the engine's options: long steps, sleeping islands, a headlight so that no corner is black."""
        root = self.mjcf_model
        root.compiler.fusestatic = True
        root.compiler.boundinertia = 5e-6  # [kg m2] with less, a pen that hits an edge would spin ever faster
        root.option.timestep = 0.02
        root.option.sleep_tolerance = 5e-3
        root.option.flag.sleep = "enable"
        root.visual.headlight.set_attributes(active=1, **_LIGHT)
        root.visual.quality.set_attributes(shadowsize=0, offsamples=4, numslices=24, numstacks=12)
        root.visual.map.set_attributes(znear=NEAR_M / _EXTENT_M, zfar=8.0)
        root.statistic.set_attributes(extent=_EXTENT_M)
        root.asset.add("texture", name="sky", type="skybox", builtin="gradient", width=32, height=192, **_SKY)
        root.asset.add("material", name="ceiling", rgba=_CEILING, emission=0.3)
        for direction, colour in _SUNS:
            light = {"directional": True, "castshadow": False, "pos": (0, 0, 10), "ambient": _DARK, "specular": _DARK}
            root.worldbody.add("light", dir=direction, diffuse=colour, **light)

    def _name(self, owner: str) -> str:
        name = f"{owner.replace('/', '|')}:{next(self._serial)}"
        self.owners[name] = owner
        return name

    def _floors(self, house: HouseSpec) -> None:
        world = self.mjcf_model.worldbody
        hidden: dict[str, Any] = {"group": 5, "rgba": (0, 0, 0, 0), "quat": _TILT}
        world.add("geom", name=self._name("ground"), type="plane", size=(50, 50, 1), **geoms.STATIC, **hidden)
        x, y = ([corner[axis] for room in house.rooms for corner in room.polygon] for axis in (0, 1))
        roof = ((min(x) + max(x)) / 2, (min(y) + max(y)) / 2, house.height + _ROOF_M / 2)
        half = ((max(x) - min(x)) / 2 + 1.0, (max(y) - min(y)) / 2 + 1.0, _ROOF_M / 2)
        geoms.add_box(world, self._name("roof"), roof, half, 0.0, group=5, rgba=(0, 0, 0, 0), **geoms.STATIC)
        lawn: dict[str, Any] = {"pos": (0, 0, -2 * _SLAB_M), "rgba": _GROUND, "group": geoms.FURNITURE}
        world.add("geom", name=self._name("outdoors"), type="plane", size=(50, 50, 1), **geoms.GHOST, **lawn)
        for room in house.rooms:
            for x0, y0, x1, y1 in plane.rectangular_strips(room.polygon):
                centre, half = ((x0 + x1) / 2, (y0 + y1) / 2), ((x1 - x0) / 2, (y1 - y0) / 2, _SLAB_M / 2)
                floor = {"rgba": (*finishes.floor(room.floor)[1], 1.0), "group": geoms.FURNITURE}
                ceiling = {"material": "ceiling", "group": geoms.CEILINGS}
                name = self._name(f"floor of {room.id}")
                geoms.add_box(world, name, (*centre, -_SLAB_M / 2), half, 0.0, **floor, **geoms.GHOST)
                name = self._name(f"ceiling of {room.id}")
                geoms.add_box(world, name, (*centre, house.height + _SLAB_M / 2), half, 0.0, **ceiling, **geoms.GHOST)

    def _walls(self, house: HouseSpec) -> None:
        for panel in walls.wall_panels(house):
            world, name = self.mjcf_model.worldbody, self._name(panel.name)
            group = geoms.CEILINGS if panel.sort == "lintel" else geoms.WALLS
            look: dict[str, Any] = {"rgba": panel.rgba, "group": group, **geoms.STATIC}
            geoms.add_box(world, name, panel.centre, panel.half, panel.yaw, **look)

    def _thing(self, thing: Thing) -> None:
        for part in catalog.kind(thing.kind).parts(thing.size, thing.variant):
            if not part.moves:
                world, name, solid = self.mjcf_model.worldbody, self._name(thing.id), _rooted(part, thing.centre[2])
                geoms.add_part(world, name, solid, thing.centre, thing.yaw, group=geoms.FURNITURE, **geoms.STATIC)


def _rooted(part: Part, height: float) -> Part:
    """A part of a thing whose centre is at this height [m]; if it lies flat on the floor, longer downwards."""
    (x, y, z), (along, across, half) = part.centre, part.half
    flat = part.shape != "sphere" and part.axis == "z" and 2 * half <= STEP_M
    if not flat or abs(height + z - half) > 1e-3:
        return part
    return structs.replace(part, centre=(x, y, z - _ROOT_M / 2), half=(along, across, half + _ROOT_M / 2))
