"""Windows, curtains, pictures, towels and switches on the free parts of walls."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from msgspec import Struct

from hthor.houses.checks.polygons import distance_to_outline
from hthor.houses.generator.draws import Dice
from hthor.houses.generator.floorplan.doors import Door, inward
from hthor.houses.generator.floorplan.layout import OUTSIDE, FloorPlan, Seam
from hthor.houses.generator.floorplan.room_specs import BATHROOM, BEDROOM, KITCHEN, LIVING
from hthor.houses.generator.furnishing.floor_space import GAP_M, RoomSpace
from hthor.houses.generator.furnishing.item_styles import SIZES, ItemStyler
from hthor.houses.generator.furnishing.pieces import Piece, Rect
from hthor.houses.space.solids import WALL_M
from hthor.types import Vec2

_FACE_M = WALL_M / 2
_END_M = 0.25
_OVER_M = 1.48
"""Height of the lower edge of things that hang over a worktop."""
_PICTURE_M = 1.58
"""Height of a picture's middle."""
_STEP_M = 0.1
_COUNTS = {KITCHEN: (0.05, 0.5, 0.45), LIVING: (0.0, 0.3, 0.7), BEDROOM: (0.0, 0.5, 0.5), BATHROOM: (0.55, 0.45, 0.0)}
"""Shares of rooms with 0, 1 and 2 windows."""
_EXTRA_M = {"tv_stand": 0.85, "counter_top": 0.1}
"""Height added to a thing in front of a window, for small things that will stand on it."""


class Window(Struct, frozen=True):
    """A window of ``room`` from ``a`` to ``b`` [m] along a seam, and the heights it spans."""

    room: int
    seam: Seam
    a: Vec2
    b: Vec2
    low: float
    high: float

    @property
    def pane(self) -> Rect:
        """The floor under the window, 0.1 m wider on all sides."""
        (ax, ay), (bx, by) = self.a, self.b
        return (min(ax, bx) - 0.1, min(ay, by) - 0.1, max(ax, bx) + 0.1, max(ay, by) + 0.1)


class _Face(Struct, frozen=True):
    """A wall's face: a line from ``p`` along ``u``, the room on the side of ``n``."""

    p: Vec2
    u: Vec2
    n: Vec2
    length: float

    @property
    def yaw(self) -> float:
        """Yaw of things that hang there and face the room [rad]."""
        return math.atan2(self.n[1], self.n[0]) - math.pi / 2

    def rect(self, begin: float, end: float, out: float, depth: float) -> Rect:
        """The floor between two marks along the line, from ``out`` to ``out + depth`` off it [m]."""
        xs = [self.p[0] + self.u[0] * s + self.n[0] * t for s in (begin, end) for t in (out, out + depth)]
        ys = [self.p[1] + self.u[1] * s + self.n[1] * t for s in (begin, end) for t in (out, out + depth)]
        return (min(xs), min(ys), max(xs), max(ys))

    def point(self, along: float, out: float = 0.0) -> Vec2:
        """The point at ``along`` on the line, ``out`` off it [m]."""
        return (
            round(self.p[0] + self.u[0] * along + self.n[0] * out, 4),
            round(self.p[1] + self.u[1] * along + self.n[1] * out, 4),
        )


class WallDecorator:
    """The walls of one room while things are hung on them. ``windows`` are the room's windows."""

    def __init__(
        self, space: RoomSpace, plan: FloorPlan, doors: Sequence[Door], maker: ItemStyler, height: float
    ) -> None:
        self._space, self._plan, self._maker, self._height = space, plan, maker, height
        self._doors = [door for door in doors if space.room.number in (door.room0, door.room1)]
        self.windows: list[Window] = []

    def _faces(self, *, outer: bool) -> Iterator[tuple[_Face, Seam]]:
        number = self._space.room.number
        for seam in self._plan.seams:
            if number in (seam.left, seam.right) and (not outer or OUTSIDE in (seam.left, seam.right)):
                (ax, ay), (bx, by) = seam.a, seam.b
                u = ((bx - ax) / seam.length, (by - ay) / seam.length)
                sign = 1.0 if seam.left == number else -1.0
                yield _Face(seam.a, u, (-sign * u[1], sign * u[0]), seam.length), seam

    def _clear(self, rect: Rect, low: float, high: float, *, glass: bool = False) -> bool:
        """Whether no thing and no door is in this space."""
        for piece in self._space.pieces:
            top = piece.top + (_EXTRA_M.get(piece.kind, 0.0) if glass or piece.kind == "tv_stand" else 0.0)
            if _meet(rect, piece.rect) and piece.bottom < high and top > low:
                return False
        taken = (*(window.pane for window in self.windows), *self._space.doorways)
        return not any(_meet(rect, other) for other in taken)

    def glaze(self, dice: Dice) -> None:
        """Add windows, some with curtains."""
        kind = self._space.room.kind
        for number in range(dice.weighted((0, 1, 2), _COUNTS[kind], "count")):
            own = dice.of(number)
            width = 0.7 if kind == BATHROOM else own.pick((1.0, 1.2, 1.4, 1.6, 1.8), "width")
            low, high = (1.55, 2.1) if kind == BATHROOM else (1.02, 2.12)
            for wide in (width, 0.8):
                spots = [
                    (face, seam, s)
                    for face, seam in self._faces(outer=True)
                    for s in np.arange(_END_M, face.length - _END_M - wide + 1e-6, _STEP_M).round(2).tolist()
                    if self._clear(face.rect(s - 0.05, s + wide + 0.05, 0.0, 0.2), low, high, glass=True)
                ]
                if spots:
                    face, seam, s = own.pick(spots, "spot", round(100 * wide))
                    ends = face.point(s), face.point(s + wide)
                    self.windows.append(Window(self._space.room.number, seam, *ends, low, high))
                    if kind != BATHROOM and own.chance(0.35, "curtains"):
                        self._drape(face, s, s + wide, high)
                    break

    def _drape(self, face: _Face, begin: float, end: float, high: float) -> None:
        """Add a curtain at each side of a window, long curtains if furniture leaves space."""
        for size in ((28, 8, 160), (28, 8, 125)):
            bottom = high + 0.1 - size[2] / 100
            spans = ((begin - 0.26, begin + 0.02), (end - 0.02, end + 0.26))
            rects = [face.rect(*span, _FACE_M + 0.005, 0.1) for span in spans]
            taken = [
                *(window.pane for window in self.windows[:-1] if window.seam == self.windows[-1].seam),
                *(box[:4] for box in self._space.swept if box[5] > bottom and box[4] < high),
                *self._space.doorways,
            ]
            for piece in self._space.pieces:
                if (piece.top > bottom - 0.01 or piece.sort.receptacle) and piece.bottom < high + 0.1:
                    taken.append(piece.rect)
            on_face = spans[0][0] > _FACE_M + 0.02 and spans[1][1] < face.length - _FACE_M - 0.02
            if on_face and not any(_meet(rect, other) for rect in rects for other in taken):
                self._space.hang([self._flat("curtain", face, sum(span) / 2, bottom, size) for span in spans])
                return

    def decorate(self, dice: Dice) -> None:
        """Add pictures, towels and light switches."""
        room = self._space.room
        if room.kind == BATHROOM:
            self._mirror()
            self._towels(dice.of("towels"))
        else:
            if room.kind == KITCHEN and dice.chance(0.75, "cabinets"):
                self._cabinets()
            share = {KITCHEN: (0.5, 0.4, 0.1), LIVING: (0.1, 0.55, 0.35), BEDROOM: (0.3, 0.5, 0.2)}[room.kind]
            for number in range(dice.weighted((0, 1, 2), share, "paintings")):
                self._picture(dice.of("painting", number), number)
        if dice.chance(0.6, "switch"):
            self._switch(dice.of("switch"))

    def _backed(self, *kinds: str) -> Iterator[tuple[Piece, _Face]]:
        """Things of these kinds with their backs to a wall, and the wall's face, measured from their middle."""
        for piece in [piece for piece in self._space.pieces if piece.kind in kinds]:
            n = (-math.sin(piece.yaw), math.cos(piece.yaw))
            depth = piece.size[1] / 2 + GAP_M + _FACE_M
            foot = (piece.middle[0] - n[0] * depth, piece.middle[1] - n[1] * depth)
            if distance_to_outline(foot, self._space.room.polygon) < 0.01:
                yield piece, _Face(foot, (n[1], -n[0]), n, 0.0)

    def _cabinets(self) -> None:
        """Add wall cabinets over the counters, and a hood over the stove."""
        for piece, face in self._backed("counter_top", "stove"):
            hood, w = piece.kind == "stove", piece.size[0]
            count = 1 if hood else int((w - 0.12) / 0.6)
            size = (60, 48, 60) if hood else (60, 35, 70)
            for k in range(count):
                s = (k - (count - 1) / 2) * 0.604
                low, high = _OVER_M, _OVER_M + size[2] / 100
                rect = face.rect(s - 0.301, s + 0.301, _FACE_M, size[1] / 100 + (0.0 if hood else 0.3))
                if high < self._height - 0.05 and self._clear(rect, low, high):
                    self._space.hang([self._flat("range_hood" if hood else "kitchen_cabinet", face, s, low, size)])

    def _mirror(self) -> None:
        for _, face in self._backed("sink"):
            if self._clear(face.rect(-0.31, 0.31, 0.0, 0.14), 1.2, 2.0):
                self._space.hang([self._flat("mirror", face, 0.0, 1.2, (60, 4, 80))])

    def _picture(self, dice: Dice, number: int) -> None:
        size = dice.pick(SIZES["painting"], "size")
        w, h = size[0] / 100, size[2] / 100
        low, high = _PICTURE_M - h / 2, _PICTURE_M + h / 2
        spots, weights = [], []
        for face, _ in self._faces(outer=False):
            for s in np.arange(0.2 + w / 2, face.length - 0.2 - w / 2, _STEP_M).round(2).tolist():
                if self._clear(face.rect(s - w / 2 - 0.08, s + w / 2 + 0.08, 0.0, 0.14), low - 0.05, high + 0.05):
                    spots.append((face, s))
                    weights.append(12.0 if self._above(face, s) else 1.0)
        if spots:
            face, s = dice.weighted(spots, weights, "spot")
            self._space.hang([self._flat("painting", face, s, low, size, self._space.room.number, number)])

    def _above(self, face: _Face, along: float) -> bool:
        """Whether the middle of a low thing at the wall is directly below."""
        x, y = face.point(along, _FACE_M + 0.1)
        for piece in self._space.pieces:
            x0, y0, x1, y1 = piece.rect
            if x0 <= x <= x1 and y0 <= y <= y1 and 0.4 <= piece.top < 1.1:
                off = (piece.middle[0] - x) * face.u[0] + (piece.middle[1] - y) * face.u[1]
                return abs(off) < 0.08
        return False

    def _towels(self, dice: Dice) -> None:
        spots = [
            (face, s)
            for face, _ in self._faces(outer=False)
            for s in np.arange(0.45, face.length - 0.45, _STEP_M).round(2).tolist()
            if self._clear(face.rect(s - 0.3, s + 0.3, 0.0, 0.2), 0.6, 1.4)
        ]
        if spots:
            face, s = dice.pick(spots, "spot")
            hung = [self._flat("towel_holder", face, s, 1.3, (55, 8, 5))]
            if dice.chance(0.8, "towel"):
                hung.append(self._flat("towel", face, s, 0.69, (50, 4, 60)))
            self._space.hang(hung)

    def _switch(self, dice: Dice) -> None:
        """Add a switch next to the doorway, where the leaf does not hide it."""
        number = self._space.room.number
        for door in [door for door in dice.order(self._doors, "door") if door.sort != "open"]:
            u = ((door.b[0] - door.a[0]) / door.width, (door.b[1] - door.a[1]) / door.width)
            face = _Face(door.a, u, inward(door, number), door.width)
            ends = (door.width + 0.16, -0.16) if door.sort == "leaf" else (-0.16, door.width + 0.16)
            for s in ends[: 1 if door.sort == "leaf" else 2]:
                reach = math.dist(door.seam.a, door.seam.b)
                x, y = face.point(s)
                offset = (x - door.seam.a[0]) * (door.seam.b[0] - door.seam.a[0]) / reach
                offset += (y - door.seam.a[1]) * (door.seam.b[1] - door.seam.a[1]) / reach
                rect = face.rect(s - 0.06, s + 0.06, _FACE_M + 0.002, 0.03)
                taken = any(_meet(rect, piece.rect) and piece.top > 1.0 for piece in self._space.pieces)
                if 0.12 < offset < reach - 0.12 and not taken:
                    self._space.hang([self._flat("light_switch", face, s, 1.06, (8, 2, 12))])
                    return

    def _flat(
        self, kind: str, face: _Face, along: float, bottom: float, size: tuple[int, int, int], *names: str | int
    ) -> Piece:
        middle = face.point(along, _FACE_M + size[1] / 200)
        return self._maker.make(kind, *names, middle=middle, yaw=face.yaw, bottom=round(bottom, 3), size=size)


def _meet(one: Rect, two: Rect) -> bool:
    return min(one[2], two[2]) - max(one[0], two[0]) > 1e-6 and min(one[3], two[3]) - max(one[1], two[1]) > 1e-6
