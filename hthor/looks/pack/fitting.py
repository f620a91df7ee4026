"""Stretches a model of one size to another size: which models may be stretched, and how.

A model is stretched along its three axes to fill the thing's box. Each axis is stretched in pieces, so that the level
place for objects on the model is exactly at the kind's own surface: objects on it neither float nor sink.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from msgspec import Struct

from hthor import catalog
from hthor.types import Surface, Vec3

_DISTORTION = 1.7
"""How much more a model may be stretched along one axis than along another."""
_SCALE = (0.4, 2.0)
_BEND = (0.12, 3.0)
"""Bounds of the stretch between two knots, relative to the stretch of the whole model."""
_EDGE = 0.015
"""A knot is left out if its distance from an end of the model is below this share of the model's length."""


class Rest(Struct, frozen=True, kw_only=True):
    """A level place of a model, as shares of its box: ``height`` above the bottom, ``low`` and ``high`` corners."""

    height: float
    low: tuple[float, float]
    high: tuple[float, float]


class Stretch(NamedTuple):
    """For each axis, places ``given`` on the model [m] move to ``wanted`` [m]; places in between move linearly."""

    given: tuple[tuple[float, ...], ...]
    wanted: tuple[tuple[float, ...], ...]

    def apply(self, vertices: Any) -> tuple[Any, Any]:
        """Stretch the vertices (V, 3); also return the stretch factors at each vertex along each axis (V, 3)."""
        points = np.array(vertices, float)
        slopes = np.empty_like(points)
        for axis, (given, wanted) in enumerate(zip(self.given, self.wanted, strict=True)):
            knots, targets = np.array(given), np.array(wanted)
            slope = np.diff(targets) / np.diff(knots)
            step = np.clip(np.searchsorted(knots, points[:, axis]) - 1, 0, len(slope) - 1)
            slopes[:, axis] = slope[step]
            points[:, axis] = targets[step] + (points[:, axis] - knots[step]) * slopes[:, axis]
        return points, slopes


def fits(model: Vec3, size: Vec3) -> bool:
    """Whether a model of size ``model`` [m] still looks like itself at ``size`` [m]."""
    scale = [wanted / given for wanted, given in zip(size, model, strict=True)]
    return _SCALE[0] <= min(scale) and max(scale) <= min(_SCALE[1], _DISTORTION * min(scale))


def stretch(kind: str, model: Vec3, rests: Sequence[Rest], size: Vec3) -> Stretch | None:
    """How to stretch a model to ``size`` [m], with its ``rests`` at the kind's own surfaces; None if not allowed.

    Coordinates are relative to the middle of the box, as in every local frame.
    """
    places = supports(kind, size)
    given: list[tuple[float, ...]] = []
    wanted: list[tuple[float, ...]] = []
    for axis in range(3):
        pairs: set[tuple[float, float]] = set()
        for rest, place in zip(rests, places, strict=True):
            shares = (rest.height,) if axis == 2 else (rest.low[axis], rest.high[axis])
            targets = (place.centre[2],) if axis == 2 else _ends(place, axis)
            pairs |= {(share, target / size[axis] + 0.5) for share, target in zip(shares, targets, strict=True)}
        inner = [pair for pair in sorted(pairs) if all(_EDGE < share < 1.0 - _EDGE for share in pair)]
        knots = np.array([(0.0, 0.0), *inner, (1.0, 1.0)])
        steps = np.diff(knots, axis=0)
        if (steps <= 0.0).any():
            return None
        slope = steps[:, 1] / steps[:, 0]
        if not (_BEND[0] <= slope.min() and slope.max() <= _BEND[1]):
            return None
        given.append(tuple((knots[:, 0] - 0.5) * model[axis]))
        wanted.append(tuple((knots[:, 1] - 0.5) * size[axis]))
    return Stretch(tuple(given), tuple(wanted))


def _ends(place: Surface, axis: int) -> tuple[float, float]:
    return (place.centre[axis] - place.half[axis], place.centre[axis] + place.half[axis])


def supports(kind: str, size: Vec3 | None = None) -> tuple[Surface, ...]:
    """The kind's surfaces for objects, lowest first, except behind doors and in drawers."""
    return tuple(place for place in catalog.kind(kind).surfaces(size) if not place.inside and not place.moves)


def opens(kind: str) -> bool:
    """Whether a kind has doors or drawers; models of packs cannot open."""
    return catalog.kind(kind).openable
