"""Draws an overview of a house, and marks in it: boxes around objects, names, and arrows."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING, Any

import cv2
import msgspec
import numpy as np
from matplotlib import patheffects
from matplotlib.patches import Polygon
from msgspec import Struct

from hthor import catalog
from hthor.report.drawing import text_fit
from hthor.report.drawing.overviews import framing
from hthor.types import Vec3
from hthor.world import World
from hthor.world.rendering.viewpoint import Viewpoint

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PIXELS = (760, 600)
"""Width and height of the picture of a house [pixels]."""
_FINER = 2
"""Pictures are drawn this many times larger and then averaged, which makes edges smooth."""
_LEAST_M, _LOOSE = 0.42, 1.3
"""Side of a box at least [m], so that one sees it; how much larger than its object a box is."""
_NAME_PT = 6.8
_RISES = (1.0, -2.0, 2.1, -3.1, 3.2, -4.2, 4.3)
"""Size of the letters of names [pt], and how many lines above its point a name may stand, the best first."""
_EDGES = tuple((a, b) for a, b in product(range(8), repeat=2) if a < b and (a ^ b).bit_count() == 1)
_STROKE: list[patheffects.AbstractPathEffect] = [patheffects.withStroke(linewidth=2.0, foreground="white")]


class Overview(Struct, frozen=True, kw_only=True, eq=False):
    """Axes that show a house from a viewpoint; marks are drawn in its pixels."""

    ax: Any
    world: World
    viewpoint: Viewpoint
    taken: list[tuple[float, float, float, float]] = msgspec.field(default_factory=list)
    """Rectangles of words that were written, left, top, right and bottom [pixels]."""

    def box(self, centre: Vec3, kind: str, shade: str, *, yaw: float = 0.0, grow: float = 1.0) -> None:
        """Draw a box around an object, dashed if something hides it.

        Args:
            centre: [m] of the object. kind: of the object, which decides its size. yaw: [rad] its heading.
            grow: a factor of the box's size.
        """
        half = [grow * max(_LEAST_M, _LOOSE * side) / 2 for side in catalog.kind(kind).size]
        corners = np.array([np.multiply(half, sign) for sign in product((-1.0, 1.0), repeat=3)])
        cos, sin = math.cos(yaw), math.sin(yaw)
        corners = corners @ np.array(((cos, sin, 0.0), (-sin, cos, 0.0), (0.0, 0.0, 1.0))) + centre
        projected = self.viewpoint.project(corners, PIXELS)
        places, back = projected[:, :2], int(np.argmax(projected[:, 2]))
        hidden = not framing.visible(self.world, self.viewpoint, [centre])[0]
        hull = cv2.convexHull(places.astype(np.float32))[:, 0]
        self.ax.add_patch(Polygon(hull, closed=True, facecolor=shade, edgecolor="none", alpha=0.3, zorder=4))
        for a, b in _EDGES:
            if back not in (a, b):  # those are the edges that a solid box hides
                xs, ys = places[[a, b]].T
                look = {"ls": (0, (2, 1.2)) if hidden else "-", "solid_capstyle": "round", "zorder": 5}
                self.ax.plot(xs, ys, color=shade, lw=1.0, **look)

    def name(self, centre: Vec3, words: str, shade: str) -> None:
        """Write words above a point [m], or below it, or higher, where they cover no other words."""
        x, y = self._pixel(centre)
        scale = PIXELS[0] / self._inches  # pixels per inch of the figure
        half, line = 0.55 * text_fit.text_width(words, _NAME_PT, bold=True) * scale, 1.25 * _NAME_PT / 72.0 * scale
        for rise in _RISES:
            low = y - rise * line
            place = (x - half, low - line, x + half, low)
            if not any(_overlap(place, other) for other in self.taken):
                break
        self.taken.append(place)
        text = self.ax.text(
            x, low, words, fontsize=_NAME_PT, weight="bold", color=shade, ha="center", va="bottom", zorder=8
        )
        text.set_path_effects(_STROKE)

    def arrow(self, begin: Vec3, end: Vec3, shade: str) -> None:
        """Draw an arrow from one point [m] to another."""
        look = {"arrowstyle": "-|>", "color": shade, "lw": 1.1, "shrinkA": 5, "shrinkB": 5, "mutation_scale": 8}
        look["connectionstyle"] = "arc3,rad=0.18"
        drawn = self.ax.annotate("", self._pixel(end), self._pixel(begin), arrowprops=look, zorder=6)
        drawn.arrow_patch.set_path_effects(_STROKE)

    @property
    def _inches(self) -> float:
        """Width of the axes [in]."""
        return float(self.ax.get_position().width * self.ax.figure.get_figwidth())

    def _pixel(self, point: Vec3) -> tuple[float, float]:
        column, row, _ = self.viewpoint.project(np.array([point]), PIXELS)[0]
        return (float(column), float(row))


def _overlap(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def draw_overview(ax: Axes, world: World, azimuth: float, profile: str) -> Overview:
    """Draw the house from the direction ``azimuth`` [rad]; limits and aspect of the axes are set here."""
    viewpoint = framing.frame_house(world.house, azimuth, PIXELS)
    fine = _FINER if profile == "fast" else 1  # the other profile has smooth edges of its own
    picture = world.overview(viewpoint, "rgb", (fine * PIXELS[0], fine * PIXELS[1]), profile)
    ax.imshow(cv2.resize(picture, PIXELS, interpolation=cv2.INTER_AREA), interpolation="none")
    ax.set_xlim(-0.5, PIXELS[0] - 0.5)
    ax.set_ylim(PIXELS[1] - 0.5, -0.5)
    ax.axis("off")
    return Overview(ax=ax, world=world, viewpoint=viewpoint)
