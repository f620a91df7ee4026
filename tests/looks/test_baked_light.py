"""Light computed at the corners of meshes: what a ray meets, what is hidden, how deep a crease is."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor.world.rendering.scene import triangle_kernel
from hthor.world.rendering.scene.baked_light import BakedLight
from hthor.world.rendering.scene.scene_mesh import facet

UP = np.array([[0.0, 0.0, 1.0]])
HEIGHT = 2.6


def triangles(*meshes: Any) -> Any:
    return np.concatenate([mesh.vertices[mesh.faces] for mesh in meshes]).astype(float)


FLOOR = facet((-3.0, -3.0, 0.0), (6.0, 0.0, 0.0), (0.0, 6.0, 0.0))
WALL = facet((1.0, -3.0, 0.0), (0.0, 6.0, 0.0), (0.0, 0.0, HEIGHT))
LAMP = {"room": [(0.0, 0.0)]}


def first_hit(corners: Any, origin: Any, way: Any, reach: float) -> float:
    """As the compiled search through the tree, without any tree."""
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    best = reach
    for corner, one, two in zip(corners[:, 0], u, v, strict=True):
        matrix = np.stack([one, two, -way], axis=1)
        if abs(np.linalg.det(matrix)) < 1e-9:
            continue
        a, b, distance = np.linalg.solve(matrix, origin - corner)
        if a >= 0 and b >= 0 and a + b <= 1 and 0 < distance < best:
            best = distance
    return best


@given(seed=st.integers(0, 10_000), count=st.integers(1, 60))
def test_the_tree_finds_what_a_search_without_it_finds(seed: int, count: int) -> None:
    draw = np.random.default_rng(seed)
    corners = draw.uniform(-1.0, 1.0, (count, 1, 3)) + draw.uniform(-0.4, 0.4, (count, 3, 3))
    points, lamp = draw.uniform(-1.5, 1.5, (8, 3)), draw.uniform(-1.5, 1.5, 3)
    tree = (corners, *triangle_kernel.build_tree(corners))
    towards = lamp - points
    seen = triangle_kernel.unhidden(*tree, points, towards, lamp)
    expected = [first_hit(corners, point, way, 1.0) >= 1.0 for point, way in zip(points, towards, strict=True)]
    assert seen.tolist() == expected
    ahead = np.array([[0.0, 0.0, 1.0]])
    openness, _ = triangle_kernel.openness(*tree, points, np.tile(UP, (8, 1)), ahead, 0.7)
    assert openness == pytest.approx([first_hit(corners, point, UP[0], 0.7) / 0.7 for point in points])


def test_a_lamp_lights_what_it_sees_and_nothing_behind_a_wall() -> None:
    light = BakedLight(triangles(FLOOR, WALL), LAMP, HEIGHT, threads=1)
    open_floor = BakedLight(triangles(FLOOR), LAMP, HEIGHT, threads=1)
    behind = np.array([[2.0, 0.0, 0.0]])
    assert open_floor.light(behind, UP).light.max() > light.light(behind, UP).light.max() + 0.2
    dark = BakedLight(triangles(FLOOR, WALL), {}, HEIGHT, threads=1)
    assert light.light(behind, UP).light == pytest.approx(dark.light(behind, UP).light)
    before = np.array([[0.0, 0.0, 0.0]])
    assert light.light(before, UP).light.max() > light.light(behind, UP).light.max() + 0.4


def test_what_faces_away_from_a_lamp_gets_nothing_of_it() -> None:
    light = BakedLight(triangles(FLOOR), LAMP, HEIGHT, threads=1)
    dark = BakedLight(triangles(FLOOR), {}, HEIGHT, threads=1)
    point = np.array([[0.5, 0.5, 1.0]])
    assert light.light(point, -UP).light == pytest.approx(dark.light(point, -UP).light)


def test_a_crease_is_darker_than_a_wide_floor() -> None:
    light = BakedLight(triangles(FLOOR, WALL), {}, HEIGHT, threads=1)
    wide, crease = light.openness(np.array([[-1.0, 0.0, 0.0], [0.98, 0.0, 0.0]]), np.tile(UP, (2, 1))).light
    assert wide == pytest.approx(1.0)
    assert crease < 0.8


def test_probes_tell_where_it_is_light() -> None:
    light = BakedLight(triangles(FLOOR, WALL), LAMP, HEIGHT, threads=1)
    probes = light.probes((-2.0, -2.0, 2.0, 2.0))

    def at(x: float, y: float) -> float:
        i, j = (round((value - start) / probes.side) for value, start in zip((x, y), probes.origin, strict=True))
        return float(probes.light[j, i])

    assert at(0.0, 0.0) > 0.5
    assert at(1.75, 0.0) == 0.0
