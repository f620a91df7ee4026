"""Where a camera is and how it projects, as records and as the numbers a tracer wants; draws nothing."""

from __future__ import annotations

from typing import Any

import numpy as np

from hthor.types import BodySpec, Camera, Pose
from hthor.world import sight

NEAR_M, FAR_M = 0.02, 80.0
"""Nothing nearer or farther is in a picture."""
_UP_M = 1.0e5
"""A camera so far up that its rays are parallel: over a house they part by less than a hundredth of a millimetre."""


def of(pose: Pose, spec: BodySpec, size: tuple[int, int]) -> Camera:
    """The camera of a body at a pose, for pictures of ``size`` (width, height) [pixels]."""
    view = sight.camera(pose, spec)
    width, height = size
    matrix = np.array(
        (
            (width / (2.0 * view[12]), 0.0, (width - 1) / 2.0),
            (0.0, height / (2.0 * view[13]), (height - 1) / 2.0),
            (0.0, 0.0, 1.0),
        )
    )
    place = np.eye(4)
    place[:3, 0], place[:3, 1], place[:3, 2], place[:3, 3] = -view[6:9], -view[9:12], view[3:6], view[:3]
    return Camera(size=size, matrix=matrix, pose=place, near=NEAR_M, far=FAR_M)


def view(pose: Pose, spec: BodySpec) -> Any:
    """(16,) float64 for `hthor.world.raster.fill`: a body's camera."""
    return np.concatenate((sight.camera(pose, spec), (NEAR_M, FAR_M)))


def above(bounds: tuple[float, float, float, float]) -> Any:
    """(16,) float64 for `hthor.world.raster.fill`: straight down on x0, y0, x1, y1 [m], with north up."""
    x0, y0, x1, y1 = bounds
    eye = ((x0 + x1) / 2, (y0 + y1) / 2, _UP_M)
    tangents = ((x1 - x0) / 2 / _UP_M, (y1 - y0) / 2 / _UP_M)
    return np.array((*eye, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0, *tangents, NEAR_M, 2.0 * _UP_M))


def check(size: tuple[int, int]) -> None:
    """Raise ValueError unless ``size`` is a width and a height of 1 to 4096 pixels."""
    try:
        width, height = size
        fits = all(isinstance(side, (int, np.integer)) and 1 <= side <= 4096 for side in (width, height))
    except (TypeError, ValueError):
        fits = False
    if not fits:
        raise ValueError(
            f"size must be (width, height) in whole pixels, 1 to 4096 each, such as (128, 128); got {size!r}"
        )
