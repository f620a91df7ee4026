"""The input of a builder of looks: a thing's size, solids and surfaces, with the floor at z = 0."""

from __future__ import annotations

from typing import NamedTuple

from msgspec.structs import replace

from hthor.catalog.kind import Form
from hthor.types import Joint, Part, Rgba, Surface, Vec3


class Draft(NamedTuple):
    """A thing to be built, its middle above the origin and its lowest point at z = 0 [m], its front towards +y."""

    name: str
    size: Vec3
    parts: tuple[Part, ...]
    surfaces: tuple[Surface, ...]
    joints: tuple[Joint, ...]
    variant: int = 0

    @classmethod
    def standing(cls, name: str, size: Vec3, form: Form, variant: int = 0) -> Draft:
        """The draft of a form, whose solids, surfaces and joints are given in the thing's local frame."""
        lift = size[2] / 2.0

        def up(at: Vec3) -> Vec3:
            return (at[0], at[1], at[2] + lift)

        return cls(
            name,
            size,
            tuple(replace(part, centre=up(part.centre)) for part in form.parts),
            tuple(replace(surface, centre=up(surface.centre)) for surface in form.surfaces),
            tuple(replace(joint, anchor=up(joint.anchor)) for joint in form.joints),
            variant,
        )

    def colors(self) -> tuple[Rgba, ...]:
        """The colors of the thing's parts, each once, in the order of the parts."""
        return tuple(dict.fromkeys(part.rgba for part in self.parts))

    def color(self, index: int = 0) -> Rgba:
        """The thing's color number ``index``, or its last color if it has fewer."""
        every = self.colors()
        return every[min(index, len(every) - 1)]
