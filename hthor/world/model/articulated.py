"""Doors and drawers as composer entities without motors: their joints are written directly."""

from hthor.types import Joint
from hthor.world.model import geoms
from hthor.world.model.door_geometry import Openable
from hthor.world.model.engine import Entity, mjcf

_MASS_KG = 4.0
"""[kg] of all moving parts of one joint; our choice."""
_STIFF = {"damping": 50.0, "frictionloss": 500.0, "armature": 1000.0}
"""So stiff that what falls or rolls against a door or drawer does not move it; only hands do."""


class Door(Entity):
    """The moving parts of a thing that opens; the rest of the thing is part of the arena.

    Its frame is the thing's local frame. ``joints`` are its `hthor.types.Joint` records in order, ``elements`` the
    engine's joints for them: 0 is closed, ``travel`` open. A doorway's leaf is open in the model's own pose, so that
    nothing needs to be done for it when an episode begins.
    """

    def _build(self, opens: Openable) -> None:
        self.id, self.opens, self.thing, self.joints = opens.id, opens, opens.thing, opens.joints
        self._root = mjcf.RootElement(model=f"door|{opens.id.replace('/', '|')}")
        self.leaves = tuple(self._leaf(joint) for joint in self.joints)
        self.elements = tuple(leaf.joint[0] for leaf in self.leaves)

    def _leaf(self, joint: Joint) -> mjcf.Element:
        start = joint.travel if self.opens.opening is not None else 0.0
        leaf = self._root.worldbody.add("body", name=joint.name, gravcomp=1.0, **_pose(joint, start))
        back = (-joint.anchor[0], -joint.anchor[1], -joint.anchor[2])
        parts = [part for part in self.opens.parts if part.moves == joint.name]
        for index, part in enumerate(parts):
            mass = _MASS_KG / len(parts)
            bits = geoms.LEAF if joint.kind == "hinge" else geoms.STATIC
            geoms.add_part(leaf, f"{joint.name}:{index}", part, back, mass=mass, group=geoms.FURNITURE, **bits)
        leaf.add("joint", name=joint.name, type=joint.kind, axis=joint.axis, ref=start, **_STIFF)
        return leaf

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        return self._root


def _pose(joint: Joint, start: float) -> dict[str, object]:
    """A leaf's frame at ``start`` [rad] of an upright hinge, or closed."""
    turn = geoms.quaternion(start * joint.axis[2]) if joint.kind == "hinge" and start else (1.0, 0.0, 0.0, 0.0)
    return {"pos": joint.anchor, "quat": turn}
