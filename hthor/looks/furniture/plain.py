"""The default look: a kind's own solids with rounded edges, in materials guessed from their colors."""

from collections.abc import Iterable

import numpy as np

from hthor.looks import materials
from hthor.looks.meshes import solids
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.types import Part


def plain_pieces(parts: Iterable[Part]) -> list[Piece]:
    """One piece per part."""
    return [piece(part) for part in parts]


def piece(part: Part, material: Material | None = None) -> Piece:
    """A part as a piece, of ``material`` or, if that is None, of the material guessed from its color."""
    return materials.piece(solid(part), materials.guess(part.rgba) if material is None else material, part.moves)


def solid(part: Part, radius: float | None = None) -> Mesh:
    """A part's mesh; boxes have edges rounded by ``radius`` [m]."""
    if part.shape == "box":
        lo, hi = (tuple(np.array(part.centre) + sign * np.array(part.half)) for sign in (-1.0, 1.0))
        return solids.box(lo, hi, radius)
    if part.shape == "sphere":
        return solids.ball(part.centre, part.half)
    axis = "xyz".index(part.axis)
    return solids.cylinder(part.centre, part.half[axis - 1], 2.0 * part.half[axis], part.axis, 24)
