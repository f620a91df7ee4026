"""A hinged door as a composer entity, without a motor: whoever opens it writes its angle; knows nothing of hands."""

from __future__ import annotations

from hthor import catalog
from hthor.types import Thing
from hthor.world import geoms
from hthor.world.engine import Entity, mjcf


class Door(Entity):
    """The moving parts of a thing that opens; the rest of the thing is part of the arena.

    Its frame is the thing's local frame. ``travel`` [rad] is the angle of the open door, 0 is closed.
    """

    def _build(self, thing: Thing) -> None:
        self.id, self.thing = thing.id, thing
        kind = catalog.kind(thing.kind)
        hinge = kind.hinge(thing.size)
        if hinge is None:
            raise ValueError(f"'{thing.id}' of kind '{thing.kind}' has no hinge")
        self.travel = hinge.travel
        self._root = mjcf.RootElement(model=f"door|{thing.id.replace('/', '|')}")
        axis = (hinge.axis[0], hinge.axis[1], 0.0)
        leaf = self._root.worldbody.add("body", name="leaf", pos=axis)
        self.joint = leaf.add("joint", name="hinge", type="hinge", axis=(0, 0, 1), damping=2.0, frictionloss=1.0)
        for index, part in enumerate(kind.parts(thing.size)):
            if part.moves:
                centre = (-axis[0], -axis[1], 0.0)
                bits = geoms.LEAF
                geoms.add_part(leaf, f"part:{index}", part, centre, mass=4.0, group=geoms.FURNITURE, **bits)

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        return self._root
