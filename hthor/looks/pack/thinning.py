"""Reduces the triangles of detailed models, with their pictures kept in place."""

from typing import Any

import numpy as np

from hthor.errors import MissingExtra
from hthor.looks.pack.obj import Group

_SAME_M = 1e-5
_NEAR = 8
_FEWEST = 60


def decimate(groups: list[Group], most: int) -> list[Group]:
    """The groups, reduced in equal shares to about ``most`` triangles together; unchanged if they have fewer.

    Raises:
        MissingExtra: if this needs a library that is not installed.
    """
    total = sum(len(group.faces) for group in groups)
    if total <= most:
        return groups
    made = [_thinned(group, max(_FEWEST, round(len(group.faces) * most / total))) for group in groups]
    return [group for group in made if len(group.faces)]


def _thinned(group: Group, wanted: int) -> Group:
    if len(group.faces) <= wanted:
        return group
    try:
        import fast_simplification
    except ImportError:
        raise MissingExtra("thinning out detailed furniture", "assets") from None
    points, faces = _welded(group)
    if len(faces) <= wanted:
        return group._replace(faces=group.faces, normals=None)
    kept, few = fast_simplification.simplify(
        points.astype(np.float32), faces.astype(np.int32), 1.0 - wanted / len(faces)
    )
    kept, few = np.asarray(kept, float), np.asarray(few, int)
    if not group.paint.picture:
        return group._replace(vertices=kept, uv=np.zeros((len(kept), 2)), normals=None, faces=few)
    corners = kept[few].reshape(-1, 3)
    uv = _mapped(group, kept, few)
    return group._replace(vertices=corners, uv=uv, normals=None, faces=np.arange(len(corners)).reshape(-1, 3))


def _welded(group: Group) -> tuple[Any, Any]:
    """Points and faces with one vertex per place, even where pictures and normals have seams."""
    _, first, of = np.unique(np.round(group.vertices / _SAME_M), axis=0, return_index=True, return_inverse=True)
    faces = of.reshape(-1)[group.faces]
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return group.vertices[first], faces[whole]


def _mapped(group: Group, points: Any, faces: Any) -> Any:
    """The picture coordinates of the corners of new faces (3 F, 2): each face uses the old face on which it lies."""
    from scipy.spatial import KDTree

    old = group.vertices[group.faces]
    new = points[faces]
    near = KDTree(old.mean(1)).query(new.mean(1), k=min(_NEAR, len(old)))[1].reshape(len(new), -1)
    along = np.einsum("fki,fi->fk", _normals(old)[near], _normals(new))
    best = near[np.arange(len(new)), np.argmax(along, axis=1)]
    origin, a, b = (group.uv[group.faces[best]][:, k] for k in range(3))
    base, side, other = old[best, 0], old[best, 1] - old[best, 0], old[best, 2] - old[best, 0]
    way = new - base[:, None]
    dots = {
        name: np.sum(x * y, -1)
        for name, (x, y) in {"ss": (side, side), "so": (side, other), "oo": (other, other)}.items()
    }
    area = np.maximum(dots["ss"] * dots["oo"] - dots["so"] ** 2, 1e-18)[:, None]
    to_side, to_other = np.einsum("fki,fi->fk", way, side), np.einsum("fki,fi->fk", way, other)
    v = (dots["oo"][:, None] * to_side - dots["so"][:, None] * to_other) / area
    w = (dots["ss"][:, None] * to_other - dots["so"][:, None] * to_side) / area
    v, w = np.clip(v, -4.0, 5.0), np.clip(w, -4.0, 5.0)
    uv = origin[:, None] + v[..., None] * (a - origin)[:, None] + w[..., None] * (b - origin)[:, None]
    return uv.reshape(-1, 2)


def _normals(triangles: Any) -> Any:
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return cross / np.maximum(np.linalg.norm(cross, axis=1, keepdims=True), 1e-18)
