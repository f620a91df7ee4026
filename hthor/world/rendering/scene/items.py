"""One mesh of the visual model with its owner and material."""

from typing import NamedTuple

from hthor.looks import Material, Mesh

ALWAYS, INSIDE, ABOVE = 0, 4, 5
"""Draw groups: always drawn; left out of the view from above, like ceilings; drawn only there, like cut walls."""


class SceneMesh(NamedTuple):
    """A mesh in the house frame. ``owner`` is what it counts as in a segmentation."""

    owner: str
    mesh: Mesh
    material: Material
    group: int = ALWAYS
