"""Where an eye is, where it looks and what it looks for."""

from __future__ import annotations

import functools
import math
from typing import Any

import numba
import numpy as np

from hthor.types import BodySpec, Pose, Vec2, Vec3


def view_vector(pose: Pose, spec: BodySpec) -> Any:
    """(14,) float64: eye [m], forward, left and up axes (house frame), tangents of half the fields of view."""
    cy, sy, cp, sp = (
        math.cos(pose.yaw),
        math.sin(pose.yaw),
        math.cos(pose.pitch),
        math.sin(pose.pitch),
    )
    wide, high = half_fov_tangents(spec)
    return np.array(
        (
            pose.x,
            pose.y,
            spec.eye,
            cp * cy,
            cp * sy,
            sp,
            -sy,
            cy,
            0.0,
            -sp * cy,
            -sp * sy,
            cp,
            wide,
            high,
        )
    )


@functools.cache
def half_fov_tangents(spec: BodySpec) -> Vec2:
    """Tangents of half the fields of view, horizontal and vertical."""
    return math.tan(spec.fov[0] / 2), math.tan(spec.fov[1] / 2)


def eye_position(pose: Pose, spec: BodySpec) -> Vec3:
    """Where the eye is [m], house frame."""
    return (pose.x, pose.y, spec.eye)


def look_points(position: Vec3, size: Vec3) -> tuple[Vec3, Vec3]:
    """Where an object is looked for [m]: its centre and a point near its top."""
    x, y, z = position
    return position, (x, y, z + 0.4 * size[2])


@numba.njit(cache=True, error_model="numpy")
def nearest_distance(x: float, y: float, z: float, positions: Any) -> float:
    """Distance [m] from an eye to the nearest of ``positions`` (N, 3), infinite when there is none."""
    best = math.inf
    for k in range(len(positions)):
        dx, dy, dz = positions[k, 0] - x, positions[k, 1] - y, positions[k, 2] - z
        best = min(best, dx * dx + dy * dy + dz * dz)
    return math.sqrt(best)
