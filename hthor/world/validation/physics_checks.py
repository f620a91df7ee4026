"""Checks in the engine that every surface of a house takes every target and that no things penetrate one another.

All targets are put down and watched in one simulation, in which they do not collide with one another; penetration is
computed exactly for each part. The models consist only of the house's solids from the catalogue and are made in about
10 ms, so that a house can be checked while it is being generated.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import catalog
from hthor.geometry.plane import to_house
from hthor.houses.checks.house_rules import Finding, error, readable_kind
from hthor.houses.space import boxes
from hthor.types import HouseSpec, Part, Surface, Thing, Vec3
from hthor.world.model import geoms, walls
from hthor.world.model.composer_task import GRIP, ROLLING, THIN_M
from hthor.world.model.engine import mujoco
from hthor.world.state.support_surfaces import SupportSurface, SupportSurfaces, free_spots

STAYS_M = 0.02
"""[m] How far an object may move from the place where it was put."""
WATCHED_S = 2.0
"""[s] How long an object is watched after it was put down."""
_LOOKS = 10
"""How often an object's position is read while it is watched."""
PENETRATION_MAX_M = 0.005
"""[m] How far parts may overlap: the engine's solver leaves such overlaps, and they are too small to be seen."""
_SOLID = {"contype": 1, "conaffinity": 0}
_ALONE = {"contype": 2, "conaffinity": 1}
_TOUCHING = {"contype": 1, "conaffinity": 1}
_SHAPES = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
}
_MEMORY = 64 << 20
"""[bytes] Memory for contacts: a house at rest has thousands of them."""


def _empty_model(house: HouseSpec, bits: Mapping[str, int]) -> Any:
    """A model specification with a world's options: the ground, and every wall, closed door and window pane."""
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


def _add_part(body: Any, part: Part, centre: Vec3, yaw: float, **more: Any) -> Any:
    """Add a part of a thing that stands at ``centre`` [m] turned by ``yaw`` [rad], in the frame of ``body``."""
    size = geoms.size(part)
    return body.add_geom(
        type=_SHAPES[part.shape],
        size=(*size, *(0.0,) * (3 - len(size))),
        pos=to_house(part.centre, centre, yaw),
        quat=geoms.orientation(part, yaw),
        **more,
    )


def _add_things(body: Any, things: Iterable[Thing], **more: Any) -> None:
    """Add every part of things, doors and drawers closed, to a body at the origin."""
    for thing in things:
        for part in catalog.kind(thing.kind).parts(thing.size):
            _add_part(body, part, thing.centre, thing.yaw, **more)


class DropTrial(Struct, frozen=True, kw_only=True):
    """One target on one surface: ``at`` [m] is where it is put, None if it does not fit."""

    thing: Thing
    surface: Surface
    target: str
    at: Vec3 | None


def drop_findings(house: HouseSpec) -> tuple[Finding, ...]:
    """``surface-takes``: one finding for every surface and target that does not fit on it or does not stay there.

    It checks the surfaces where a task may put things (`hthor.catalog.Kind.rests`) of all things that never move.
    """
    trials = list(_trials(house))
    strayed = iter(_watch(house, [trial for trial in trials if trial.at is not None]))
    found = []
    for trial in trials:
        problem = _problem(trial, 0.0 if trial.at is None else next(strayed))
        if problem:
            found.append(error("surface-takes", trial.thing.id, problem))
    return tuple(found)


def _problem(trial: DropTrial, strayed: float) -> str:
    place = f"the {trial.surface.name} of the {readable_kind(trial.thing.kind)}"
    if trial.at is None:
        width, depth = (2 * half for half in trial.surface.half)
        room = f"{width:.2f} x {depth:.2f} m, {trial.surface.clearance:.2f} m high"
        return f"no free place for the {readable_kind(trial.target)} on {place} ({room})"
    if strayed > STAYS_M:
        return f"the {readable_kind(trial.target)} put on {place} strays {strayed:.3f} m within {WATCHED_S:.0f} s"
    return ""


def _trials(house: HouseSpec) -> Iterator[DropTrial]:
    solids = _upright(house)
    for thing in house.things:
        kind = catalog.kind(thing.kind)
        if kind.pickable:
            continue
        places = SupportSurfaces((thing,)).of(thing.id)
        for surface in kind.rests(thing.size):
            middle = to_house(surface.centre, thing.centre, thing.yaw)
            place = next(place for place in places if np.allclose(place.centre, middle, atol=1e-9))
            near = _within(solids, place)
            for target in catalog.TARGETS:
                spots = free_spots(place, catalog.kind(target).size, near, place.centre)
                yield DropTrial(thing=thing, surface=surface, target=target, at=spots[0] if spots else None)


def _upright(house: HouseSpec) -> tuple[Any, Any]:
    """Centres and half extents (M, 3) [m] of axis-aligned boxes around all parts of all things and walls."""
    parts = [box for thing in house.things for _, box in boxes.boxes_of(thing)]
    upright = (0.0, 0.0, 1.0)
    parts += [
        boxes.Box(panel.centre, panel.half, boxes.rotation(upright, panel.yaw)) for panel in walls.wall_panels(house)
    ]
    centres = np.array([box.centre for box in parts]).reshape(-1, 3)
    halves = np.array([np.abs(box.turn) @ box.half for box in parts]).reshape(-1, 3)
    return centres, halves


def _within(solids: tuple[Any, Any], place: SupportSurface) -> tuple[Any, Any]:
    """The boxes that may lie over the surface; `support_surfaces.free_spots` is faster with these few."""
    centres, halves = solids
    reach = float(np.hypot(*place.half))
    gap = np.abs(centres[:, :2] - place.centre[:2]) - halves[:, :2]
    keep = (gap < reach).all(axis=1) & (centres[:, 2] + halves[:, 2] > place.centre[2])
    return centres[keep], halves[keep]


def _watch(house: HouseSpec, trials: list[DropTrial]) -> list[float]:
    """The largest distance [m] of each object from the place where it was put."""
    if not trials:
        return []
    spec = _empty_model(house, _SOLID)
    _add_things(spec.worldbody, house.things, **_SOLID)
    for trial in trials:
        _object(spec, trial)
    model = spec.compile()
    data = mujoco.MjData(model)
    home = np.array([trial.at for trial in trials])
    farthest = np.zeros(len(trials))
    steps = round(WATCHED_S / model.opt.timestep / _LOOKS)
    for _ in range(_LOOKS):
        mujoco.mj_step(model, data, steps)
        now = data.qpos.reshape(-1, 7)[:, :3]
        farthest = np.maximum(farthest, np.linalg.norm(now - home, axis=1))
    return [float(distance) for distance in farthest]


def _object(spec: Any, trial: DropTrial) -> None:
    kind = catalog.kind(trial.target)
    body = spec.worldbody.add_body(pos=trial.at, quat=geoms.quaternion(trial.thing.yaw))
    body.add_freejoint()
    parts = kind.parts()
    total = sum(geoms.volume(part) for part in parts)
    for part in parts:
        bits = geoms.GHOST if len(parts) > 1 and 2 * min(part.half) < THIN_M else _ALONE
        more: dict[str, Any] = {**(GRIP if part.shape == "box" else ROLLING), **bits}
        _add_part(body, part, (0.0, 0.0, 0.0), 0.0, mass=kind.mass * geoms.volume(part) / total, **more)


def penetration_findings(house: HouseSpec) -> tuple[Finding, ...]:
    """``penetration``: things that are more than `PENETRATION_MAX_M` deep in another thing, a wall or the floor."""
    things = {thing.id: thing for thing in house.things}
    found = []
    for (one, two), depth in sorted(penetration_depths(house).items()):
        if depth > PENETRATION_MAX_M:
            first, second = sorted((one, two), key=lambda owner: owner not in things)
            what = f"'{second}' ({readable_kind(things[second].kind)})" if second in things else f"the {second}"
            problem = f"the {readable_kind(things[first].kind)} is {1000 * depth:.0f} mm deep in {what}"
            found.append(error("penetration", first, problem))
    return tuple(found)


def penetration_depths(house: HouseSpec) -> dict[tuple[str, str], float]:
    """The largest depth [m] to which parts of two touching owners overlap, for every such pair.

    Owners are ids of things, "floor" and "wall"; each pair is in alphabetic order.
    """
    spec, owners = _empty_model(house, _TOUCHING), ["wall"]
    for thing in house.things:
        body = spec.worldbody.add_body()
        # The engine only detects contacts of bodies that can move.
        body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE)
        body.mass, body.inertia, body.explicitinertial = 1.0, (1.0, 1.0, 1.0), True
        _add_things(body, (thing,), **_TOUCHING)
        owners.append(thing.id)
    model = spec.compile()
    floor = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, "floor")
    deepest: dict[tuple[str, str], float] = {}
    for geom1, geom2, distance in _contacts(model):
        names = ("floor" if geom == floor else owners[model.geom_bodyid[geom]] for geom in (geom1, geom2))
        one, two = sorted(names)
        deepest[one, two] = max(deepest.get((one, two), 0.0), -distance)
    return deepest


def _contacts(model: Any) -> list[tuple[int, int, float]]:
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    geoms, distances = data.contact.geom, data.contact.dist
    return [(int(pair[0]), int(pair[1]), float(d)) for pair, d in zip(geoms, distances, strict=True) if d < 0.0]
