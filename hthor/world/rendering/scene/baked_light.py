"""The light of a house's lamps at the corners of its meshes, with shadows, for programs that draw without lights.

It is computed once for a house. What moves gets only its own creases, and the light of the place where it is, which
`BakedLight.probes` tells.
"""

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from hthor.types import Vec2
from hthor.world.rendering.scene import lights, triangle_kernel

_RAYS = 20
"""[count] Rays that look for what is near a point."""
_NEAR_M = 0.9
"""[m] What is farther away makes a point no darker."""
_FAR_M, _FEW = 50.0, 8
"""[m] Longer than any house; and one of so many rays is enough to tell whether a point is inside a body."""
_OFF_M = 0.012
"""[m] Rays begin so far above their surface."""
_LAMP_FAR_M = 9.0
"""[m] A lamp that is farther away adds nothing."""
_LAMP_M = 0.18
"""[m] Size of a lamp, of which four points give light: shadows have soft edges."""
_DARKEST = 0.45
"""The share of the light from all sides that reaches the deepest crease."""
_HEAD = 0.75
"""The share of the light at the viewer's head that surfaces get on average, as it goes with them."""
_PROBE_M, _PROBE_HEIGHT_M = 0.25, 0.9
"""[m] Side of the cells of the grid of probes, and the height that they are for."""
_INSIDE = 0.4
"""A point is inside something when so great a share of its rays meets surfaces from behind. Our choice."""
_SLIT_M = 0.04
"""[m] A point is in a slit when its rays go no farther on average. Our choice."""
_CHUNK = 8192
"""[count] Points of one task of a thread."""


class Probes(NamedTuple):
    """The light of the lamps in a grid over the house: ``light`` (H, W) float32, cell [j, i] is around ``origin`` +
    ``side`` (i, j) [m].
    """

    origin: Vec2
    side: float
    light: Any


class Seen(NamedTuple):
    """Of points: ``light`` (N, 3) or (N,), and whether each is ``hidden`` (N,), inside a body or in a slit."""

    light: Any
    hidden: Any


class BakedLight:
    """The light in one house.

    Args:
        corners: (F, 3, 3) [m], the triangles that hide light. lamps: the places of each room's lamps.
        height: [m] of the ceiling. threads: how many to use.
    """

    def __init__(self, corners: Any, lamps: Mapping[str, Any], height: float, threads: int = 2) -> None:
        self._tree = (corners, *triangle_kernel.build_tree(corners))
        self._lamps = [(place, 1.0 / len(places) ** 0.5) for places in lamps.values() for place in places]
        self._height, self._threads = height, threads
        self._ways = _cosine_directions(_RAYS)

    def openness(self, points: Any, normals: Any) -> Seen:
        """How open each point is to its surroundings, (N,), from `_DARKEST` in a crease to 1."""
        return self._in_chunks(self._openness, points, normals)

    def inside(self, points: Any, normals: Any) -> Any:
        """(N,) Whether each point is inside a closed body."""
        begin = points + _OFF_M * normals
        return triangle_kernel.openness(*self._tree, begin, normals, self._ways[::_FEW], _FAR_M)[1] == 1.0

    def light(self, points: Any, normals: Any) -> Seen:
        """The light at static points with these normals, (N, 3); 1 shows a surface in its own colour."""
        return self._in_chunks(self._light, points, normals)

    def probes(self, bounds: tuple[float, float, float, float]) -> Probes:
        """The light of the lamps on what faces them at the height of a table, on the area x0, y0, x1, y1 [m].

        Cells inside of something have the light of the nearest one that is outside.
        """
        x0, y0, x1, y1 = bounds
        xs, ys = np.arange(x0, x1 + _PROBE_M, _PROBE_M), np.arange(y0, y1 + _PROBE_M, _PROBE_M)
        grid = np.stack([*np.meshgrid(xs, ys), np.full((len(ys), len(xs)), _PROBE_HEIGHT_M)], axis=-1).reshape(-1, 3)
        up = np.tile((0.0, 0.0, 1.0), (len(grid), 1))
        lamp = np.zeros((len(self._lamps), len(grid)))
        for number, (place, share) in enumerate(self._lamps):
            way = (*place, self._height) - grid
            towards = way / np.linalg.norm(way, axis=1, keepdims=True)
            lamp[number] = self._lamp(place, share, grid, towards)[:, 1]
        lamp = _brightest(lamp)
        hidden = self.openness(grid, up).hidden
        if hidden.any() and not hidden.all():
            lamp[hidden] = lamp[~hidden][cKDTree(grid[~hidden]).query(grid[hidden])[1]]
        return Probes((x0, y0), _PROBE_M, lamp.reshape(len(ys), len(xs)).astype(np.float32))

    def _light(self, points: Any, normals: Any) -> Seen:
        openness, hidden = self._openness(points, normals)
        lit = np.zeros((len(self._lamps), len(points), 3))
        for number, (place, share) in enumerate(self._lamps):
            near = (np.hypot(points[:, 0] - place[0], points[:, 1] - place[1]) < _LAMP_FAR_M) & ~hidden
            if near.any():
                lit[number, near] = self._lamp(place, share, points[near], normals[near])
        direction, colour = lights.FILL
        aim = -np.array(direction) / np.linalg.norm(direction)
        around = np.array(lights.AMBIENT) + _HEAD * np.array(lights.HEAD)
        around = around + np.clip(normals @ aim, 0, 1)[:, None] * colour
        return Seen(_brightest(lit) + around * openness[:, None], hidden)

    def _lamp(self, place: Vec2, share: float, points: Any, normals: Any) -> Any:
        """(N, 3) What one lamp adds: its own light with shadows, and what the room throws back where it is seen."""
        bulb = np.array((*place, self._height - lights.LAMP_DROP_M))
        seen = np.zeros(len(points))
        begin = points + _OFF_M * normals
        steps = ((1.0, 0.4), (-0.4, 1.0), (0.4, -1.0), (-1.0, -0.4))
        for dx, dy in steps:
            at = bulb + np.array((dx, dy, 0.0)) * _LAMP_M
            seen += triangle_kernel.unhidden(*self._tree, begin, normals, at) / len(steps)
        slope, way, distance = _slope(bulb, points, normals)
        cone = np.clip(way[:, 2] / distance, 0.0, 1.0)
        direct = seen * slope * lights.attenuation(lights.LAMP_FADE, distance) * cone**lights.LAMP_EXPONENT
        low = np.array((*place, self._height - lights.BOUNCE_DROP_M))
        slope, _, distance = _slope(low, points, normals)
        thrown = share * seen * slope * lights.attenuation(lights.BOUNCE_FADE, distance)
        return direct[:, None] * np.array(lights.LAMP) + thrown[:, None] * np.array(lights.BOUNCE)

    def _openness(self, points: Any, normals: Any) -> Seen:
        begin = points + _OFF_M * normals
        found, behind = triangle_kernel.openness(*self._tree, begin, normals, self._ways, _NEAR_M)
        return Seen(_DARKEST + (1.0 - _DARKEST) * found, (behind > _INSIDE) | (found < _SLIT_M / _NEAR_M))

    def _in_chunks(self, work: Callable[[Any, Any], Seen], points: Any, normals: Any) -> Seen:
        spans = [slice(k, k + _CHUNK) for k in range(0, len(points), _CHUNK)]
        with ThreadPoolExecutor(self._threads) as pool:
            done = list(pool.map(lambda span: work(points[span], normals[span]), spans))
        return Seen(*map(np.concatenate, zip(*done, strict=True)))


def _brightest(lit: Any) -> Any:
    """(N, ...) The light of the lamps that give each point most, of (L, N, ...): `nice` lights no more at a time."""
    return np.sort(lit, axis=0)[-lights.LAMPS :].sum(0)


def _slope(light: Any, points: Any, normals: Any) -> tuple[Any, Any, Any]:
    """How much each point faces a light (N,), the way to it (N, 3) [m], and how far that is (N,) [m]."""
    way = light - points
    distance = np.linalg.norm(way, axis=1)
    return np.clip(np.einsum("na,na->n", way, normals) / distance, 0.0, 1.0), way, distance


def _cosine_directions(count: int) -> Any:
    """(count, 3) unit vectors about +z, evenly spread as a matt surface sees them."""
    k = np.arange(count) + 0.5
    radius, angle = np.sqrt(k / count), k * np.pi * (3.0 - 5.0**0.5)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1.0 - radius**2)], axis=1)
