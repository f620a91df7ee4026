"""Making a model of one size look right at another: what may be stretched, and how.

A model is stretched along its three axes to fill the thing's box, piece by piece, so that the level place where things
lie on it is exactly where the kind's own surface is: things that rest there neither float nor sink.
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
"""Bounds of a stretch between two knots, as shares of the model's own."""
_EDGE = 0.015
"""A knot nearer to an end of the model than this share of its length is left out."""


class Rest(Struct, frozen=True, kw_only=True):
    """A level place of a model, all as shares of its box: ``height`` above its bottom, ``low`` and ``high`` corners."""

    height: float
    low: tuple[float, float]
    high: tuple[float, float]


class Stretch(NamedTuple):
    """For each axis, places of the model ``given`` [m] become those ``wanted`` [m], straight in between."""

    given: tuple[tuple[float, ...], ...]
    wanted: tuple[tuple[float, ...], ...]

    def apply(self, vertices: Any) -> tuple[Any, Any]:
        """The vertices (V, 3) stretched, and by how much (V, 3) along each axis there."""
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
    """Whether a model of that size [m] still looks like itself at another."""
    scale = [wanted / given for wanted, given in zip(size, model, strict=True)]
    return _SCALE[0] <= min(scale) and max(scale) <= min(_SCALE[1], _DISTORTION * min(scale))


def stretch(kind: str, model: Vec3, rests: Sequence[Rest], size: Vec3) -> Stretch | None:
    """How a model is stretched to ``size`` [m], its ``rests`` onto the kind's own places; None when it must not be.

    Coordinates count from the middle of the box, as in every local frame.
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
    """The kind's places where things can lie, lowest first, except behind doors and in drawers."""
    return tuple(place for place in catalog.kind(kind).surfaces(size) if not place.inside and not place.moves)


def opens(kind: str) -> bool:
    """Whether a kind has doors or drawers; no model of a pack can open."""
    return catalog.kind(kind).openable
