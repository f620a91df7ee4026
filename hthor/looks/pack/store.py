"""Where packs are stored, what they contain, and how to read them.

A pack is a folder: ``pack.json``, ``meshes.npz``, ``textures/*.jpg``, ``LICENCES.md``, and ``ATTRIBUTION.md`` if a
licence requires it. Its hash is that of ``pack.json``, which contains the hashes of all other files.
"""

import functools
import hashlib
import os
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import documents
from hthor.errors import HthorError, UnknownName
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.looks.pack import fitting
from hthor.types import Rgba, Vec3

SCHEMA = "hthor.pack/1"
LIST = "pack.json"
MESHES = "meshes.npz"
TEXTURES = "textures"
RESERVED = "procedural"
"""The name of the furniture that is part of hthor."""


class PackError(HthorError):
    """A pack cannot be used or made; names the file and the problem."""


class Surface(Struct, frozen=True, kw_only=True):
    """The material of one part of a model; ``texture`` is a file in ``textures``, empty for a plain color."""

    rgba: Rgba
    texture: str = ""
    specular: float = 0.1
    shininess: float = 0.2


class Model(Struct, frozen=True, kw_only=True):
    """One model of a pack and its author.

    ``size`` [m] is (width, depth, height) in hthor's local frame, front towards +y. ``rests`` are the level places for
    objects, lowest first. ``parts`` are the materials of its meshes in ``meshes.npz``, in order.
    """

    kind: str
    name: str
    source: str
    title: str
    author: str
    licence: str
    size: Vec3
    rests: tuple[fitting.Rest, ...] = ()
    parts: tuple[Surface, ...]


class Contents(Struct, frozen=True, kw_only=True):
    """The content of ``pack.json``. ``files`` maps the name of every other file to the hash of its content."""

    schema: str = SCHEMA
    name: str
    source: str
    licences: tuple[str, ...]
    models: tuple[Model, ...]
    files: dict[str, str]


class Pack:
    """A pack that is ready for drawing.

    Attributes:
        name, folder: of the pack. sha256: hash of its content. contents: its ``pack.json``.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        data = _read(folder / LIST)
        self.sha256 = hashlib.sha256(data).hexdigest()
        hint = "build the pack again: hthor assets build"
        self.contents = documents.parse(data, Contents, PackError, shown=str(folder / LIST), schema=SCHEMA, hint=hint)
        self.name = self.contents.name
        self._models: dict[str, list[Model]] = {}
        for model in self.contents.models:
            self._models.setdefault(model.kind, []).append(model)

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds for which the pack has a model, in alphabetical order."""
        return tuple(sorted(self._models))

    def look(self, kind: str, size: Vec3, variant: int = 0) -> tuple[Piece, ...] | None:
        """A thing's pieces, like those of `hthor.looks.look`; None if the pack has no model for this kind or size.

        The model is stretched to ``size`` [m], with its resting places at the heights of the kind's own surfaces.
        """
        models = [model for model in self._models.get(kind, ()) if fitting.fits(model.size, size)]
        ways = [(model, way) for model in models if (way := fitting.stretch(kind, model.size, model.rests, size))]
        if not ways:
            return None
        model, way = ways[variant % len(ways)]
        meshes = [_stretched(mesh, way) for mesh in self._meshes(model)]
        return tuple(Piece(mesh, _material(part)) for mesh, part in zip(meshes, model.parts, strict=True))

    def texture(self, name: str) -> Any:
        """(H, W, 3) uint8, its first row at v = 0."""
        import cv2

        path = self.folder / TEXTURES / name
        image = cv2.imdecode(np.frombuffer(self._checked(f"{TEXTURES}/{name}"), np.uint8), cv2.IMREAD_COLOR)
        if image is None:
            raise PackError(f"{path} is not a picture. Build the pack again: hthor assets build.")
        return np.ascontiguousarray(image[..., ::-1])

    def check(self) -> None:
        """Check that every file exists and has not changed since it was written.

        Raises:
            PackError: names the first file that is missing or was changed.
        """
        for name in self.contents.files:
            self._checked(name)

    def _checked(self, name: str) -> bytes:
        data = _read(self.folder / name)
        if hashlib.sha256(data).hexdigest() != self.contents.files.get(name):
            raise PackError(
                f"{self.folder / name} was changed after it was built. Build the pack again: hthor assets build."
            )
        return data

    @functools.cached_property
    def _archive(self) -> dict[str, Any]:
        import io

        with np.load(io.BytesIO(self._checked(MESHES)), allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}

    def _meshes(self, model: Model) -> list[Mesh]:
        every = []
        for part in range(len(model.parts)):
            fields = (self._archive[f"{model.kind}/{model.name}/{part}/{field}"] for field in Mesh._fields)
            every.append(Mesh(*fields))
        return every


def _material(part: Surface) -> Material:
    return Material(rgba=part.rgba, texture=part.texture, specular=part.specular, shininess=part.shininess)


def _stretched(mesh: Mesh, stretch: fitting.Stretch) -> Mesh:
    vertices, slopes = stretch.apply(mesh.vertices)
    normals = mesh.normals / slopes
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    return mesh._replace(vertices=np.asarray(vertices, np.float32), normals=np.asarray(normals, np.float32))


# ------------------------------------------------------------------------------------------------------------ the cache


def home() -> Path:
    """The folder of all packs, in the user's cache folder."""
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(cache) / "hthor" / "packs"


def tidy(name: str) -> str:
    """Check that a name can be used for a folder and in an option; return the name.

    Raises:
        PackError: if it cannot.
    """
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,59}", name) or name == RESERVED:
        raise PackError(f"'{name}' cannot be a pack's name; use letters, digits, '-', '_', '.', but not '{RESERVED}'.")
    return name


def overwritable(folder: Path) -> None:
    """Check that a pack may be written to a folder: it must be absent, empty, or a pack.

    Raises:
        PackError: if it contains something else.
    """
    if folder.exists() and not (folder / LIST).is_file() and (folder.is_file() or any(folder.iterdir())):
        raise PackError(f"{folder} exists and is not a furniture pack. Choose another folder with --out.")


def installed() -> tuple[str, ...]:
    """The names of the packs in the user's cache."""
    return tuple(sorted(path.parent.name for path in home().glob(f"*/{LIST}")))


def find(name: str) -> Path:
    """The folder of a pack, given its name or the folder itself.

    Raises:
        UnknownName: if there is no such pack.
    """
    for folder in (home() / name, Path(name)):
        if (folder / LIST).is_file():
            return folder
    raise UnknownName("furniture pack", name, installed(), "Build one: hthor assets build.")


def load(name: str) -> Pack:
    """The pack with this name, or in this folder.

    Raises:
        UnknownName: if there is no such pack.
        PackError: if the pack cannot be read.
    """
    return Pack(find(name))


def remove(name: str) -> Path:
    """Delete a pack from the user's cache; return its former folder.

    Raises:
        UnknownName: if there is no such pack.
    """
    if name not in installed():
        raise UnknownName("furniture pack", name, installed(), "'hthor assets list' shows what there is.")
    folder = home() / name
    shutil.rmtree(folder)
    return folder


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise PackError(f"{path} is missing. Build the pack again: hthor assets build.") from None
