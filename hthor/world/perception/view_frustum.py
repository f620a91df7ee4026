"""An eye's position, axes and field of view, and tests whether points and balls are in view."""

import functools
import math

import numba
import numpy as np

from hthor.geometry import plane
from hthor.geometry.ray_casting import Bools, Floats
from hthor.types import BodySpec, Pose, Rotate, Vec2, Vec3

ViewAxes = tuple[float, ...]
"""An eye [m], its forward, left and up axes, and the tangents of half its fields of view: 14 numbers."""


def view_vector(pose: Pose, spec: BodySpec) -> Floats:
    """(14,) float64: eye [m], forward, left and up axes (house frame), tangents of half the fields of view."""
    yaw = pose.gaze
    cy, sy, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pose.pitch), math.sin(pose.pitch)
    wide, high = half_fov_tangents(spec)
    axes = (cp * cy, cp * sy, sp, -sy, cy, 0.0, -sp * cy, -sp * sy, cp)
    return np.array((pose.x, pose.y, spec.eye, *axes, wide, high))


@functools.cache
def half_fov_tangents(spec: BodySpec) -> Vec2:
    """Tangents of half the fields of view, horizontal and vertical."""
    return math.tan(spec.fov[0] / 2), math.tan(spec.fov[1] / 2)


def eye_position(pose: Pose, spec: BodySpec) -> Vec3:
    """The position of the eye [m], house frame."""
    return (pose.x, pose.y, spec.eye)


def rotation_towards(pose: Pose, body: BodySpec, point: Vec3) -> Rotate:
    """The rotation after which the head of a body at ``pose`` faces ``point`` [m], tilted to it as far as possible."""
    dx, dy = point[0] - pose.x, point[1] - pose.y
    yaw = plane.wrap(math.atan2(dy, dx) - pose.gaze)
    up = math.atan2(point[2] - body.eye, max(math.hypot(dx, dy), 1e-6))
    return Rotate(yaw=yaw, pitch=max(-body.pitch_limit, min(body.pitch_limit, up)) - pose.pitch)


def look_points(position: Vec3, size: Vec3) -> tuple[Vec3, Vec3]:
    """The points [m] at which an object's visibility is tested: its centre and a point near its top."""
    x, y, z = position
    return position, (x, y, z + 0.4 * size[2])


@numba.njit(cache=True, error_model="numpy")
def nearest_distance(x: float, y: float, z: float, positions: Floats) -> float:
    """Distance [m] from an eye to the nearest of ``positions`` (N, 3), infinite when there is none."""
    best = math.inf
    for k in range(len(positions)):
        dx, dy, dz = positions[k, 0] - x, positions[k, 1] - y, positions[k, 2] - z
        best = min(best, dx * dx + dy * dy + dz * dz)
    return math.sqrt(best)


@numba.njit(cache=True, error_model="numpy")
def view_axes(x: float, y: float, z: float, yaw: float, pitch: float, wide: float, high: float) -> ViewAxes:
    """An eye [m], its forward, left and up axes, and the tangents of half its fields of view: 14 numbers."""
    cy, sy, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    return x, y, z, cp * cy, cp * sy, sp, -sy, cy, 0.0, -sp * cy, -sp * sy, cp, wide, high


@numba.njit(cache=True, error_model="numpy")
def in_frame(view: ViewAxes, dx: float, dy: float, dz: float) -> bool:
    """Whether a point at (dx, dy, dz) [m] from the eye is in the field of view."""
    ahead = dx * view[3] + dy * view[4] + dz * view[5]
    left = dx * view[6] + dy * view[7] + dz * view[8]
    up = dx * view[9] + dy * view[10] + dz * view[11]
    return bool((ahead > 0.0) & (abs(left) <= ahead * view[12]) & (abs(up) <= ahead * view[13]))


@numba.njit(cache=True, error_model="numpy")
def sphere_in_view(view: ViewAxes, reach: float, balls: Floats, i: int) -> bool:
    """Whether ball ``i`` of ``balls`` (4, N), middles and radii [m], is partly in reach and in the field of view."""
    ex, ey, ez, fx, fy, fz = view[0], view[1], view[2], view[3], view[4], view[5]
    lx, ly, lz, ux, uy, uz, w, h = view[6], view[7], view[8], view[9], view[10], view[11], view[12], view[13]
    dx, dy, dz, size = balls[0, i] - ex, balls[1, i] - ey, balls[2, i] - ez, balls[3, i]
    limit = reach + size
    ahead = dx * fx + dy * fy + dz * fz
    left = dx * lx + dy * ly + dz * lz
    up = dx * ux + dy * uy + dz * uz
    near = (dx * dx + dy * dy + dz * dz <= limit * limit) & (ahead >= -size)
    aside = abs(left) - ahead * w <= size * math.sqrt(1.0 + w * w)
    return bool(near & aside & (abs(up) - ahead * h <= size * math.sqrt(1.0 + h * h)))


@numba.njit(cache=True, error_model="numpy")
def mark_spheres_in_view(view: ViewAxes, reach: float, balls: Floats, out: Bools) -> None:
    """Set ``out`` to whether each ball is partly within reach and in the field of view."""
    for i in range(len(out)):
        out[i] = sphere_in_view(view, reach, balls, i)
