"""A movable object as a composer entity with its true mass."""

from hthor import catalog
from hthor.types import Vec3
from hthor.world.model import geoms
from hthor.world.model.engine import Entity, mjcf

GRIP = {"friction": (0.8, 0.01, 0.001)}
"""Sliding, torsional [m] and rolling [m] friction of flat things, as MuJoCo counts them; our choice."""
ROLLING = {"friction": (0.8, 0.01, 0.003), "condim": 6}
"""The same for round things: rolling friction lets balls and cups come to rest."""
THIN_M = 0.006
"""[m] Thinner parts, such as a key or a screen, are only drawn: what fell on them would come to rest inside."""


class Prop(Entity):
    """An object that can be carried; its frame's origin is the centre of its bounding box.

    Args:
        id: the object's id. kind: its kind's name. size: [m], the kind's own when None. variant: of its finish.
    """

    def _build(self, id: str, kind: str, size: Vec3 | None = None, variant: int = 0) -> None:
        known = catalog.kind(kind)
        self.id, self.kind, self.size = id, kind, known.size if size is None else size
        self.mass = known.mass * _ratio(self.size, known.size)
        self._root = mjcf.RootElement(model=f"object|{id.replace('/', '|')}")
        parts = known.parts(self.size, variant)
        total = sum(geoms.volume(part) for part in parts)
        for index, part in enumerate(parts):
            surface = GRIP if part.shape == "box" else ROLLING
            share = self.mass * geoms.volume(part) / total
            bits = geoms.GHOST if len(parts) > 1 and 2 * min(part.half) < THIN_M else geoms.MOVABLE
            name = f"part:{index}"
            geoms.add_part(self._root.worldbody, name, part, mass=share, group=geoms.OBJECTS, **surface, **bits)

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        return self._root


def _ratio(size: Vec3, own: Vec3) -> float:
    return (size[0] * size[1] * size[2]) / (own[0] * own[1] * own[2])
