"""Pictures for agents, without OpenGL: one ray per pixel through the engine's own solids.

It draws copied poses with a copy of the model, so a picture never changes the world.
"""

import copy
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from msgspec import UNSET
from numpy.typing import NDArray

from hthor.looks import finishes
from hthor.types import CameraSpec, HouseSpec, Pose
from hthor.world.model import geoms
from hthor.world.model.bodies import bodies
from hthor.world.model.bodies.primitives import HEAD
from hthor.world.model.engine import mujoco
from hthor.world.model.geom_index import GeomIndex
from hthor.world.rendering import camera, rasterizer, shading
from hthor.world.rendering.camera import Images, PoseSnapshot
from hthor.world.rendering.viewpoint import Viewpoint

CODE_PART = "pictures"

_CLEAR = 0.5
"""[0..1] Solids less opaque than this are transparent: they tint colours but are not in depth and segmentation."""
LOW_WALL_M = 1.0
"""[m] Height at which walls are cut in overviews, so that they hide little of what is behind them."""
_HIDDEN_GROUP = 5
_UNSET = (0.5, 0.5, 0.5, 1.0)
"""The engine's default colour; a geom with it has the colour of its material."""

_BOARDS = ("planks", "parquet", "herringbone", "wicker")
_CLOTH = ("armchair", "bed", "cloth", "curtain", "dog_bed", "ottoman", "pillow", "rug", "sofa", "teddy_bear", "towel")


class RayRenderer:
    """Draws snapshots of one world."""

    def __init__(self, model: Any, scene: GeomIndex, house: HouseSpec) -> None:
        self._model = copy.copy(model)
        self._model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
        self._data = mujoco.MjData(self._model)
        self._pos, self._mat = self._data.geom_xpos, self._data.geom_xmat.reshape(-1, 9)
        self._owners, self._names = np.append(scene.numbers, -1).astype(np.int32), scene.names
        self._span = scene.span
        self._shape = np.array(model.geom_type, np.int32)
        self._half = _halves(model)
        self._radius = np.linalg.norm(self._half, axis=1)
        self._rgba = _colours(model)
        self._skin = geom_patterns(model, scene.owner, house, self._rgba)
        self._grain = np.argmax(self._half, axis=1).astype(np.int32)
        self._noise = shading.mottle()
        self._heads: dict[str, Any] = {}
        shown = (model.geom_group != _HIDDEN_GROUP) & (self._rgba[:, 3] > 0.0)
        clear = self._rgba[:, 3] < _CLEAR
        order = np.argsort(-self._radius, kind="stable")
        self._solid, self._glass = order[(shown & ~clear)[order]], order[(shown & clear)[order]]
        self._roofless = self._solid[model.geom_group[self._solid] != geoms.CEILINGS]
        self._walls = np.flatnonzero(model.geom_group == geoms.WALLS)

    def look(self, moment: PoseSnapshot, seat: str, size: tuple[int, int], by: CameraSpec = camera.OWN) -> Images:
        """All three pictures of the camera of ``seat``, without its own body."""
        view, w, hit = self._fill(moment, seat, size, by)
        return Images(self._shade(view, w, hit), _depth(w), self._numbers(hit))

    def view(
        self, moment: PoseSnapshot, seat: str, mode: str, size: tuple[int, int], by: CameraSpec = camera.OWN
    ) -> Any:
        """One picture of the camera of ``seat``: rgb, depth or segmentation."""
        view, w, hit = self._fill(moment, seat, size, by)
        if mode == "rgb":
            return self._shade(view, w, hit)
        return _depth(w) if mode == "depth" else self._numbers(hit)

    def survey(
        self, moment: PoseSnapshot, seat: str, poses: Iterable[Pose], size: tuple[int, int], colours: bool
    ) -> Iterator[tuple[NDArray[np.uint8] | None, NDArray[np.float32], NDArray[np.int32]]]:
        """Colours if they are wanted, depth and numbers of owners, as in `look`, from each of these poses of ``seat``;
        nothing else moves.
        """
        self._pose(moment, seat)
        spec = moment.seats[seat][1]
        for pose in poses:
            view = camera.projection_vector(pose, spec, size)
            w, hit = _blank(view, size)
            self._draw(view, self._solid, w, hit)
            yield self._shade(view, w, hit) if colours else None, _depth(w), self._numbers(hit)

    def top_view(self, moment: PoseSnapshot, bounds: tuple[float, float, float, float], pixels_per_metre: float) -> Any:
        """The area x0, y0, x1, y1 [m] from straight above without ceilings, (H, W, 3) uint8."""
        x0, y0, x1, y1 = bounds
        self._pose(moment, "")
        size = (max(1, round((x1 - x0) * pixels_per_metre)), max(1, round((y1 - y0) * pixels_per_metre)))
        view = camera.top_view_vector(bounds)
        w, hit = _blank(view, size)
        self._draw(view, self._roofless, w, hit)
        return self._shade(view, w, hit)

    def overview(self, moment: PoseSnapshot, viewpoint: Viewpoint, mode: str, size: tuple[int, int]) -> Any:
        """The house without ceilings and with low walls from any viewpoint: rgb or depth."""
        self._pose(moment, "")
        view = viewpoint.vector(size)
        w, hit = _blank(view, size)
        half, pos = self._half.copy(), self._pos.copy()
        foot, top = pos[self._walls, 2] - half[self._walls, 2], pos[self._walls, 2] + half[self._walls, 2]
        top = np.minimum(top, LOW_WALL_M)
        half[self._walls, 2], pos[self._walls, 2] = (top - foot) / 2, (top + foot) / 2
        shown = self._roofless[~np.isin(self._roofless, self._walls[top <= foot])]
        rasterizer.fill(view, shown, self._shape, half, self._radius, pos, self._mat, w, hit)
        if mode == "depth":
            return _depth(w)
        none = np.full_like(hit, -1)
        out = np.empty((*w.shape, 3), np.uint8)
        shading.shade(
            view, w, hit, none, self._shape, half, pos, self._mat, self._rgba, self._skin, self._grain, self._noise, out
        )
        return out

    def _fill(self, moment: PoseSnapshot, seat: str, size: tuple[int, int], by: CameraSpec) -> tuple[Any, Any, Any]:
        self._pose(moment, seat)
        view = camera.projection_vector(*moment.seats[seat], size, by)
        w, hit = _blank(view, size)
        self._draw(view, self._solid, w, hit)
        return view, w, hit

    def _pose(self, moment: PoseSnapshot, without: str) -> None:
        """Put everything where it was at ``moment``, heads turned, and the body ``without`` far away."""
        moment.restore(self._model, self._data, without)
        for seat, (pose, spec) in moment.seats.items():
            if seat == without or (pose.pitch == 0.0 and pose.head is UNSET):
                continue
            if seat not in self._heads:
                parts = enumerate(bodies.look(spec))
                self._heads[seat] = np.array([self._span[seat][0] + k for k, part in parts if part.moves == HEAD], int)
            self._tilt(self._heads[seat], *bodies.head_transform(spec, pose.pitch, pose.head or 0.0), pose)

    def _tilt(self, ids: Any, turn: Any, offset: Any, pose: Any) -> None:
        """Turn the solids of a head, in the frame of a body that stands at ``pose``."""
        cos, sin = np.cos(pose.yaw), np.sin(pose.yaw)
        body, foot = np.array(((cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0))), np.array((pose.x, pose.y, 0.0))
        whole = body @ turn @ body.T
        self._pos[ids] = (self._pos[ids] - foot) @ whole.T + body @ offset + foot
        self._mat[ids] = (whole @ self._mat[ids].reshape(-1, 3, 3)).reshape(-1, 9)

    def _draw(self, view: Any, order: Any, w: Any, hit: Any) -> None:
        rasterizer.fill(view, order, self._shape, self._half, self._radius, self._pos, self._mat, w, hit)

    def _shade(self, view: Any, w: Any, hit: Any) -> NDArray[np.uint8]:
        """Colours of all pixels; glass is drawn over the solids behind it."""
        glass_w, glass_hit = w.copy(), np.full_like(hit, -1)
        self._draw(view, self._glass, glass_w, glass_hit)
        out = np.empty((*w.shape, 3), np.uint8)
        solids = self._shape, self._half, self._pos, self._mat, self._rgba, self._skin, self._grain
        shading.shade(view, w, hit, glass_hit, *solids, self._noise, out)
        return out

    def _numbers(self, hit: Any) -> NDArray[np.int32]:
        numbers: NDArray[np.int32] = self._owners[hit >> 3]
        return numbers


def _blank(view: Any, size: tuple[int, int]) -> tuple[Any, Any]:
    return np.full((size[1], size[0]), 1.0 / view[15]), np.full((size[1], size[0]), -1, np.int32)


def _depth(w: Any) -> NDArray[np.float32]:
    depth: NDArray[np.float32] = (1.0 / w).astype(np.float32)
    return depth


def _halves(model: Any) -> Any:
    """(N, 3) half extents [m] of the boxes around the geoms in their own frames."""
    half, kind = np.array(model.geom_size), model.geom_type
    sphere, plane = kind == rasterizer.SPHERE, kind == rasterizer.PLANE
    half[sphere] = half[sphere][:, :1]
    long = (kind == rasterizer.CYLINDER) | (kind == rasterizer.CAPSULE)
    half[long] = half[long][:, [0, 0, 1]]
    half[kind == rasterizer.CAPSULE, 2] += half[kind == rasterizer.CAPSULE, 0]
    half[plane] = np.where(half[plane] > 0.0, half[plane], 1e3) * (1.0, 1.0, 0.0)
    return half


def _colours(model: Any) -> Any:
    """(N, 4) float32, each geom's own colour, or that of its material."""
    rgba = np.array(model.geom_rgba)
    plain = (model.geom_matid >= 0) & (np.abs(rgba - _UNSET) < 1e-6).all(axis=1)
    rgba[plain] = model.mat_rgba[model.geom_matid[plain]]
    return rgba


def geom_patterns(model: Any, owners: Sequence[str], house: HouseSpec, rgba: Any) -> Any:
    """(N,) int32, the pattern of each geom by its number in `hthor.world.rendering.shading`."""
    floors = {f"floor of {room.id}": _floor(room.floor) for room in house.rooms}
    outside = {wall.id for wall in house.walls if wall.room == "exterior"}
    walls = {wall.id for wall in house.walls}
    cloth = {thing.id for thing in house.things if thing.kind in _CLOTH}
    things = {thing.id for thing in house.things}
    out = np.zeros(model.ngeom, np.int32)
    for geom, owner in enumerate(owners):
        if owner in floors:
            out[geom] = floors[owner]
        elif owner.startswith("ceiling of "):
            out[geom] = shading.GLOWING
        elif owner == "outdoors":
            out[geom] = shading.LAWN
        elif owner in walls:
            out[geom] = shading.BRICK if owner in outside else shading.PLASTER
        elif owner in things and model.geom_group[geom] == geoms.FURNITURE and _wooden(rgba[geom]):
            out[geom] = shading.GRAIN
        elif owner in cloth:
            out[geom] = shading.CLOTH
    return out


def _floor(material: str) -> int:
    texture = finishes.floor(material)[0]
    if texture == "carpet":
        return shading.CARPET
    return shading.PLANKS if texture.startswith(_BOARDS) else shading.TILES


def _wooden(rgba: Any) -> bool:
    """Whether a colour is a wood colour, from walnut to birch, and not rust, mustard or cream."""
    red, green, blue, _ = (float(value) for value in rgba)
    return red < 0.88 and red - blue > 0.15 and 0.38 < (green - blue) / (red - blue) < 0.62
