"""Reads Wavefront OBJ and MTL files: triangles by material, in the model's own frame."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

Corner = tuple[int, int, int]
"""Indices of a corner's vertex, texture coordinate and normal; -1 if the corner has none."""


class Paint(NamedTuple):
    """A material: color and opacity 0 to 1, name of its picture (empty if it has none), specular 0 to 1."""

    rgba: tuple[float, float, float, float] = (0.7, 0.7, 0.7, 1.0)
    picture: str = ""
    specular: float = 0.1


class Group(NamedTuple):
    """Triangles of one material: ``vertices`` (V, 3), ``uv`` (V, 2), ``normals`` (V, 3) or None, ``faces`` (F, 3)."""

    paint: Paint
    vertices: Any
    uv: Any
    normals: Any
    faces: Any


def read_obj(text: str, materials: Callable[[str], str]) -> list[Group]:
    """The groups of an OBJ file, one per material, in order of appearance; equal corners share one vertex.

    Args:
        materials: returns the text of an MTL file by its name.

    Raises:
        ValueError: if a line is not understood; names the line.
    """
    data: dict[str, list[list[float]]] = {"v": [], "vt": [], "vn": []}
    paints: dict[str, Paint] = {}
    groups: dict[str, list[tuple[Corner, Corner, Corner]]] = {}
    current = ""
    for number, line in enumerate(text.splitlines(), 1):
        word, _, rest = line.strip().partition(" ")
        try:
            if word in data:
                data[word].append([float(value) for value in rest.split()[: 2 if word == "vt" else 3]])
            elif word == "f":
                corners = [_corner(entry, data) for entry in rest.split()]
                fan = [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
                groups.setdefault(current, []).extend(fan)
            elif word == "usemtl":
                current = rest.strip()
            elif word == "mtllib":
                paints |= read_paints(materials(rest.strip()))
        except (ValueError, IndexError) as error:
            raise ValueError(f"line {number}, '{line.strip()[:40]}': {error}") from None
    widths = {"v": 3, "vt": 2, "vn": 3}
    arrays = {name: np.array(rows, float).reshape(-1, widths[name]) for name, rows in data.items()}
    made = [_group(paints.get(name, Paint()), triangles, arrays) for name, triangles in groups.items()]
    return [group for group in made if len(group.faces)]


def _corner(entry: str, data: dict[str, list[list[float]]]) -> Corner:
    fields = (*entry.split("/"), "", "")[:3]
    indices = []
    for field, name in zip(fields, ("v", "vt", "vn"), strict=True):
        index = int(field) if field else 0
        count = len(data[name])
        index = index - 1 if index > 0 else count + index if index < 0 else -1
        if index >= count or (field and index < 0):
            raise IndexError(f"{name} {field} is not there")
        indices.append(index)
    if indices[0] < 0:
        raise ValueError("a corner without a vertex")
    return indices[0], indices[1], indices[2]


def _group(paint: Paint, triangles: list[tuple[Corner, Corner, Corner]], data: dict[str, Any]) -> Group:
    corners = np.array(triangles, int).reshape(-1, 3)
    unique, faces = np.unique(corners, axis=0, return_inverse=True)
    faces = faces.reshape(-1, 3)
    vertices = data["v"][unique[:, 0]]
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    faces = faces[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 0.0]
    uv = np.zeros((len(unique), 2))
    mapped = unique[:, 1] >= 0
    uv[mapped] = data["vt"][unique[mapped, 1]]
    normals = data["vn"][unique[:, 2]] if len(data["vn"]) and (unique[:, 2] >= 0).all() else None
    return Group(paint, vertices, uv, normals, faces)


def read_paints(text: str) -> dict[str, Paint]:
    """The materials of an MTL file by name."""
    paints: dict[str, Paint] = {}
    name = ""
    for line in text.splitlines():
        word, _, rest = line.strip().partition(" ")
        rest = rest.strip()
        if word == "newmtl":
            name = rest
            paints[name] = Paint()
        elif name and word == "Kd":
            red, green, blue = (float(value) for value in rest.split()[:3])
            paints[name] = paints[name]._replace(rgba=(red, green, blue, paints[name].rgba[3]))
        elif name and word == "Ks":
            paints[name] = paints[name]._replace(specular=float(np.mean([float(v) for v in rest.split()[:3]])))
        elif name and word in ("d", "Tr"):
            given = float(rest.split()[-1])
            opacity = given if word == "d" else 1.0 - given
            paints[name] = paints[name]._replace(rgba=(*paints[name].rgba[:3], opacity))
        elif name and word == "map_Kd":
            paints[name] = paints[name]._replace(picture=rest.replace("\\", "/"))
    return paints
