"""Does every surface of a house take every target? Each is put down and watched by the engine.

All are tried in one simulation, in which the objects do not meet one another.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import catalog
from hthor.geometry.plane import to_house
from hthor.houses.checks.findings import Finding, error, readable_kind
from hthor.houses.space import boxes
from hthor.types import HouseSpec, Surface, Thing, Vec3
from hthor.world.model import geoms, walls
from hthor.world.model.engine import mujoco
from hthor.world.model.props import GRIP, ROLLING, THIN_M
from hthor.world.state.support_surfaces import SupportSurface, SupportSurfaces, free_spots
from hthor.world.validation import static_model

STAYS_M = 0.02
"""[m] by which an object may move from where it was put."""
WATCHED_S = 2.0
"""[s] for which it is watched."""
_LOOKS = 10
"""How often its position is read in that time."""
_SOLID = {"contype": 1, "conaffinity": 0}
_ALONE = {"contype": 2, "conaffinity": 1}


class DropTrial(Struct, frozen=True, kw_only=True):
    """One target on one surface: where it is put [m], None where it does not fit."""

    thing: Thing
    surface: Surface
    target: str
    at: Vec3 | None


def drop_findings(house: HouseSpec) -> tuple[Finding, ...]:
    """``surface-takes``: every target that some surface has no room for, or that does not stay there.

    Of the surfaces where a task may put things (`hthor.catalog.Kind.rests`) of everything that cannot be carried away.
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
    """Centres and half extents (M, 3) [m] of unturned boxes around all parts of all things and walls."""
    parts = [box for thing in house.things for _, box in boxes.boxes_of(thing)]
    upright = (0.0, 0.0, 1.0)
    parts += [
        boxes.Box(panel.centre, panel.half, boxes.rotation(upright, panel.yaw)) for panel in walls.wall_panels(house)
    ]
    centres = np.array([box.centre for box in parts]).reshape(-1, 3)
    halves = np.array([np.abs(box.turn) @ box.half for box in parts]).reshape(-1, 3)
    return centres, halves


def _within(solids: tuple[Any, Any], place: SupportSurface) -> tuple[Any, Any]:
    """Those of the boxes that may lie over the place: all that `candidates` would look at, and far fewer."""
    centres, halves = solids
    reach = float(np.hypot(*place.half))
    gap = np.abs(centres[:, :2] - place.centre[:2]) - halves[:, :2]
    keep = (gap < reach).all(axis=1) & (centres[:, 2] + halves[:, 2] > place.centre[2])
    return centres[keep], halves[keep]


def _watch(house: HouseSpec, trials: list[DropTrial]) -> list[float]:
    """How far [m] each object was, at the farthest, from where it was put."""
    if not trials:
        return []
    spec = static_model.empty_model(house, _SOLID)
    static_model.add_things(spec.worldbody, house.things, **_SOLID)
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
        static_model.add_part(body, part, (0.0, 0.0, 0.0), 0.0, mass=kind.mass * geoms.volume(part) / total, **more)
