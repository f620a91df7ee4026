"""What things look like: meshes, textures, materials, made by numbers alone; knows nothing of houses or engines."""

from __future__ import annotations

from hthor import catalog
from hthor.looks import plain
from hthor.looks.mesh import Material, Mesh, Piece
from hthor.types import Vec3

__all__ = ["Material", "Mesh", "Piece", "look"]


def look(kind: str, size: Vec3 | None = None, variant: int = 0) -> tuple[Piece, ...]:
    """The pieces of a thing of ``kind`` at ``size`` [m] (the kind's own when None), in its local frame, closed.

    They fill the thing's bounding box, and lie at the heights where its surfaces are.

    Raises:
        UnknownName: when there is no such kind.
    """
    return plain.pieces(catalog.kind(kind).parts(size, variant))
