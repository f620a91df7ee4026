"""The house of a trial as a glTF file, with the light of its lamps in the colours of its corners.

What never moves is one node, whose primitives are merged by texture; ceilings and their lamps, which hide rooms from
above, are another. Each part that moves (a thing, a door, a body or a head) is a node of its own, called by its number,
as `SceneParts.poses` counts them; it has the colours of its materials, and the page lights it by the grid of probes
that the scene's ``extras`` hold. Doors and drawers, which are ``lit``, have the light that they have while they are
shut.
"""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hthor import installation
from hthor.live.gltf import hidden_corners
from hthor.live.gltf.glb import GlbWriter
from hthor.live.gltf.kept_file import kept_file
from hthor.live.gltf.lit_house import digest, lit_house
from hthor.live.gltf.surfaces import Surface
from hthor.live.pictures import to_jpeg
from hthor.world.rendering.scene.baked_light import BakedLight

if TYPE_CHECKING:
    from hthor.types import HouseSpec
    from hthor.world.rendering.scene.scene_parts import SceneParts

_TEXTURE_PX = 256
"""[pixels] Side of the textures. Our choice: a person looks from half a metre at the least."""
_JPEG_QUALITY = 85
_HALF = 0.5
"""Colours are stored times this, as light may be brighter than 1."""


class HouseFile(NamedTuple):
    """A glTF file, compressed by gzip; ``key`` is the hash of what it was made from, hthor's code included."""

    key: str
    data: bytes


def house_file(scene: SceneParts, house: HouseSpec, folder: Path | None = None) -> HouseFile:
    """The file of a house and of everything in it; computed once, and then read from hthor's cache.

    Args:
        folder: where files are kept; by default in the cache.
    """
    folder = folder or installation.cache() / "live"
    key = digest(scene.parts, scene.assets, scene.lamps.places)
    data = kept_file(folder / f"{key}.glb.gz", lambda: gzip.compress(_make(scene, house, folder), 6, mtime=0))
    return HouseFile(key, data)


def _make(scene: SceneParts, house: HouseSpec, folder: Path) -> bytes:
    lit = lit_house(scene, house, folder)
    file = GlbWriter("hthor")
    book = _Materials(file, scene)
    nodes = [file.node(name="still", mesh=_mesh(file, book, lit.low))]
    if lit.high:
        nodes.append(file.node(name="ceilings", mesh=_mesh(file, book, lit.high), extras={"ceiling": True}))
    doors = dict(zip(scene.hung, lit.doors, strict=True))
    for number in range(len(scene.moving)):
        parts = doors.get(number) or _creased(_parts(scene, number))
        if parts:
            about = {"owner": parts[0].owner, "part": number, "lit": number in doors}
            nodes.append(file.node(name=str(number), mesh=_mesh(file, book, parts), extras=about))
    turned = file.node(root=True, name="house", children=nodes, rotation=[-(0.5**0.5), 0.0, 0.0, 0.5**0.5])
    file.extras(
        {
            "house": turned,
            "moving": list(scene.moving),
            "probes": {
                "origin": [round(value, 3) for value in lit.probes.origin],
                "side": lit.probes.side,
                "light": [[round(value, 2) for value in row] for row in lit.probes.light.tolist()],
            },
        }
    )
    return file.file()


def _parts(scene: SceneParts, number: int) -> list[Surface]:
    return [Surface.of(part) for part in scene.parts if part.puppet == number]


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
