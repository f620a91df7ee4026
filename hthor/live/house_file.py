"""The house of a trial as a glTF file, with the light of its lamps in the colours of its corners.

What never moves is one node, whose primitives are merged by texture; ceilings and their lamps, which hide rooms from
above, are another. Each part that moves (a thing, a door, a body or a head) is a node of its own, called by its number,
as `SceneParts.poses` counts them; it has the colours of its materials, and the page lights it by the grid of probes
that the scene's ``extras`` hold. Doors and drawers, which are ``lit``, have the light that they have while they are
shut.
"""

from __future__ import annotations

import gzip
import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hthor import installation, jsonio
from hthor.live import hidden_corners, still_light
from hthor.live.glb import GlbWriter
from hthor.live.pictures import to_jpeg
from hthor.live.surfaces import Surface
from hthor.world.rendering.scene.baked_light import BakedLight
from hthor.world.rendering.scene.scene_mesh import ABOVE
from hthor.world.rendering.scene.scene_parts import STATIC

if TYPE_CHECKING:
    from hthor.types import HouseSpec
    from hthor.world.rendering.scene.scene_parts import SceneParts

_EDGE_M, _FLOOR_EDGE_M = 0.6, 0.45
"""[m] No edge of a mesh, or of a floor, is longer, as light is computed at corners only. Our choice: finer would
give the largest of our houses more than 250,000 triangles.
"""
_MOST_TRIANGLES = 246_000
"""[count] About so many triangles are drawn at the most, without those of one's own body. Our choice."""
_MORE_ON_DOORS = 6000
"""[count] So many of these are added to doors and drawers at the most. Our choice."""
_TEXTURE_PX = 256
"""[pixels] Side of the textures. Our choice: a person looks from half a metre at the least."""
_JPEG_QUALITY = 85
_HALF = 0.5
"""Colours are stored times this, as light may be brighter than 1."""
_FLOOR, _CEILING = "floor of", "ceiling of"
"""What the owners of floors begin with, and those of ceilings and their lamps, which hide no light."""


class HouseFile(NamedTuple):
    """A glTF file, compressed by gzip; ``key`` is the hash of what it was made from, hthor's code included."""

    key: str
    data: bytes


def house_file(scene: SceneParts, house: HouseSpec, folder: Path | None = None) -> HouseFile:
    """The file of a house and of everything in it; computed once, and then read from hthor's cache.

    Args:
        folder: where files are kept; by default in the cache.
    """
    key = _key(scene)
    path = (folder or installation.cache() / "live") / f"{key}.glb.gz"
    if not path.exists():
        jsonio.write(path, gzip.compress(_make(scene, house), 6, mtime=0))
    return HouseFile(key, path.read_bytes())


def _key(scene: SceneParts) -> str:
    digest = hashlib.sha256(repr((installation.sha256(), scene.assets, scene.lamps.places)).encode())
    for part in scene.parts:
        digest.update(repr((part.puppet, part.owner, part.material, part.group)).encode())
        for values in part.mesh:
            digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()[:32]


def _make(scene: SceneParts, house: HouseSpec) -> bytes:
    still = [Surface.of(part) for part in scene.parts if part.puppet == STATIC and part.group != ABOVE]
    hides = [one.corners for one in still if one.opaque and not one.owner.startswith(_CEILING)]
    light = BakedLight(np.concatenate(hides), scene.lamps.places, house.height)
    own = next(iter(scene.seats.values()), ())
    file = GlbWriter("hthor")
    book = _Materials(file, scene)
    moving = sum(len(part.mesh.faces) for part in scene.parts if part.puppet not in (STATIC, *own))
    still = [one.refined(_FLOOR_EDGE_M if one.owner.startswith(_FLOOR) else _EDGE_M) for one in still]
    shown = still_light.lit(still, light, _MOST_TRIANGLES - _MORE_ON_DOORS - moving)
    high = [one for one in shown if one.owner.startswith(_CEILING)]
    low = [one for one in shown if not one.owner.startswith(_CEILING)]
    nodes = [file.node(name="still", mesh=_mesh(file, book, low))]
    if high:
        nodes.append(file.node(name="ceilings", mesh=_mesh(file, book, high), extras={"ceiling": True}))
    doors = _doors(scene, light)
    for number in range(len(scene.moving)):
        parts = doors.get(number) or _creased(_parts(scene, number))
        if parts:
            about = {"owner": parts[0].owner, "part": number, "lit": number in doors}
            nodes.append(file.node(name=str(number), mesh=_mesh(file, book, parts), extras=about))
    xs, ys = zip(*(point for room in house.rooms for point in room.polygon), strict=True)
    probes = light.probes((min(xs), min(ys), max(xs), max(ys)))
    turned = file.node(root=True, name="house", children=nodes, rotation=[-(0.5**0.5), 0.0, 0.0, 0.5**0.5])
    file.extras(
        {
            "house": turned,
            "moving": list(scene.moving),
            "probes": {
                "origin": [round(value, 3) for value in probes.origin],
                "side": probes.side,
                "light": [[round(value, 2) for value in row] for row in probes.light.tolist()],
            },
        }
    )
    return file.file()


def _parts(scene: SceneParts, number: int) -> list[Surface]:
    return [Surface.of(part) for part in scene.parts if part.puppet == number]


def _doors(scene: SceneParts, light: BakedLight) -> dict[int, list[Surface]]:
    """Doors and drawers with the light that they have while they are shut, by their numbers."""
    numbers, shut = [], []
    for number, frame in scene.hung.items():
        for one in _parts(scene, number):
            numbers.append(number)
            shut.append(one.moved(*frame))
    if not shut:
        return {}
    most = sum(len(one.faces) for one in shut) + _MORE_ON_DOORS
    found: dict[int, list[Surface]] = {}
    for number, one in zip(numbers, still_light.lit(shut, light, most, whole=True), strict=True):
        found.setdefault(number, []).append(one.moved_back(*scene.hung[number]))
    return found


def _creased(parts: list[Surface]) -> list[Surface]:
    """Parts that move together, with the shade that they throw on each other."""
    if not parts:
        return []
    light = BakedLight(np.concatenate([one.corners for one in parts]), {}, 0.0)
    found = []
    for one in parts:
        open_, hidden = light.openness(hidden_corners.inward(one.vertices, one.faces), one.normals)
        shade = hidden_corners.spread_light(open_, hidden, one.vertices, one.faces)
        found.append(one._replace(colours=one.tint * np.minimum(1.0 / _HALF, shade + one.emission)[:, None]))
    return found


class _Materials:
    """The materials of a file: one for each texture, and one for each kind of glass."""

    def __init__(self, file: GlbWriter, scene: SceneParts) -> None:
        self._file, self._scene = file, scene
        self._known: dict[tuple[str, float], int] = {}

    def number(self, texture: str, alpha: float) -> int:
        """The number of a material, which is made at its first use."""
        key = texture, alpha
        if key not in self._known:
            paint: dict[str, Any] = {"baseColorFactor": [1.0, 1.0, 1.0, alpha]}
            if texture:
                paint["baseColorTexture"] = {"index": self._file.texture(self._picture(texture), "image/jpeg", texture)}
            kind = {} if alpha == 1.0 else {"alphaMode": "BLEND"}
            self._known[key] = self._file.material(
                pbrMetallicRoughness=paint, extensions={"KHR_materials_unlit": {}}, **kind
            )
        return self._known[key]

    def _picture(self, texture: str) -> bytes:
        import cv2

        picture = np.asarray(self._scene.texture(texture))
        return to_jpeg(cv2.resize(picture, (_TEXTURE_PX, _TEXTURE_PX), interpolation=cv2.INTER_AREA), _JPEG_QUALITY)


def _mesh(file: GlbWriter, book: _Materials, surfaces: list[Surface]) -> int:
    """A mesh of surfaces, merged by texture."""
    heaps: dict[tuple[str, float], list[Surface]] = {}
    for one in surfaces:
        alpha = 1.0 if one.opaque else round(one.alpha, 3)
        heaps.setdefault((one.texture, alpha), []).append(one)
    primitives = []
    for key, heap in heaps.items():
        offsets = np.cumsum([0, *(len(one.vertices) for one in heap[:-1])])
        faces = np.concatenate([one.faces + offset for one, offset in zip(heap, offsets, strict=True)])
        attributes = {
            "POSITION": (_rounded(np.concatenate([one.vertices for one in heap])), False),
            "NORMAL": (_signed_bytes(np.concatenate([one.normals for one in heap])), True),
            "COLOR_0": (_bytes(_HALF * np.concatenate([one.colours for one in heap])), True),
        }
        if key[0]:
            attributes["TEXCOORD_0"] = (_rounded(np.concatenate([one.uv for one in heap])), False)
        primitives.append(file.primitive(faces, attributes, book.number(*key)))
    return file.mesh(primitives)


def _rounded(values: Any) -> Any:
    """Values to the nearest part of 8192, whose many zero bits make the file small."""
    return (np.round(values * 8192.0) / 8192.0).astype("f4")


def _bytes(values: Any) -> Any:
    return np.clip(np.round(values * 255.0), 0, 255).astype("u1")


def _signed_bytes(values: Any) -> Any:
    return np.clip(np.round(values * 127.0), -127, 127).astype("i1")
