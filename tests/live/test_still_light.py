"""The light on what stands still: hidden corners, triangles inside of walls, and shadows that need more corners."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hthor.live.gltf import hidden_corners, still_light
from hthor.live.gltf.surfaces import Surface, edges_of, halved
from hthor.looks import Material, Mesh
from hthor.world.rendering.scene.baked_light import BakedLight
from hthor.world.rendering.scene.scene_mesh import facet, slab
from hthor.world.rendering.scene.scene_parts import STATIC, ScenePart

HEIGHT = 2.6
LAMP = {"room": [(0.0, 0.0)]}


def surface(mesh: Mesh, owner: str = "thing", **material: Any) -> Surface:
    return Surface.of(ScenePart(STATIC, owner, mesh, Material(**material), 0))


FLOOR = surface(facet((-2.0, -2.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0)), "floor of room")
BOX = surface(slab((0.8, 0.0, 0.31), (0.35, 0.35, 0.3)), "box")


def baked(*surfaces: Surface) -> BakedLight:
    return BakedLight(np.concatenate([one.corners for one in surfaces]), LAMP, HEIGHT, threads=1)


def area(one: Surface) -> float:
    a, b, c = one.corners.transpose(1, 0, 2)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def test_edges_are_cut_and_neighbours_stay_neighbours() -> None:
    edges, which = edges_of(FLOOR.faces)
    assert which.shape == FLOOR.faces.shape
    rows, faces = halved(FLOOR.vertices, FLOOR.faces, edges[::3])
    assert len(rows) == len(FLOOR.vertices) + len(edges[::3])
    cut = FLOOR._replace(vertices=rows, faces=faces)
    assert area(cut) == pytest.approx(16.0)
    ends, uses = edges_of(faces)
    counts = np.bincount(uses.ravel())
    rim = np.abs(rows[ends]).max(2).min(1) > 1.999
    assert (counts[~rim] == 2).all(), "no corner lies in the middle of another triangle's edge"


def test_no_edge_of_a_refined_surface_is_long() -> None:
    fine = FLOOR.refined(0.25)
    ends, _ = edges_of(fine.faces)
    assert np.linalg.norm(fine.vertices[ends[:, 0]] - fine.vertices[ends[:, 1]], axis=1).max() <= 0.25
    assert area(fine) == pytest.approx(16.0)


def test_hidden_corners_have_the_light_of_those_around_them() -> None:
    light = np.array([1.0, 3.0, 0.0, 0.0, 0.0])
    hidden = np.array([False, False, True, True, True])
    vertices = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0, 0, 9)], float)
    faces = np.array([(0, 1, 2), (1, 3, 2)])
    assert hidden_corners.spread_light(light, hidden, vertices, faces).tolist() == [1.0, 3.0, 2.0, 3.0, 1.0]
    assert hidden_corners.spread_light(light, hidden | True, vertices, faces).tolist() == light.tolist()
    of = np.array([0, 0, 0, 0, 1])
    assert hidden_corners.spread_light(light, hidden, vertices, faces, of)[4] == 0.0, "of its own surface only"


def test_the_floor_below_a_box_does_not_darken_the_floor_beside_it() -> None:
    floor, _ = still_light.lit([FLOOR, BOX], baked(FLOOR, BOX), 10_000)
    bare, _ = still_light.lit([FLOOR, BOX], baked(FLOOR), 10_000)
    assert floor.colours.min() > 0.3 * bare.colours.min()
    edges, _ = edges_of(floor.faces)
    assert len(floor.faces) > len(FLOOR.faces), "there are more corners where the shadow ends"
    assert len(floor.faces) < 10_000
    assert edges.max() < len(floor.vertices)


def test_what_is_inside_of_something_is_left_out_unless_it_is_a_door() -> None:
    inner = surface(slab((0.83, 0.04, 0.27), (0.1, 0.1, 0.1)), "inner")
    light = baked(FLOOR, BOX)
    assert [one.owner for one in still_light.lit([FLOOR, BOX, inner], light, 5000)] == ["floor of room", "box"]
    (door,) = still_light.lit([inner], light, 5000, whole=True)
    assert area(door) == pytest.approx(area(inner))
    assert (door.colours >= 0.5 * door.tint).all()


def test_glass_has_the_light_of_its_brighter_side() -> None:
    pane = facet((-0.5, 0.5, 0.5), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    back = Mesh(pane.vertices, pane.faces[:, ::-1], pane.uv, -pane.normals)
    light = baked(FLOOR)
    for rgba, alike in (((1.0, 1.0, 1.0, 0.4), True), ((1.0, 1.0, 1.0, 1.0), False)):
        one, other = (still_light.lit([surface(mesh, rgba=rgba)], light, 0)[0] for mesh in (pane, back))
        assert np.allclose(one.colours.mean(0), other.colours.mean(0)) == alike


def test_a_surface_moves_and_moves_back() -> None:
    frame = (1.0, 2.0, 0.5), (0.8, 0.0, 0.0, 0.6)
    moved = BOX.moved(*frame)
    assert not np.allclose(moved.vertices, BOX.vertices)
    assert moved.moved_back(*frame).vertices == pytest.approx(BOX.vertices)
    assert moved.moved_back(*frame).normals == pytest.approx(BOX.normals)
