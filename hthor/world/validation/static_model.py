"""Models of a house with nothing but its solids, built straight from the catalogue.

They take a hundredth of a second to make, so a house can be proved sound while it is being generated.
"""

from collections.abc import Iterable, Mapping
from typing import Any

from hthor import catalog
from hthor.geometry.plane import to_house
from hthor.types import HouseSpec, Part, Thing, Vec3
from hthor.world.model import geoms, walls
from hthor.world.model.engine import mujoco

_SHAPES = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
}
_MEMORY = 64 << 20
"""Bytes for contacts: a house at rest has thousands."""


def empty_model(house: HouseSpec, bits: Mapping[str, int]) -> Any:
    """A model in the making, with the options of a world: the ground, and every wall, closed door and window pane."""
    spec = mujoco.MjSpec()
    spec.memory = _MEMORY
    spec.option.timestep = 0.02
    spec.option.sleep_tolerance = 5e-3
    spec.option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(50, 50, 1), **bits)
    for panel in walls.wall_panels(house):
        spec.worldbody.add_geom(
            type=_SHAPES["box"], size=panel.half, pos=panel.centre, quat=geoms.quaternion(panel.yaw), **bits
        )
    return spec


def add_part(body: Any, part: Part, centre: Vec3, yaw: float, **more: Any) -> Any:
    """Add a part of a thing that stands at ``centre`` [m] turned by ``yaw`` [rad], in the frame of ``body``."""
    size = geoms.size(part)
    return body.add_geom(
        type=_SHAPES[part.shape],
        size=(*size, *(0.0,) * (3 - len(size))),
        pos=to_house(part.centre, centre, yaw),
        quat=geoms.orientation(part, yaw),
        **more,
    )


def add_things(body: Any, things: Iterable[Thing], **more: Any) -> None:
    """Add every part of things, doors and drawers closed, to a body at the origin."""
    for thing in things:
        for part in catalog.kind(thing.kind).parts(thing.size):
            add_part(body, part, thing.centre, thing.yaw, **more)
