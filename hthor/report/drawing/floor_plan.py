"""Draws a house from above as a floor plan, and adds room names and a scale to a picture of a house."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from matplotlib import patheffects
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Polygon

from hthor import catalog
from hthor.geometry import plane
from hthor.report.drawing import lettering, trial_trace
from hthor.types import HouseSpec, Opening, Room, Thing, Vec2

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FLOORS = {"kitchen": "#f6ecd9", "living_room": "#eef1e3", "bedroom": "#e9edf4", "bathroom": "#e3f0f0"}
MARKED, MARKED_EDGE, MARKED_FLOOR = "#bfe3d4", "#00795a", "#dcf0e6"
WALL_PT, SMALL_WALL_PT = 3.2, 1.6
_NAME_PT, _SMALL_NAME_PT = 8.5, 6.5
_FURNITURE, _EDGE = "#d9d4cb", "#a8a196"
RUG, RUG_EDGE, RUG_HATCH = "#faf7f0", "#cdc6b8", "////"
_FLAT_M = 0.05
"""Things that are no higher, such as rugs and mats, can be walked and driven over."""
_DPI, _STRIP_PX = 100, 34
_LABEL_STROKE: list[patheffects.AbstractPathEffect] = [patheffects.withStroke(linewidth=2.6, foreground="white")]
_TITLE_CHARACTERS = 8.0
"""Approximate width of a character of the title [px]."""


def draw_house(ax: Axes, house: HouseSpec, *, marked: Collection[str] = (), small: bool = False) -> None:
    """Draw rooms, walls, openings and furniture to scale.

    Args:
        ax: axes in metres of the house frame; limits and aspect are set here.
        marked: ids of things and rooms to draw in the accent colour: a task's destinations.
        small: for a plan of a few inches, with thin walls and without the names of things.
    """
    wall_pt = SMALL_WALL_PT if small else WALL_PT
    for room in house.rooms:
        shade = MARKED_FLOOR if room.id in marked else FLOORS.get(room.kind, "#eeeeee")
        ax.add_patch(Polygon(room.polygon, closed=True, facecolor=shade, edgecolor="none"))
    for thing in sorted(house.things, key=lambda thing: thing.centre[2]):
        if not thing.parent:
            _draw_thing(ax, thing, thing.id in marked)
    for thing in house.things:
        if thing.kind in catalog.RECEPTACLES and thing.id not in marked and not small:
            _label(ax, thing)
    for wall in house.walls:
        ax.plot(
            *zip(wall.a, wall.b, strict=True), color=trial_trace.INK, lw=wall_pt, solid_capstyle="projecting", zorder=4
        )
    for opening in house.openings:
        _draw_opening(ax, opening, wall_pt)
    for room in house.rooms:
        _name_room(ax, room, house, _SMALL_NAME_PT if small else _NAME_PT)
    _frame(ax, house)


def _draw_thing(ax: Axes, thing: Thing, marked: bool) -> None:
    if thing.centre[2] - thing.size[2] / 2 > 1.2:
        return  # pictures and lamps overhead would hide what stands below
    outline = plane.rectangle((thing.centre[0], thing.centre[1]), (thing.size[0], thing.size[1]), thing.yaw)
    if is_flat(thing):
        ax.add_patch(
            Polygon(outline, closed=True, facecolor=RUG, edgecolor=RUG_EDGE, hatch=RUG_HATCH, lw=0.6, ls="--", zorder=1)
        )
        return
    face, edge = (MARKED, MARKED_EDGE) if marked else (_FURNITURE, _EDGE)
    ax.add_patch(
        Polygon(
            outline, closed=True, facecolor=face, edgecolor=edge, lw=1.4 if marked else 0.7, zorder=2, joinstyle="round"
        )
    )
    front = _front_line(thing)
    ax.plot(*zip(*front, strict=True), color=edge, lw=0.7, zorder=2.1)


def is_flat(thing: Thing) -> bool:
    """Whether a thing only covers the floor, so that people and robots move over it."""
    return not thing.parent and thing.centre[2] + thing.size[2] / 2 <= _FLAT_M


def _front_line(thing: Thing) -> tuple[Vec2, Vec2]:
    """A thin line along the front edge, which shows the way that a sofa or a fridge faces."""
    width, depth = thing.size[0], thing.size[1]
    inset = min(0.08, depth * 0.15)
    a, b = (
        plane.to_house((sx * (width / 2 - inset), depth / 2 - inset, 0.0), thing.centre, thing.yaw)
        for sx in (-1.0, 1.0)
    )
    return (a[0], a[1]), (b[0], b[1])


def _label(ax: Axes, thing: Thing) -> None:
    """Write the name of a receptacle along its longer side."""
    outline = plane.rectangle((thing.centre[0], thing.centre[1]), (thing.size[0], thing.size[1]), thing.yaw)
    wide, deep = (max(axis) - min(axis) for axis in zip(*outline, strict=True))
    turned = 90.0 if deep > 1.2 * wide else 0.0
    x, y, _ = thing.centre
    ax.text(x, y, title(thing.kind), ha="center", va="center", rotation=turned, fontsize=5.2, color="#8b8478", zorder=3)


def _draw_opening(ax: Axes, opening: Opening, wall_pt: float) -> None:
    (ax0, ay0), (bx, by) = opening.a, opening.b
    xs, ys = (ax0, bx), (ay0, by)
    if opening.kind == "window":
        ax.plot(xs, ys, color="white", lw=wall_pt - 1.0, solid_capstyle="butt", zorder=5)
        ax.plot(xs, ys, color="#6fa8c9", lw=0.9, solid_capstyle="butt", zorder=5.1)
    elif opening.passable:
        ax.plot(xs, ys, color="#f4f1ea", lw=wall_pt + 0.6, solid_capstyle="butt", zorder=5)
    else:
        ax.plot(xs, ys, color="#8a6d4b", lw=wall_pt, solid_capstyle="butt", zorder=5)
        width = math.dist(opening.a, opening.b)
        heading = math.degrees(math.atan2(by - ay0, bx - ax0))
        ax.add_patch(Arc(opening.a, 2 * width, 2 * width, angle=heading, theta1=-35, theta2=0, color="#8a6d4b", lw=0.6))


def _name_room(ax: Axes, room: Room, house: HouseSpec, size: float) -> None:
    x, y = quiet_spot(room, house)
    text = ax.text(x, y, room.name, ha="center", va="center", fontsize=size, color="#5d6470", style="italic", zorder=6)
    text.set_path_effects([patheffects.withStroke(linewidth=2.5, foreground=FLOORS.get(room.kind, "#eeeeee"))])


def quiet_spot(room: Room, house: HouseSpec) -> Vec2:
    """The middle of the room's largest patch of bare floor; wide patches are preferred because names are wide."""
    xs, ys = [x for x, _ in room.polygon], [y for _, y in room.polygon]
    scale, squeeze = 20.0, 0.45

    def pixels(points: Any) -> Any:
        plan = np.array(points, dtype=float) - (min(xs), min(ys))
        return np.round(plan * (scale * squeeze, scale)).astype(np.int32)

    corners = pixels(room.polygon)
    bare = np.zeros((corners[:, 1].max() + 3, corners[:, 0].max() + 3), np.uint8)
    cv2.fillPoly(bare, [corners + 1], 1)
    for thing in house.things:
        if thing.room == room.id and not thing.parent:
            centre, size = (thing.centre[0], thing.centre[1]), (thing.size[0], thing.size[1])
            cv2.fillPoly(bare, [pixels(plane.rectangle(centre, size, thing.yaw)) + 1], 0)
    far = cv2.distanceTransform(bare, cv2.DIST_L2, 5)
    row, column = np.unravel_index(int(np.argmax(far)), far.shape)
    return (float((column - 1) / (scale * squeeze) + min(xs)), float((row - 1) / scale + min(ys)))


def _frame(ax: Axes, house: HouseSpec) -> None:
    points = [point for room in house.rooms for point in room.polygon]
    xs, ys = [x for x, _ in points], [y for _, y in points]
    margin = 0.35
    ax.set_xlim(min(xs) - margin, max(xs) + margin)
    ax.set_ylim(min(ys) - margin - 0.35, max(ys) + margin)
    ax.set_aspect("equal")
    ax.axis("off")
    left, base = min(xs), min(ys) - margin
    ax.plot((left, left + 1.0), (base, base), color=trial_trace.INK, lw=1.6, solid_capstyle="butt")
    ax.text(left + 1.1, base, "1 m", va="center", fontsize=7.5, color=trial_trace.INK)


def title(kind: str) -> str:
    """The title of a kind; a kind that the catalogue lacks keeps its name."""
    return catalog.kind(kind).title if kind in catalog.names() else kind.replace("_", " ")


@lettering.plain_lettering()
def labelled_figure(
    picture: Any, house: HouseSpec, bounds: tuple[float, float, float, float], *, named: bool = True
) -> Figure:
    """The picture with room names on bare floor, and a strip below it with a scale and the house's name.

    Args:
        picture: (H, W, 3) uint8, north up. bounds: x0, y0, x1, y1 of the picture [m]. named: whether to name rooms.
    """
    high, wide = picture.shape[:2]
    x0, y0, x1, y1 = bounds
    sheet = Figure(figsize=(wide / _DPI, (high + _STRIP_PX) / _DPI), dpi=_DPI, facecolor="white")
    ax = sheet.add_axes((0.0, _STRIP_PX / (high + _STRIP_PX), 1.0, high / (high + _STRIP_PX)))
    ax.imshow(picture, extent=(x0, x1, y0, y1), interpolation="none", aspect="auto")
    ax.axis("off")
    for room in house.rooms if named else ():
        at = quiet_spot(room, house)
        text = ax.text(
            *at, room.name or room.kind, ha="center", va="center", fontsize=9, weight="bold", color=trial_trace.INK
        )
        text.set_path_effects(_LABEL_STROKE)
    strip = sheet.add_axes((0.0, 0.0, 1.0, _STRIP_PX / (high + _STRIP_PX)))
    strip.set_xlim(x0, x1)
    strip.set_ylim(0.0, 1.0)
    strip.axis("off")
    edge = 12.0 * (x1 - x0) / wide
    strip.plot((x0 + edge, x0 + edge + 1.0), (0.5, 0.5), color=trial_trace.INK, lw=2.0, solid_capstyle="butt")
    strip.text(x0 + 1.6 * edge + 1.0, 0.5, "1 m", va="center", fontsize=9, color=trial_trace.INK)
    if wide > 160 + _TITLE_CHARACTERS * len(house.id):
        xs, ys = zip(*(point for room in house.rooms for point in room.polygon), strict=True)
        words = f"{house.id}, {max(xs) - min(xs):.1f} × {max(ys) - min(ys):.1f} m"
        strip.text(x1 - edge, 0.5, words, ha="right", va="center", fontsize=9, color=trial_trace.INK)
    return sheet
