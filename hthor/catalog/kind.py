"""What a kind of thing is: a record of its size, mass, affordances and form; knows nothing of where things stand."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Literal

from msgspec import Struct

from hthor.types import Hinge, Part, Surface, Vec3


class Form(Struct, frozen=True, kw_only=True):
    """The solids, resting places and door of a thing of a given size, in the thing's local frame."""

    parts: tuple[Part, ...]
    surfaces: tuple[Surface, ...] = ()
    hinge: Hinge | None = None


Shape = Callable[[Vec3], Form]
"""Makes the form of a thing from its (width, depth, height) [m]."""

Family = Literal["receptacle", "target", "background"]


@lru_cache(maxsize=4096)
def _form(shape: Shape, size: Vec3) -> Form:
    return shape(size)


class Kind(Struct, frozen=True, kw_only=True):
    """A kind of thing: ``name`` for programs, ``title`` for people.

    ``size`` [m] is what a thing of this kind measures unless its house says otherwise: (width, depth, height) along
    the local x, y and z axes, front towards +y. ``mass`` [kg] belongs to that size. ``relation`` is how an object
    lies there: in a fridge or a sink, on anything else.
    """

    name: str
    title: str
    family: Family
    size: Vec3
    mass: float
    shape: Shape
    pickable: bool = False
    openable: bool = False
    wall_mounted: bool = False
    relation: Literal["on", "in"] = "on"

    def form(self, size: Vec3 | None = None) -> Form:
        """Parts, surfaces and hinge at ``size`` [m], or at the kind's own size."""
        return _form(self.shape, self.size if size is None else size)

    def parts(self, size: Vec3 | None = None) -> tuple[Part, ...]:
        """The solids; their common bounding box is exactly ``size``."""
        return self.form(size).parts

    def surfaces(self, size: Vec3 | None = None) -> tuple[Surface, ...]:
        """Where objects can rest, lowest first; empty for a thing that is no receptacle."""
        return self.form(size).surfaces

    def hinge(self, size: Vec3 | None = None) -> Hinge | None:
        """The door's axis and travel, None for a thing that does not open."""
        return self.form(size).hinge

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
