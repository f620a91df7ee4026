"""Makes a pack from the library: picks models, converts them, checks them, and writes the pack."""

import hashlib
import io
import os
import shutil
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

import numpy as np

from hthor import catalog, jsonio
from hthor.looks.meshes.mesh import Mesh
from hthor.looks.pack import fitting, obj, shape, thinning
from hthor.looks.pack.library import Entry, Library
from hthor.looks.pack.picks import FREE, LICENCES, PICKS, Pick
from hthor.looks.pack.store import LIST, MESHES, SCHEMA, TEXTURES, Contents, Model, Pack, PackError, Surface

TRIANGLES = 4000
"""Triangles that are kept of one model at most, approximately."""
PIXELS = 512
_QUALITY = 85
_CLEAR = 0.02
"""A picture whose transparent share is larger than this needs cut-outs, which are not supported."""
_SOFT = ("bed", "sofa", "armchair", "chair")


class ModelSkipped(NamedTuple):
    """A model that is not in the pack, and the reason."""

    pick: Pick
    reason: str


class ConvertedModel(NamedTuple):
    """The result of a conversion."""

    pack: Pack
    skipped: tuple[ModelSkipped, ...]


class _Piece(NamedTuple):
    model: Model
    meshes: list[Mesh]
    pictures: dict[str, bytes]


def convert_models(
    files: Mapping[str, bytes],
    source: str,
    folder: Path,
    name: str,
    *,
    cc_by: bool,
    picks: Iterable[Pick] | None = None,
) -> ConvertedModel:
    """Write a pack into ``folder``; an earlier pack in it is replaced.

    Args:
        files: the libraries by name. source: where they came from, in words. cc_by: whether to use models that require
        attribution too. picks: which models to use, `PICKS` by default.

    Raises:
        PackError: if a needed library is missing or broken, or no model could be used.
    """
    wanted = [pick for pick in (PICKS if picks is None else picks) if cc_by or LICENCES[pick.library][0] == FREE]
    needed = sorted({pick.library for pick in wanted})
    for library in needed:
        if library not in files:
            raise PackError(f"{source} has no library '{library}'; it has: {', '.join(sorted(files)) or 'none'}.")
    libraries = {library: Library(library, files[library]) for library in needed}
    taken: list[_Piece] = []
    skipped: list[ModelSkipped] = []
    for pick in wanted:
        try:
            taken.append(_take(libraries[pick.library], pick))
        except ValueError as error:
            skipped.append(ModelSkipped(pick, str(error)))
    if not taken:
        raise PackError(f"no model of {source} could be used; the first: {skipped[0].reason if skipped else 'none'}.")
    _write(taken, source, folder, name)
    return ConvertedModel(Pack(folder), tuple(skipped))


# ------------------------------------------------------------------------------------------------------------ one model


def _take(library: Library, pick: Pick) -> _Piece:
    if fitting.opens(pick.kind):
        raise ValueError(f"a {pick.kind} opens, which no model of a pack can do")
    entry = library.entry(pick.model)
    groups, size = shape.place_shape(_read(library, entry), entry.size, entry.rotation, pick.turns)
    own = catalog.kind(pick.kind).size
    if not fitting.fits(size, own):
        raise ValueError(f"{_metres(size)} is too far from {_metres(own)}")
    groups = thinning.decimate(groups, TRIANGLES)
    meshes = [shape.mesh(group) for group in groups]
    places = fitting.supports(pick.kind)
    rests = shape.find_surfaces(meshes, size, places, own, soft=pick.kind in _SOFT)
    pictures: dict[str, bytes] = {}
    if fitting.stretch(pick.kind, size, rests, own) is None:
        raise ValueError("its surface for objects would have to be moved too far")
    parts = tuple(_surface(library, entry, group.paint, pictures) for group in groups)
    licence = LICENCES[pick.library][0]
    model = Model(
        kind=pick.kind,
        name=f"{pick.library}-{pick.model}",
        source=f"{pick.library}/{entry.path}",
        title=entry.title,
        author=entry.author,
        licence=licence,
        size=(round(size[0], 4), round(size[1], 4), round(size[2], 4)),
        rests=rests,
        parts=parts,
    )
    return _Piece(model, meshes, pictures)


def _read(library: Library, entry: Entry) -> list[obj.Group]:
    beside = PurePosixPath(entry.path).parent

    def materials(name: str) -> str:
        path = str(beside / name)
        return library.read(path).decode("latin-1") if library.has(path) else ""

    try:
        groups = obj.read_obj(library.read(entry.path).decode("latin-1"), materials)
    except ValueError as error:
        raise PackError(f"library '{library.name}': {entry.path}: {error}") from None
    if not groups:
        raise PackError(f"library '{library.name}': {entry.path} has no faces.")
    return [group for group in groups if group.paint.rgba[3] > _CLEAR]


def _surface(library: Library, entry: Entry, paint: obj.Paint, pictures: dict[str, bytes]) -> Surface:
    rgba = tuple(round(min(1.0, max(0.0, value)), 4) for value in paint.rgba)
    specular = round(min(0.6, max(0.02, paint.specular)), 4)
    path = str(PurePosixPath(entry.path).parent / paint.picture)
    if not paint.picture or not library.has(path):
        return Surface(rgba=(rgba[0], rgba[1], rgba[2], rgba[3]), specular=specular)
    name = f"{library.name}-{entry.model}-{PurePosixPath(paint.picture).stem}.jpg".replace(" ", "_")
    pictures[name] = _picture(library.read(path), paint.picture)
    return Surface(rgba=(1.0, 1.0, 1.0, rgba[3]), texture=name, specular=specular)


def _picture(data: bytes, name: str) -> bytes:
    """The picture as JPEG, with sides of at most `PIXELS`."""
    import cv2

    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise ValueError(f"{name} is not a picture")
    if image.ndim == 3 and image.shape[2] == 4:
        if float(np.mean(image[..., 3] < 128)) > _CLEAR:
            raise ValueError(f"{name} has see-through parts")
        image = image[..., :3]
    if image.ndim == 2:
        image = np.repeat(image[..., None], 3, axis=2)
    longest = max(image.shape[:2])
    if longest > PIXELS:
        width, height = (max(1, round(side * PIXELS / longest)) for side in (image.shape[1], image.shape[0]))
        image = cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA)
    _, coded = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    return bytes(coded.tobytes())


def _metres(size: Any) -> str:
    return " x ".join(f"{length:.2f}" for length in size) + " m"


# ------------------------------------------------------------------------------------------------------------- the pack


def _write(taken: list[_Piece], source: str, folder: Path, name: str) -> None:
    content: dict[str, bytes] = {MESHES: _archive(taken), "LICENCES.md": _licences(taken).encode()}
    if any(piece.model.licence != FREE for piece in taken):
        content["ATTRIBUTION.md"] = _attribution(taken).encode()
    for piece in taken:
        content |= {f"{TEXTURES}/{picture}": data for picture, data in piece.pictures.items()}
    contents = Contents(
        schema=SCHEMA,
        name=name,
        source=source,
        licences=tuple(sorted({piece.model.licence for piece in taken})),
        models=tuple(piece.model for piece in taken),
        files={file: hashlib.sha256(data).hexdigest() for file, data in sorted(content.items())},
    )
    folder.parent.mkdir(parents=True, exist_ok=True)
    fresh = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        (fresh / TEXTURES).mkdir()
        for file, data in content.items():
            (fresh / file).write_bytes(data)
        jsonio.write(fresh / LIST, jsonio.pretty(contents))
        fresh.chmod(0o755)
        if folder.exists():
            shutil.rmtree(folder)
        os.replace(fresh, folder)
    finally:
        shutil.rmtree(fresh, ignore_errors=True)


def _archive(taken: list[_Piece]) -> bytes:
    """All meshes as an npz whose bytes depend only on the meshes; 16-bit vertices would save little."""
    arrays = {
        f"{piece.model.kind}/{piece.model.name}/{part}/{field}": getattr(mesh, field)
        for piece in taken
        for part, mesh in enumerate(piece.meshes)
        for field in Mesh._fields
    }
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def _licences(taken: list[_Piece]) -> str:
    rows = [
        f"| {m.kind} | {m.title} | {m.author} | {m.licence} | {m.source} |" for m in (piece.model for piece in taken)
    ]
    head = ["# Licences of the models in this pack", "", "| kind | model | author | licence | source |"]
    return "\n".join([*head, "|---|---|---|---|---|", *rows, ""])


def _attribution(taken: list[_Piece]) -> str:
    """The text that must be shown with any picture of the pack."""
    lines = ["# Attribution", "", "Pictures that show this pack contain these models, changed in size and detail:", ""]
    addresses = dict(LICENCES.values())
    for model in (piece.model for piece in taken):
        if model.licence != FREE:
            address = addresses[model.licence]
            lines.append(f'- "{model.title}" by {model.author}, {model.licence} ({address}), from {model.source}')
    return "\n".join([*lines, ""])
