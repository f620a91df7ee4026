"""The looks of things: meshes, textures and materials, all computed without files."""

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
    """The pieces of a thing of ``kind`` at ``size`` [m] (None: the kind's own size): closed meshes in its local frame.

    They fill the thing's bounding box, and match the heights of its surfaces. Pieces that move name their joint. There
    is one piece for each material and joint, so there are few.

    Raises:
        UnknownName: if no kind has this name.
    """
    from hthor.looks import build  # only drawing needs the shapes of all kinds

    return build.build_pieces(catalog.kind(kind), size, variant)


def __getattr__(name: str) -> Any:
    """`textures`, imported on first use."""
    if name == "textures":
        return importlib.import_module("hthor.looks.textures")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
