"""The compiled look agrees with one ray after the other."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from hthor.rays import blocked
from hthor.types import BodySpec, Pose
from hthor.world import avatar, glance, sight

BODY: BodySpec = avatar.HUMAN


def solids(seed: int, count: int) -> tuple[np.ndarray, ...]:
    """Turned boxes around the eye, the largest first."""
    chance = np.random.default_rng(seed)
    half = chance.uniform(0.02, 0.6, (count, 3))
    pos = np.column_stack([chance.uniform(-4.0, 4.0, (count, 2)), chance.uniform(0.0, 2.0, count)])
    yaw = chance.uniform(-math.pi, math.pi, count)
    cos, sin, zero, one = np.cos(yaw), np.sin(yaw), np.zeros(count), np.ones(count)
    mat = np.column_stack([cos, -sin, zero, sin, cos, zero, zero, zero, one])
    radius = np.linalg.norm(half, axis=1)
    return half, pos, mat, radius, np.argsort(-radius, kind="stable")


def slowly(view, reach, small, points, first, own, half, pos, mat, radius, ids) -> np.ndarray:
    """What `glance.see` promises, word for word."""
    found = np.zeros(len(reach), np.bool_)
    for k in range(len(reach)):
        mine = points[first[k] : first[k + 1]]
        apart = np.linalg.norm(mine - view[:3], axis=1)
        if not (apart[:1] if k < small else apart).min() <= reach[k]:
            continue
        for point in mine:
            ahead, left, up = (float((point - view[:3]) @ view[at : at + 3]) for at in (3, 6, 9))
            framed = ahead > 0.0 and abs(left) <= ahead * view[12] and abs(up) <= ahead * view[13]
            if framed and not blocked(view[:3], point, half, pos, mat, radius, ids, own[k, 0], own[k, 1]):
                found[k] = True
    return found


def balls(points, first, small) -> np.ndarray:
    """Balls around the points of the targets that are not small."""
    rows = []
    for low, high in zip(first[small:-1], first[small + 1 :], strict=True):
        middle = points[low:high].mean(axis=0)
        rows.append((*middle, np.linalg.norm(points[low:high] - middle, axis=1).max()))
    return np.array(rows).reshape(-1, 4).T.copy()


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.lists(st.tuples(st.floats(-3.1, 3.1), st.floats(-0.8, 0.8)), min_size=1, max_size=4))
def test_a_look_finds_what_ray_after_ray_finds(seed: int, turns: list[tuple[float, float]]) -> None:
    """Whatever the eye remembers of where it looked before, and though small things and loose solids move meanwhile."""
    chance, (half, pos, mat, radius, ids) = np.random.default_rng(seed + 1), solids(seed, 40)
    targets, small = 30, 10
    first = np.concatenate(([0], np.cumsum(chance.integers(1, 6, targets))))
    points = np.column_stack([chance.uniform(-5.0, 5.0, (first[-1], 2)), chance.uniform(0.0, 2.0, first[-1])])
    start = chance.integers(0, 38, targets)
    own = np.column_stack([start, start + chance.integers(0, 3, targets)])
    fixed, sure, order = (
        chance.random(len(ids)) < 0.7,
        np.zeros((3, first[-1] - first[small])),
        chance.permutation(targets),
    )
    spots = points[first[small] :].T.copy()
    for number, (yaw, pitch) in enumerate(turns):
        reach = chance.choice([0.0, 1.5, 4.0, 12.0], targets)
        points[: first[small], :2] += chance.uniform(-0.3, 0.3, 2)
        pos[~fixed, :2] += chance.uniform(-0.3, 0.3, 2)
        view = sight.camera(Pose(x=0.1 + chance.choice([0.03, 0.3]) * number, y=-0.2, yaw=yaw, pitch=pitch), BODY)
        scene = (half, pos, mat, radius, ids)
        found = slowly(view, reach, small, points, first, own, *scene)
        walls, loose = (ids[chosen[ids]] for chosen in (fixed, ~fixed))
        spheres, around = np.vstack([pos[walls].T, radius[walls]]), balls(points, first, small)
        bodies = half, pos, mat, radius, walls, spheres, loose
        seen = glance.see(view, reach, small, points, first, own, spots, around, *bodies, sure, order)
        assert seen.tolist() == [k for k in order if found[k]]


def test_the_nearest_of_none_is_nowhere() -> None:
    assert math.isinf(sight.nearest(0.0, 0.0, 0.0, np.zeros((0, 3))))
    assert sight.nearest(0.0, 0.0, 0.0, np.array([[3.0, 4.0, 0.0], [9.0, 0.0, 0.0]])) == 5.0
