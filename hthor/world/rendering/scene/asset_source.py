"""Where looks and textures come from: an optional pack first, then our own."""

from typing import Any, Protocol

import msgspec
import numpy as np

from hthor import looks
from hthor.looks import Piece
from hthor.types import Vec3


class Pack(Protocol):
    """A furniture pack. Names of its textures are its own; a piece of it names no other."""

    name: str
    sha256: str

    def look(self, kind: str, size: Vec3, variant: int) -> tuple[Piece, ...] | None:
        """A thing's pieces as `hthor.looks.look` gives them, None for what the pack has not."""
        ...

    def texture(self, name: str) -> Any:
        """(H, W, 3) uint8."""
        ...


class AssetSource:
    """Looks of things, with the pack's before ours.

    A texture of the pack is called ``pack:NAME`` from here on, so that the two can share names.
    """

    def __init__(self, pack: Pack | None = None) -> None:
        self._pack = pack

    def look(self, kind: str, size: Vec3, variant: int) -> tuple[Piece, ...]:
        """The pieces of a thing, see `hthor.looks.look`."""
        pieces = None if self._pack is None else self._pack.look(kind, size, variant)
        if pieces is None:
            return looks.look(kind, size, variant)
        return tuple(_marked(piece) for piece in pieces)

    def texture(self, name: str) -> Any:
        """(H, W, 3) uint8, its first row at v = 0."""
        if name.startswith("pack:") and self._pack is not None:
            return np.asarray(self._pack.texture(name.removeprefix("pack:")), np.uint8)
        return looks.textures.image(name)


def _marked(piece: Piece) -> Piece:
    material = piece.material
    if not material.texture:
        return piece
    return piece._replace(material=msgspec.structs.replace(material, texture=f"pack:{material.texture}"))
