"""A house with the light of its lamps, computed once for all tasks in it, as it takes about ten seconds.

What a task places throws no shadows on the house, so the house's light does not depend on it.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hthor import installation
from hthor.live.gltf import still_light
from hthor.live.gltf.kept_file import kept_file
from hthor.live.gltf.surfaces import Surface
from hthor.world.rendering.scene.baked_light import BakedLight, Probes
from hthor.world.rendering.scene.scene_mesh import ABOVE
from hthor.world.rendering.scene.scene_parts import STATIC

if TYPE_CHECKING:
    from hthor.types import HouseSpec
    from hthor.world.rendering.scene.scene_parts import ScenePart, SceneParts

_EDGE_M, _FLOOR_EDGE_M = 0.6, 0.45
"""[m] No edge of a mesh, or of a floor, is longer, as light is computed at corners only. Our choice: finer would
give the largest of our houses more than 250,000 triangles.
"""
_MOST_TRIANGLES = 246_000
"""[count] About so many triangles are drawn at the most, without those of one's own body. Our choice."""
_MORE_ON_DOORS = 6000
"""[count] So many of these are added to doors and drawers at the most. Our choice."""
_STEP = 20_000
"""[count] The most triangles of a house are a multiple of this, so that what a task places seldom changes them."""
_FLOOR, _CEILING = "floor of", "ceiling of"
"""What the owners of floors begin with, and those of ceilings and their lamps, which hide no light."""


class LitHouse(NamedTuple):
    """What a house looks like in its light.

    Attributes:
        low, high: what never moves, and of that the ceilings with their lamps.
        doors: the doors and drawers in the order of `SceneParts.hung`, each in its own frame.
        probes: the light in the rooms, for what moves.
    """

    low: list[Surface]
    high: list[Surface]
    doors: list[list[Surface]]
    probes: Probes


def lit_house(scene: SceneParts, house: HouseSpec, folder: Path) -> LitHouse:
    """The house of a scene in its light.

    Args:
        folder: where it is kept.
    """
    own = next(iter(scene.seats.values()), ())
    moving = sum(len(part.mesh.faces) for part in scene.parts if part.puppet not in (STATIC, *own))
    most = (_MOST_TRIANGLES - _MORE_ON_DOORS - moving) // _STEP * _STEP
    path = folder / f"{_key(scene, most)}.light.npz"
    return _unpacked(kept_file(path, lambda: _packed(_make(scene, house, most))))


def digest(parts: Sequence[ScenePart], *about: object) -> str:
    """Hash of parts of a scene, of what else matters, and of hthor's code."""
    found = hashlib.sha256(repr((installation.sha256(), *about)).encode())
    for part in parts:
        found.update(repr((part.puppet, part.owner, part.material, part.group)).encode())
        for values in part.mesh:
            found.update(np.ascontiguousarray(values).tobytes())
    return found.hexdigest()[:32]


def _key(scene: SceneParts, most: int) -> str:
    """Hash of everything that the light depends on; doors have other numbers where a task places other things."""
    still = [part for part in scene.parts if part.puppet == STATIC]
    order = {number: place for place, number in enumerate(scene.hung)}
    doors = [part._replace(puppet=order[part.puppet]) for part in scene.parts if part.puppet in order]
    frames = [[values.tolist() for values in frame] for frame in scene.hung.values()]
    return digest([*still, *doors], scene.assets, scene.lamps.places, frames, most)


def _make(scene: SceneParts, house: HouseSpec, most: int) -> LitHouse:
    still = [Surface.of(part) for part in scene.parts if part.puppet == STATIC and part.group != ABOVE]
    hides = [one.corners for one in still if one.opaque and not one.owner.startswith(_CEILING)]
    light = BakedLight(np.concatenate(hides), scene.lamps.places, house.height)
    still = [one.refined(_FLOOR_EDGE_M if one.owner.startswith(_FLOOR) else _EDGE_M) for one in still]
    shown = still_light.lit(still, light, most)
    xs, ys = zip(*(point for room in house.rooms for point in room.polygon), strict=True)
    return LitHouse(
        low=[one for one in shown if not one.owner.startswith(_CEILING)],
        high=[one for one in shown if one.owner.startswith(_CEILING)],
        doors=_doors(scene, light),
        probes=light.probes((min(xs), min(ys), max(xs), max(ys))),
    )


def _doors(scene: SceneParts, light: BakedLight) -> list[list[Surface]]:
    """Doors and drawers with the light that they have while they are shut."""
    places, shut = [], []
    for place, (number, frame) in enumerate(scene.hung.items()):
        for part in scene.parts:
            if part.puppet == number:
                places.append(place)
                shut.append(Surface.of(part).moved(*frame))
    found: list[list[Surface]] = [[] for _ in scene.hung]
    if shut:
        frames = list(scene.hung.values())
        most = sum(len(one.faces) for one in shut) + _MORE_ON_DOORS
        for place, one in zip(places, still_light.lit(shut, light, most, whole=True), strict=True):
            found[place].append(one.moved_back(*frames[place]))
    return found


_LOW, _HIGH = -2, -1
"""The places of what never moves; doors have theirs in their order."""


def _packed(house: LitHouse) -> bytes:
    """A lit house as a file of arrays in single precision; the surfaces are one after another in them."""
    heaps = [(_LOW, house.low), (_HIGH, house.high), *enumerate(house.doors)]
    every = [(place, one) for place, heap in heaps for one in heap]
    file = io.BytesIO()
    np.savez_compressed(
        file,
        names=np.array([(one.owner, one.texture) for _, one in every]),
        places=np.array([(place, len(one.vertices), len(one.faces)) for place, one in every]),
        looks=np.array([(*one.tint, one.alpha, one.emission) for _, one in every]),
        corners=np.concatenate(
            [np.concatenate([one.vertices, one.normals, one.uv, one.colours], axis=1) for _, one in every]
        ).astype(np.float32),
        faces=np.concatenate([one.faces for _, one in every]).astype(np.int32),
        probes=house.probes.light,
        grid=np.array((*house.probes.origin, house.probes.side)),
        doors=len(house.doors),
    )
    return file.getvalue()


def _unpacked(data: bytes) -> LitHouse:
    """The inverse of `_packed`."""
    with np.load(io.BytesIO(data)) as file:
        kept = dict(file)
    found: dict[int, list[Surface]] = {place: [] for place in range(_LOW, int(kept["doors"]))}
    corner = face = 0
    for (owner, texture), (place, corners, faces), look in zip(
        kept["names"].tolist(), kept["places"].tolist(), kept["looks"], strict=True
    ):
        rows = kept["corners"][corner : corner + corners]
        found[place].append(
            Surface(
                owner=owner,
                texture=texture,
                tint=look[:3],
                alpha=float(look[3]),
                emission=float(look[4]),
                vertices=rows[:, :3],
                normals=rows[:, 3:6],
                uv=rows[:, 6:8],
                faces=kept["faces"][face : face + faces],
                colours=rows[:, 8:],
            )
        )
        corner, face = corner + corners, face + faces
    low, high, *doors = found.values()
    x, y, side = kept["grid"].tolist()
    return LitHouse(low, high, doors, Probes((x, y), side, kept["probes"]))
