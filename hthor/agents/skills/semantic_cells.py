"""What each cell of a 7 x 7 grid over a robot's picture shows, and how far off it is, for robots that learn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hthor import catalog

Bytes: TypeAlias = NDArray[np.uint8]

GRID = 7
"""Cells along each side of the picture, as in the published features."""
CELLS = GRID * GRID
GOALS = (*catalog.TARGETS, *catalog.RECEPTACLES)
"""The kinds of things that a robot can be asked to look for: what tasks bring, and where they bring it."""
NOTHING, ROBOT = "nothing", "robot"
PARTS = ("floor", "ceiling", "wall", "door", "window", "person", ROBOT, "ground", "outdoors", "roof")
"""What pictures show besides kinds of things; robots of all names are one class."""
CLASSES = (NOTHING, *catalog.names(), *PARTS)
"""The classes that a cell can show. A checkpoint keeps its own list, so that the catalogue may grow."""
FAR_M = 10.0
"""[m] Depths from here on look the same."""
LEVELS = 255
"""Into how many steps `FAR_M` is divided, as a depth takes one byte of a pose grid."""


class Cells(NamedTuple):
    """The cells of one picture, row by row from the upper left, each (49,) uint8.

    Attributes:
        shown: indices of classes: of a thing to bring if any pixel shows one, else of what most pixels show.
        behind: the same without things to bring, as a detector sees a cell whose object it has missed.
        depth: mean depth of what is shown, in steps of `FAR_M` / `LEVELS`.
    """

    shown: Bytes
    behind: Bytes
    depth: Bytes


class CellReader:
    """Reads cells from pictures of one size in one episode.

    Args:
        labels: the kinds that the numbers of segmentations stand for, see `hthor.types.Briefing.labels`.
        size: (width, height) [pixels] of the pictures.
        classes: the classes that cells can show; other kinds are "robot".
    """

    def __init__(self, labels: Sequence[str], size: tuple[int, int], classes: Sequence[str] = CLASSES) -> None:
        number = {name: index for index, name in enumerate(classes)}
        self._count = len(classes)
        self._class = np.array([*(number.get(kind, number[ROBOT]) for kind in labels), number[NOTHING]], np.int64)
        self._small = np.array([name in catalog.TARGETS for name in classes])
        width, height = size
        columns, rows = _cell_of(width), _cell_of(height)
        self._first = ((rows[:, None] * GRID + columns[None, :]) * self._count).ravel()

    def read(self, segmentation: NDArray[np.int32], depth: NDArray[np.float32]) -> Cells:
        """The cells of a picture: its segmentation (H, W), -1 for nothing, and its depth (H, W) [m]."""
        index = self._first + self._class[segmentation.ravel()]
        length = CELLS * self._count
        pixels = np.bincount(index, minlength=length).reshape(CELLS, self._count)
        metres = np.bincount(index, weights=depth.ravel(), minlength=length).reshape(CELLS, self._count)
        small = pixels * self._small
        behind = np.argmax(pixels * ~self._small, axis=1)
        shown = np.where(small.any(axis=1), np.argmax(small, axis=1), behind)
        every = np.arange(CELLS)
        mean = metres[every, shown] / np.maximum(pixels[every, shown], 1)
        steps = np.rint(np.clip(mean / FAR_M, 0.0, 1.0) * LEVELS)
        return Cells(shown.astype(np.uint8), behind.astype(np.uint8), steps.astype(np.uint8))


def mean_depths(depth: NDArray[np.float32]) -> NDArray[np.float64]:
    """(49,) [m] the mean depth of each cell of a picture (H, W) [m], row by row from the upper left."""
    means = np.asarray(depth, np.float64)
    for axis, length in enumerate(depth.shape):
        cells = _cell_of(length)
        first = np.flatnonzero(np.diff(cells, prepend=-1))
        counts = np.diff(first, append=length)
        means = np.add.reduceat(means, first, axis=axis) / (counts[:, None] if axis == 0 else counts)
    return means.ravel()


def _cell_of(length: int) -> NDArray[np.int64]:
    """The cell in which each row or column of a picture is, along one side of so many pixels."""
    return np.arange(length) * GRID // length
