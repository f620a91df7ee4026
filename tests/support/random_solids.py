"""Random boxes around an eye, and what is seen among them by one ray after the other."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np

from hthor.geometry.ray_casting import is_blocked


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


def slowly(view, small, targets, reach, own, half, pos, mat, radius, ids) -> list[int]:
    """What `glance.see` promises, word for word."""
    found = []
    for k, mine in enumerate(targets):
        apart = np.linalg.norm(mine - view[:3], axis=1)
        if not (apart[:1] if k < small else apart).min() <= reach[k]:
            continue
        for point in mine:
            ahead, left, up = (float((point - view[:3]) @ view[at : at + 3]) for at in (3, 6, 9))
            framed = ahead > 0.0 and abs(left) <= ahead * view[12] and abs(up) <= ahead * view[13]
            if framed and not is_blocked(view[:3], point, half, pos, mat, radius, ids, *own[k]):
                found.append(k)
                break
    return found


def house(seed: int, count: int, fixed: float) -> SimpleNamespace:
    """As much of a `geom_index.GeomIndex` as `Occluders` asks for: turned boxes, some of which never move."""
    half, pos, mat, radius, ids = solids(seed, count)
    still = np.random.default_rng(seed).random(count)[ids] < fixed
    return SimpleNamespace(half=half, pos=pos, mat=mat, radius=radius, ids=ids, walls=ids[still], loose=ids[~still])
