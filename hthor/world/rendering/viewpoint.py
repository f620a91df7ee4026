"""A camera anywhere in or above a house, for figures; it belongs to no body."""

import math

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor.types import Vec2, Vec3
from hthor.world.rendering.camera import FAR_M, NEAR_M


class Viewpoint(Struct, frozen=True, kw_only=True):
    """A camera's place and direction. Its pixels are square, and no picture of it is tilted to a side.

    Attributes:
        eye: [m] where the camera is, house frame. target: [m] the point in the middle of pictures, not above the eye.
        fov: [rad] vertical field of view.
    """

    eye: Vec3
    target: Vec3
    fov: float = 0.6

    @property
    def axes(self) -> NDArray[np.float64]:
        """(3, 3) float64, unit vectors: forward, left and up of the camera in the house frame."""
        ahead = np.subtract(self.target, self.eye)
        ahead = ahead / np.linalg.norm(ahead)
        left = np.cross((0.0, 0.0, 1.0), ahead)
        left = left / np.linalg.norm(left)
        return np.stack([ahead, left, np.cross(ahead, left)])

    def tangents(self, size: tuple[int, int]) -> Vec2:
        """Tangents of half the fields of view, horizontal and vertical, of pictures of ``size`` (width, height)."""
        high = math.tan(self.fov / 2)
        return high * size[0] / size[1], high

    def vector(self, size: tuple[int, int]) -> NDArray[np.float64]:
        """(16,) float64, the camera as `hthor.world.rendering.rasterizer.fill` takes it."""
        return np.concatenate((self.eye, self.axes.ravel(), self.tangents(size), (NEAR_M, FAR_M)))

    def project(self, points: NDArray[np.float64], size: tuple[int, int]) -> NDArray[np.float64]:
        """(N, 3) float64: column and row [pixels], and depth [m] along the optical axis, of ``points`` (N, 3) [m].

        Pixel (0, 0) is centred at (0, 0). Points behind the camera have a negative depth and no meaningful pixel.
        """
        ahead, left, up = self.axes @ (np.asarray(points, float) - np.array(self.eye)).T
        wide, high = self.tangents(size)
        columns = (1.0 - left / ahead / wide) * size[0] / 2 - 0.5
        rows = (1.0 - up / ahead / high) * size[1] / 2 - 0.5
        return np.stack([columns, rows, ahead], axis=1)
