"""What things look like: meshes, textures, materials, made by numbers alone."""

import importlib
from functools import lru_cache
from typing import Any

from hthor import catalog
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.types import Vec3

CODE_PART = "pictures"

__all__ = ["Material", "Mesh", "Piece", "look", "textures"]


@lru_cache(maxsize=2048)
def look(kind: str, size: Vec3 | None = None, variant: int = 0) -> tuple[Piece, ...]:
    """The pieces of a thing of ``kind`` at ``size`` [m] (the kind's own when None), in its local frame, closed.

    They fill the thing's bounding box, and lie at the heights where its surfaces are. Pieces that move name their
    joint. One is made a material and joint, so there are few.

    Raises:
        UnknownName: when there is no such kind.
    """
    from hthor.looks import build  # only who draws needs the shapes of everything

    return build.build_pieces(catalog.kind(kind), size, variant)


def __getattr__(name: str) -> Any:
    """`textures`, imported on first use."""
    if name == "textures":
        return importlib.import_module("hthor.looks.textures")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
