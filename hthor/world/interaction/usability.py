"""Whether a body can use a thing from where it stands, and has it in sight: what `Actor.go_to` promises.

Scripts ask before they walk, with a copy of the body at the place in question; the rules are those of the hand
(`hthor.world.interaction.manipulation`), so what is promised here is not refused there.
"""

import itertools
from collections.abc import Iterator

import numpy as np

from hthor.types import Close, Open, Vec3
from hthor.world.interaction.manipulation import Manipulation
from hthor.world.interaction.opening import DoorHandling
from hthor.world.model.arena import NEAR_M
from hthor.world.model.geom_index import GeomIndex
from hthor.world.perception import view_frustum
from hthor.world.state.body_state import BodyState
from hthor.world.state.doors import Doors
from hthor.world.state.objects import Objects
from hthor.world.state.support_surfaces import SupportSurfaces

_INSETS = (0.0, 0.85, 0.57, 0.57)
"""Sight of a solid is tested at points inside it: its middle, and this share of the way to the faces of the box around
it, to its edges and to its corners, so that they are also inside a sphere or a cylinder.
"""
_LARGE_M = 0.10
"""[m] Along axes on which a solid's half extent is smaller than this, its middle is enough."""
_FRAME = 0.95
"""Share of the field of view that counts as in the picture, as a picture ends between two pixels."""


class Usability:
    """What the bodies of one world could do with a thing, and whether they see it."""

    def __init__(
        self,
        geoms: GeomIndex,
        objects: Objects,
        doors: Doors,
        surfaces: SupportSurfaces,
        manipulation: Manipulation,
        door_handling: DoorHandling,
    ) -> None:
        self._geoms, self._objects, self._doors, self._surfaces = geoms, objects, doors, surfaces
        self._manipulation, self._door_handling = manipulation, door_handling

    def hindrance(self, seat: BodyState, id: str) -> str:
        """Why ``seat``, where it stands, could not use a thing; empty when it could, or when there is nothing to do.

        An object is used by picking it up with an empty hand. Furniture is used by placing on or in it what the body
        holds, else by opening or closing it; a closed thing is opened first.
        """
        skills, leaf, item = seat.spec.capabilities, self._doors.get(id), self._objects.get(id)
        if item is not None:
            return self._manipulation.out_of_hand(seat, item) if "pick" in skills else ""
        if seat.holding and self._surfaces.of(id) and "pick" in skills and not self._manipulation.is_shut(id):
            return self._manipulation.no_spot(seat, id)
        if leaf is None or "open" not in skills:
            return ""
        return self._door_handling.refusal(seat, Close(thing=id) if leaf.open else Open(thing=id))

    def sees(self, seat: BodyState, id: str) -> bool:
        """Whether the eye has a free line of sight to a thing, in any direction of the camera."""
        eye = view_frustum.eye_position(seat.pose, seat.spec)
        return any(not self._geoms.hidden(eye, point, id) for point in self._inside(id))

    def shows(self, seat: BodyState, id: str) -> bool:
        """Whether a part of a thing that the eye sees is in the camera's picture now."""
        eye = view_frustum.eye_position(seat.pose, seat.spec)
        wide, high = view_frustum.half_fov_tangents(seat.spec)
        x, y, z = eye
        view = view_frustum.view_axes(x, y, z, seat.pose.gaze, seat.pose.pitch, _FRAME * wide, _FRAME * high)
        return any(
            view_frustum.in_frame(view, point[0] - x, point[1] - y, point[2] - z)
            and not self._geoms.hidden(eye, point, id)
            for point in self._inside(id, except_around=eye)
        )

    def _inside(self, id: str, except_around: Vec3 | None = None) -> Iterator[Vec3]:
        """Points [m] inside the solids of a thing and above the floor: a ray to one of them meets the thing.

        Solids around an eye at ``except_around`` are left out: its picture does not show them from inside.
        """
        geoms = self._geoms
        for geom in geoms.drawn(id):
            if except_around is not None and geoms.is_around(geom, except_around, NEAR_M):
                continue
            half, turn = geoms.half[geom], geoms.mat[geom].reshape(3, 3)
            for signs in itertools.product(*((0, -1, 1) if extent > _LARGE_M else (0,) for extent in half)):
                inset = _INSETS[sum(map(abs, signs))]
                x, y, z = (geoms.pos[geom] + turn @ (inset * half * np.array(signs))).tolist()
                # what lies flat on the floor goes on below it
                yield (x, y, z if z > 0.0 else float(geoms.pos[geom, 2] + half[2]) / 2)
