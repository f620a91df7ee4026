"""Writes binary glTF files: meshes with any attributes, nodes, and pictures. Source: the glTF 2.0 specification."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
_COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
_VERTICES, _INDICES = 34962, 34963
_LISTS = ("nodes", "meshes", "accessors", "bufferViews", "materials", "textures", "images")


class GlbWriter:
    """A glTF file that is being put together; `file` makes it."""

    def __init__(self, generator: str) -> None:
        self._data = bytearray()
        self._document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": generator},
            "extensionsUsed": ["KHR_materials_unlit", "KHR_mesh_quantization"],
            "extensionsRequired": ["KHR_mesh_quantization"],
            "scene": 0,
            "scenes": [{"nodes": []}],
            **{name: [] for name in _LISTS},
        }

    def material(self, **given: Any) -> int:
        """The number of a new material."""
        return self._add("materials", given)

    def texture(self, data: bytes, kind: str, name: str) -> int:
        """The number of a new texture, whose picture is the bytes of a file of a media type such as "image/jpeg"."""
        picture = self._add("images", {"bufferView": self._view(data), "mimeType": kind, "name": name})
        return self._add("textures", {"source": picture})

    def primitive(self, faces: Any, attributes: Mapping[str, tuple[Any, bool]], material: int) -> dict[str, Any]:
        """A primitive of a mesh.

        Args:
            faces: (F, 3) indices. attributes: by name, an array (V, n) and whether its integers are normalized.
        """
        kind = "u2" if faces.max(initial=0) < 65536 else "u4"
        return {
            "indices": self._accessor(np.ascontiguousarray(faces.ravel(), kind), False, _INDICES),
            "attributes": {name: self._accessor(*given, _VERTICES) for name, given in attributes.items()},
            "material": material,
        }

    def mesh(self, primitives: Sequence[dict[str, Any]]) -> int:
        """The number of a new mesh."""
        return self._add("meshes", {"primitives": list(primitives)})

    def node(self, *, root: bool = False, **given: Any) -> int:
        """The number of a new node; ``root`` puts it into the scene."""
        number = self._add("nodes", given)
        if root:
            self._document["scenes"][0]["nodes"].append(number)
        return number

    def extras(self, values: Mapping[str, Any]) -> None:
        """Add values of our own to the scene."""
        self._document["scenes"][0]["extras"] = dict(values)

    def file(self) -> bytes:
        """The file."""
        document = {name: value for name, value in self._document.items() if value != []}
        document["buffers"] = [{"byteLength": len(self._data)}]
        text = json.dumps(document, separators=(",", ":"), sort_keys=True).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self._data) + b"\0" * (-len(self._data) % 4)
        length = 12 + 8 + len(text) + 8 + len(data)
        parts = (struct.pack("<4sII", b"glTF", 2, length), struct.pack("<I4s", len(text), b"JSON"), text)
        return b"".join((*parts, struct.pack("<I4s", len(data), b"BIN\0"), data))

    def _accessor(self, values: Any, normalized: bool, target: int) -> int:
        kind = values.dtype.str[1:]
        width = values.shape[1] if values.ndim == 2 else 1
        stride = values.dtype.itemsize * width
        padded = values
        if target == _VERTICES and stride % 4:  # every vertex begins at a multiple of four bytes
            spare = (-stride % 4) // values.dtype.itemsize
            padded = np.concatenate([values, np.zeros((len(values), spare), values.dtype)], axis=1)
        view = self._view(padded.tobytes(), target, stride + (-stride % 4) if target == _VERTICES else 0)
        accessor: dict[str, Any] = {
            "bufferView": view,
            "componentType": _COMPONENTS[kind],
            "count": len(values),
            "type": _TYPES[width],
        }
        if normalized:
            accessor["normalized"] = True
        if width == 3 and target == _VERTICES:
            accessor["min"], accessor["max"] = values.min(0).tolist(), values.max(0).tolist()
        return self._add("accessors", accessor)

    def _view(self, data: bytes, target: int = 0, stride: int = 0) -> int:
        self._data += b"\0" * (-len(self._data) % 4)
        view = {"buffer": 0, "byteOffset": len(self._data), "byteLength": len(data)}
        if target:
            view["target"] = target
        if stride:
            view["byteStride"] = stride
        self._data += data
        return self._add("bufferViews", view)

    def _add(self, kind: str, value: dict[str, Any]) -> int:
        self._document[kind].append(value)
        return len(self._document[kind]) - 1
