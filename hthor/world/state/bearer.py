"""The furniture that bears an object which leans on something or lies across an edge."""

from collections.abc import Callable

from hthor.world.state.movable_object import MovableObject
from hthor.world.state.overlap_test import FLOOR, OverlapTest
from hthor.world.state.support_surfaces import SupportSurfaces


def bearer(
    item: MovableObject,
    get: Callable[[str], MovableObject | None],
    surfaces: SupportSurfaces,
    overlap: OverlapTest,
    above: tuple[str, ...] = (),
) -> str:
    """The support of an object at rest whose middle is over no surface; empty for the floor.

    Args:
        get: returns the object with an id. above: the objects on top of it whose support is being searched for.
    """
    for owner in overlap.touched(item):
        other = get(owner)
        if owner == FLOOR:
            return ""
        if other is None and surfaces.of(owner):
            return owner
        if other is not None and owner not in above:
            found = surfaces.support(other.position, other.size[2])
            found = found or bearer(other, get, surfaces, overlap, (*above, item.id))
            if found:
                return found
    return ""
