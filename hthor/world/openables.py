"""Doors and drawers of a thing as a composer entity, without motors: whoever opens them writes their joints.

It knows nothing of hands.
"""

from __future__ import annotations

from hthor import catalog
from hthor.types import Joint, Thing
from hthor.world import geoms
from hthor.world.engine import Entity, mjcf


class Door(Entity):
    """The moving parts of a thing that opens; the rest of the thing is part of the arena.

    Its frame is the thing's local frame. ``joints`` are its `hthor.types.Joint` records in order, ``elements`` the
    engine's joints for them.
    """

    def _build(self, thing: Thing) -> None:
        self.id, self.thing = thing.id, thing
        kind = catalog.kind(thing.kind)
        self.joints = kind.joints(thing.size)
        if not self.joints:
            raise ValueError(f"'{thing.id}' of kind '{thing.kind}' does not open")
        self._root = mjcf.RootElement(model=f"door|{thing.id.replace('/', '|')}")
        self.elements = tuple(self._leaf(joint) for joint in self.joints)

    def _leaf(self, joint: Joint) -> mjcf.Element:
        leaf = self._root.worldbody.add("body", name=joint.name, pos=joint.anchor)
        back = (-joint.anchor[0], -joint.anchor[1], -joint.anchor[2])
        parts = [
            part
            for part in catalog.kind(self.thing.kind).parts(self.thing.size, self.thing.variant)
            if part.moves == joint.name
        ]
        for index, part in enumerate(parts):
            mass = 4.0 / len(parts)
            geoms.add_part(leaf, f"{joint.name}:{index}", part, back, mass=mass, group=geoms.FURNITURE, **geoms.LEAF)
        return leaf.add("joint", name=joint.name, type=joint.kind, axis=joint.axis, damping=2.0, frictionloss=1.0)

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        return self._root
