from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import catalog, looks
from hthor.catalog import colors
from hthor.catalog.kind import Form
from hthor.errors import UnknownName
from hthor.looks import textures
from hthor.looks.furniture import building, plain
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Mesh, Piece
from hthor.types import Part, Surface, Vec3

NAMES = catalog.names()
LARGEST, TYPICAL = 4000, 1500
MISS_M = 0.002
REST_M = 0.005


def scaled(name: str, factors: Vec3) -> Vec3:
    w, d, h = (extent * factor for extent, factor in zip(catalog.kind(name).size, factors, strict=True))
    return (w, d, h)


def crosses(mesh: Mesh) -> Any:
    a, b, c = (mesh.vertices[mesh.faces[:, k]].astype(float) for k in range(3))
    return np.cross(b - a, c - a)


def check_mesh(mesh: Mesh, slack: float = 0.011) -> None:
    """Types, shapes, finite numbers, unit normals, faces that look the way their normals do."""
    count = len(mesh.vertices)
    assert [array.dtype.str[1:] for array in mesh] == ["f4", "i4", "f4", "f4"]
    assert mesh.vertices.shape == mesh.normals.shape == (count, 3)
    assert mesh.uv.shape == (count, 2)
    assert mesh.faces.shape[1] == 3
    assert 0 <= mesh.faces.min() <= mesh.faces.max() < count
    assert np.isfinite(mesh.vertices).all()
    assert np.isfinite(mesh.uv).all()
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-4)
    cross = crosses(mesh)
    facing = (cross * mesh.normals[mesh.faces].sum(1)).sum(1)
    wrong = (facing <= 0.0) & (np.linalg.norm(cross, axis=1) > 1e-9)
    assert wrong.mean() <= slack


def check_pieces(pieces: tuple[Piece, ...] | list[Piece]) -> None:
    for piece in pieces:
        check_mesh(piece.mesh)
        material = piece.material
        assert not material.texture or material.texture in textures.names()
        assert all(0.0 <= channel <= 1.0 for channel in material.rgba)
        assert all(0.0 <= x <= 1.0 for x in (material.specular, material.shininess, material.emission))


def check_box(name: str, pieces: tuple[Piece, ...], size: Vec3) -> None:
    low, high = shaping.bounds(pieces)
    half = np.array(size) / 2.0
    assert np.abs(low + half).max() <= MISS_M, f"{name} {low + half}"
    assert np.abs(high - half).max() <= MISS_M, f"{name} {high - half}"


def tops(pieces: Iterator[Piece] | list[Piece], points: Any, ceiling: float) -> Any:
    """The highest point [m] of the pieces below ``ceiling`` at each of ``points`` (N, 2), -inf where there is none."""
    best = np.full(len(points), -np.inf)
    for piece in pieces:
        a, b, c = (piece.mesh.vertices[piece.mesh.faces[:, k]].astype(float) for k in range(3))
        area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
        keep = np.abs(area) > 1e-12
        a, b, c, area = a[keep], b[keep], c[keep], area[keep]
        px, py = points[:, None, 0], points[:, None, 1]
        u = ((px - a[:, 0]) * (c[:, 1] - a[:, 1]) - (py - a[:, 1]) * (c[:, 0] - a[:, 0])) / area
        v = ((b[:, 0] - a[:, 0]) * (py - a[:, 1]) - (b[:, 1] - a[:, 1]) * (px - a[:, 0])) / area
        z = a[:, 2] + u * (b[:, 2] - a[:, 2]) + v * (c[:, 2] - a[:, 2])
        hit = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (z < ceiling)
        best = np.maximum(best, np.where(hit, z, -np.inf).max(axis=1, initial=-np.inf))
    return best


def check_rests(name: str, form: Form, pieces: tuple[Piece, ...]) -> None:
    for surface in form.surfaces:
        share = float(np.mean(np.abs(found_tops(surface, pieces) - surface.centre[2]) <= REST_M))
        assert share >= 0.8, f"{name}: only {share:.0%} of '{surface.name}' lies where objects rest"


def found_tops(surface: Surface, pieces: tuple[Piece, ...]) -> Any:
    line = (np.arange(15) + 0.5) / 7.5 - 1.0
    grid = np.stack(np.meshgrid(line, line), -1).reshape(-1, 2) + 1e-4
    points = grid * surface.half + surface.centre[:2]
    # What is drawn in the lower tenth of the free height would be in the way of what rests there.
    ceiling = surface.centre[2] + max(REST_M, min(0.1 * surface.clearance, 0.05))
    return tops([piece for piece in pieces if piece.moves == surface.moves], points, ceiling)


# ------------------------------------------------------------------------------------------------------------- kinds


@pytest.mark.parametrize("name", NAMES)
def test_every_kind_keeps_the_contract(name: str) -> None:
    kind = catalog.kind(name)
    for variant in range(1 + len(kind.finishes)):
        pieces = looks.look(name, None, variant)
        check_pieces(pieces)
        check_box(name, pieces, kind.size)
        assert {piece.moves for piece in pieces} - {""} == {joint.name for joint in kind.joints()}
        assert len({(piece.material, piece.moves) for piece in pieces}) == len(pieces)
    check_rests(name, kind.form(), looks.look(name))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("factors", [(0.7, 0.8, 0.85), (1.5, 1.2, 1.1)], ids=["small", "large"])
def test_a_look_fits_other_sizes(name: str, factors: Vec3) -> None:
    size = scaled(name, factors)
    pieces = looks.look(name, size)
    check_pieces(pieces)
    check_box(name, pieces, size)
    check_rests(name, catalog.kind(name).form(size), pieces)


@given(st.sampled_from(NAMES), st.tuples(*[st.floats(0.4, 2.5)] * 3), st.integers(0, 9))
@settings(max_examples=cases(40))
def test_a_look_fills_whatever_box_a_house_gives_it(name: str, factors: Vec3, variant: int) -> None:
    size = scaled(name, factors)
    pieces = looks.look(name, size, variant)
    check_box(name, pieces, size)
    assert all(np.isfinite(array).all() for piece in pieces for array in piece.mesh)


def test_triangles_are_few() -> None:
    counts = {name: sum(len(piece.mesh.faces) for piece in looks.look(name)) for name in NAMES}
    assert max(counts.values()) <= LARGEST, max(counts, key=lambda name: counts[name])
    assert sum(counts.values()) / len(counts) <= TYPICAL


def test_most_kinds_look_like_more_than_their_solids() -> None:
    unlike = [name for name in NAMES if len(looks.look(name)) == len(plain.plain_pieces(catalog.kind(name).parts()))]
    assert len(unlike) < len(NAMES) / 3
    assert len(looks.look("apple")) > 1


def test_finishes_show() -> None:
    for name in NAMES:
        finishes = 1 + len(catalog.kind(name).finishes)
        seen = {tuple(piece.material for piece in looks.look(name, None, variant)) for variant in range(finishes)}
        assert len(seen) == finishes, name


def test_a_look_is_made_once_and_the_same_every_time() -> None:
    def digest(pieces: tuple[Piece, ...]) -> str:
        return hashlib.sha256(b"".join(array.tobytes() for piece in pieces for array in piece.mesh)).hexdigest()

    first = looks.look("house_plant")
    assert looks.look("house_plant") is first
    looks.look.cache_clear()
    assert digest(looks.look("house_plant")) == digest(first)


def test_an_unknown_kind_is_refused() -> None:
    with pytest.raises(UnknownName):
        looks.look("unicorn")


# ------------------------------------------------------------------------------------------------------------ shapes


def volume(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, k]].astype(float) for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


def edges(mesh: Mesh) -> Any:
    """Every directed edge between places, (N, 2): a closed surface has each of them once in both directions."""
    _, place = np.unique(np.round(mesh.vertices.astype(float), 5), axis=0, return_inverse=True)
    corners = place.reshape(-1)[mesh.faces]
    return np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])


CLOSED = {
    "box": (solids.box((-1, -1, -1), (1, 2, 3), 0.2, 2), 24.0),
    "sharp box": (solids.box((0, 0, 0), (1, 1, 1), 0.0), 1.0),
    "cylinder": (solids.cylinder((0, 0, 0), 1.0, 2.0, "y", 64), 2 * math.pi),
    "cone": (solids.cylinder((0, 0, 0), 1.0, 3.0, "x", 64, 0.5), math.pi * 1.75),
    "ball": (solids.ball((1, 1, 1), (1.0, 2.0, 3.0), 48), 8 * math.pi),
    "blob": (solids.blob(lambda lon, lat: 1.0 + 0.0 * lon, 40, 30), 4 / 3 * math.pi),
    "ring": (sweeps.ring((0, 0, 0), 1.0, 0.25, "y", 48, 16), 2 * math.pi**2 * 0.25**2),
    "tube": (sweeps.tube([(0, 0, 0), (0, 0, 1), (0, 0, 2)], 0.5, 48), math.pi / 2),
    "prism": (sweeps.extruded([(0, 0), (1, 0), (1, 1), (0, 1)], 0.0, 2.0), 2.0),
}


@pytest.mark.parametrize("shape", CLOSED)
def test_solids_are_closed_and_face_outward(shape: str) -> None:
    mesh, expected = CLOSED[shape]
    check_mesh(mesh, 0.0)
    assert volume(mesh) == pytest.approx(expected, rel=0.05)
    forth = edges(mesh)
    assert sorted(map(tuple, forth.tolist())) == sorted(map(tuple, forth[:, ::-1].tolist()))


@given(st.floats(-3, 3), st.sampled_from("xyz"), st.tuples(*[st.floats(0.3, 3)] * 3))
@settings(max_examples=cases(30))
def test_turning_and_stretching_keep_a_mesh_sound(angle: float, axis: str, factors: Vec3) -> None:
    mesh = solids.ball((0.2, 0.1, 0.3), (1.0, 1.0, 1.0), 12)
    for changed in (shaping.turned(mesh, axis, angle), shaping.stretched(mesh, *factors)):
        check_mesh(changed, 0.0)
    assert volume(shaping.turned(mesh, axis, angle)) == pytest.approx(volume(mesh), rel=1e-3)
    assert volume(shaping.stretched(mesh, *factors)) == pytest.approx(volume(mesh) * math.prod(factors), rel=1e-3)


@pytest.mark.parametrize("axis", "xyz")
def test_plain_cylinders_lie_along_their_axis(axis: str) -> None:
    half = {"x": (0.5, 0.1, 0.1), "y": (0.1, 0.5, 0.1), "z": (0.1, 0.1, 0.5)}[axis]
    part = Part(shape="cylinder", centre=(1.0, 2.0, 3.0), half=half, rgba=(1.0, 1.0, 1.0, 1.0), axis=axis)  # type: ignore[arg-type]
    low, high = shaping.bounds(plain.plain_pieces([part]))
    assert (high - low) / 2 == pytest.approx(half, abs=1e-3)
    assert (high + low) / 2 == pytest.approx(part.centre, abs=1e-6)


def test_pictures_stand_upright_for_who_looks_at_them() -> None:
    mesh = sweeps.panel((0.0, 0.0, 0.0), 2.0, 1.0)
    left_top = int(np.argmin(mesh.uv.sum(axis=1)))
    assert mesh.vertices[left_top] == pytest.approx((1.0, 0.0, 0.5))  # looking along -y, +x is on the left
    assert mesh.normals[:, 1] == pytest.approx(1.0)


# ---------------------------------------------------------------------------------------------------------- building

PARTS = {
    "door_leaf": (building.door_leaf(0.85, 2.05), (-0.425, None, 0.0), (0.425, None, 2.05)),
    "oak door_leaf": (building.door_leaf(0.8, 2.0, colors.OAK, 3), (-0.4, None, 0.0), (0.4, None, 2.0)),
    "ceiling_lamp": (building.ceiling_lamp(0.2), (None, None, -0.1), (None, None, 0.0)),
}  # fmt: skip


@pytest.mark.parametrize("name", PARTS)
def test_building_parts_lie_where_they_say(name: str) -> None:
    pieces, lowest, highest = PARTS[name]
    check_pieces(pieces)
    for found, wanted in zip(shaping.bounds(pieces), (lowest, highest), strict=True):
        for value, limit in zip(found, wanted, strict=True):
            assert limit is None or value == pytest.approx(limit, abs=0.002)
