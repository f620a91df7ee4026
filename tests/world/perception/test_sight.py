"""The compiled look agrees with one ray after the other."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from random_solids import house, slowly

from hthor.types import BodySpec, Pose
from hthor.world.model.bodies import avatar
from hthor.world.perception import view_frustum, visibility_kernel
from hthor.world.perception.occluders import Occluders

BODY: BodySpec = avatar.HUMAN


def still_targets(targets, own) -> tuple[np.ndarray, np.ndarray]:
    """``balls`` and ``spots`` of targets that never move, as `glance.see` takes them."""
    begins = np.cumsum([0, *(len(points) for points in targets)])
    rows = [
        (*points.mean(axis=0), np.linalg.norm(points - points.mean(axis=0), axis=1).max(), *span, begin)
        for points, span, begin in zip(targets, own, begins, strict=False)
    ]
    balls = np.array([*rows, (0.0,) * 6 + (begins[-1],)]).T.copy()
    spots = np.zeros((6, begins[-1]))
    spots[:3] = np.concatenate(targets).T
    return balls, spots


@settings(max_examples=cases(40))
@given(st.integers(0, 10**6), st.lists(st.tuples(st.floats(-3.1, 3.1), st.floats(-0.8, 0.8)), min_size=1, max_size=4))
def test_a_look_finds_what_ray_after_ray_finds(seed: int, turns: list[tuple[float, float]]) -> None:
    """Whatever the eye remembers of where it looked before, and though small things and loose solids move meanwhile."""
    chance, scene = np.random.default_rng(seed + 1), house(seed, 60, 0.7)
    moving, small, still = 14, 10, 20

    def scattered(count: int) -> np.ndarray:
        return np.column_stack([chance.uniform(-5.0, 5.0, (count, 2)), chance.uniform(0.0, 2.0, count)])

    points = scattered(2 * moving).reshape(moving, 2, 3)
    begin = chance.integers(0, 58, moving + still)
    own = np.column_stack([begin, begin + chance.integers(0, 3, moving + still)])
    things = [scattered(count) for count in chance.integers(1, 6, still)]
    balls, spots = still_targets(things, own[moving:])
    occluders, order = Occluders(scene), chance.permutation(moving + still)
    far = float(chance.choice([0.0, 1.5, 4.0, 12.0]))
    for number, (yaw, pitch) in enumerate(turns):
        points[..., :2] += chance.uniform(-0.3, 0.3, 2)
        scene.pos[scene.loose, :2] += chance.uniform(-0.3, 0.3, 2)
        occluders.follow(number)
        pose = Pose(x=0.1 + chance.choice([0.03, 0.3]) * number, y=-0.2, yaw=yaw, pitch=pitch)
        wanted = np.column_stack([chance.choice([0.0, 1.5, 4.0, 12.0], moving), own[:moving]])
        reach = [*wanted[:, 0], *[far] * still]
        bodies = scene.half, scene.pos, scene.mat, scene.radius, scene.ids
        found = slowly(view_frustum.view_vector(pose, BODY), small, [*points, *things], reach, own, *bodies)
        eye = pose.x, pose.y, BODY.eye, pose.yaw, pose.pitch, *view_frustum.half_fov_tangents(BODY)
        around, seen = occluders.arrays, np.empty(len(order) + 1, np.int64)
        moving_and_still = small, points, wanted, far, balls, spots
        count = visibility_kernel.visible_targets(*eye, *moving_and_still, *around, order, seen)
        assert seen[:count].tolist() == [k for k in order if k in found]


def test_the_nearest_of_none_is_nowhere() -> None:
    assert math.isinf(view_frustum.nearest_distance(0.0, 0.0, 0.0, np.zeros((0, 3))))
    assert view_frustum.nearest_distance(0.0, 0.0, 0.0, np.array([[3.0, 4.0, 0.0], [9.0, 0.0, 0.0]])) == 5.0
