"""The record of a kind of thing: its size, mass, affordances and form."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Literal

from msgspec import Struct

from hthor.types import Joint, Part, Rgba, Surface, Vec3


class Form(Struct, frozen=True, kw_only=True):
    """The solids, resting places, doors and drawers of a thing of a given size, in the thing's local frame."""

    parts: tuple[Part, ...]
    surfaces: tuple[Surface, ...] = ()
    joints: tuple[Joint, ...] = ()


Shape = Callable[..., Form]
"""A function that makes the form of a thing from its (width, depth, height) [m] and from colors by keyword."""

Family = Literal["receptacle", "target", "household"]


@lru_cache(maxsize=4096)
def _form(shape: Shape, size: Vec3, colors: tuple[tuple[str, Rgba], ...]) -> Form:
    return shape(size, **dict(colors))


class Kind(Struct, frozen=True, kw_only=True):
    """A kind of thing: ``name`` for programs, ``title`` for people.

    ``size`` [m] is the default size, which a house may change: (width, depth, height) along the local x, y and z axes,
    front towards +y. ``mass`` [kg] is that of the default size. ``relation`` says whether objects lie "in" such a
    thing, as in a fridge or a sink, or "on" it. ``finishes`` are the colors that each variant changes of the shape's
    own colors; variant 0 changes none. ``handles`` says that the thing has a handle at either end of its width, so
    that several bodies can carry it together.
    """

    name: str
    title: str
    family: Family
    size: Vec3
    mass: float
    shape: Shape
    pickable: bool = False
    wall_mounted: bool = False
    relation: Literal["on", "in"] = "on"
    finishes: tuple[Mapping[str, Rgba], ...] = ()
    handles: bool = False

    def form(self, size: Vec3 | None = None, variant: int = 0) -> Form:
        """Parts, surfaces and joints at ``size`` [m], or at the kind's own size; ``variant`` only picks colors."""
        looks = ({}, *self.finishes)[variant % (1 + len(self.finishes))]
        return _form(self.shape, self.size if size is None else size, tuple(sorted(looks.items())))

    def parts(self, size: Vec3 | None = None, variant: int = 0) -> tuple[Part, ...]:
        """The solids with all doors and drawers closed; their common bounding box is exactly ``size``."""
        return self.form(size, variant).parts

    def surfaces(self, size: Vec3 | None = None) -> tuple[Surface, ...]:
        """The surfaces where objects can rest, lowest first; empty for a thing that is not a receptacle."""
        return self.form(size).surfaces

    def rests(self, size: Vec3 | None = None) -> tuple[Surface, ...]:
        """The surfaces where a task may put things and people look for them, lowest first.

        These are open surfaces, and those inside a thing that objects are put *in*, such as a fridge; not drawers.
        """
        within = self.relation == "in" and self.family == "receptacle"
        return tuple(surface for surface in self.surfaces(size) if within or not surface.inside)

    @property
    def hides(self) -> bool:
        """Whether the thing must be opened to see the objects on its `rests`."""
        return any(surface.inside for surface in self.rests())

    def joints(self, size: Vec3 | None = None) -> tuple[Joint, ...]:
        """The joints of its doors and drawers; empty for a thing that does not open."""
        return self.form(size).joints

    @property
    def openable(self) -> bool:
        """Whether it has doors or drawers."""
        return bool(self.form().joints)

    @property
    def receptacle(self) -> bool:
        """Whether objects can rest on or in it."""
        return bool(self.form().surfaces)

    @property
    def indefinite(self) -> str:
        """The title with its indefinite article: "an apple", "a dining table"."""
        return f"{'an' if self.title[0] in 'aeiou' else 'a'} {self.title}"

    @property
    def definite(self) -> str:
        """The title with its definite article: "the apple"."""
        return f"the {self.title}"
