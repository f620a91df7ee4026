"""Do the things of a house penetrate one another, its walls or its floor? Exact, part by part; judges nothing else."""

from typing import Any

from hthor.houses.checks.findings import Finding, error, readable_kind
from hthor.types import HouseSpec
from hthor.world.model.engine import mujoco
from hthor.world.validation import static_model

PENETRATION_MAX_M = 0.005
"""[m] by which parts may overlap: what a solver leaves of a contact, and too little to be seen."""
_TOUCHING = {"contype": 1, "conaffinity": 1}


def penetration_findings(house: HouseSpec) -> tuple[Finding, ...]:
    """``penetration``: pairs of things, or a thing and a wall or the floor, more than `PENETRATION_MAX_M` deep."""
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
    """How deep [m] in one another the deepest parts of every two touching owners are.

    Owners are ids of things, "floor" and "wall"; each pair is in alphabetic order.
    """
    spec, owners = static_model.empty_model(house, _TOUCHING), ["wall"]
    for thing in house.things:
        body = spec.worldbody.add_body()
        # The engine only compares bodies that could move.
        body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE)
        body.mass, body.inertia, body.explicitinertial = 1.0, (1.0, 1.0, 1.0), True
        static_model.add_things(body, (thing,), **_TOUCHING)
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
