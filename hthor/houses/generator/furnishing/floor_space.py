"""The free floor of one room while it is being furnished.

Rectangles are upright in the house frame [m]: x0, y0, x1, y1, and the heights z0, z1 between which they count.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hthor.houses.generator.draws import Dice
from hthor.houses.generator.floorplan.doors import Door, inward, leaf, zones
from hthor.houses.generator.floorplan.layout import FloorPlan, RoomPlan
from hthor.houses.generator.furnishing.pieces import Box, Piece, PieceGroup, Rect, move_piece, swept_boxes_of_piece
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.solids import WALL_M
from hthor.types import Vec2

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

GAP_M = 0.02
"""Least gap between furniture, and between furniture and a wall's face."""
RADIUS_M = 0.30
"""Radius [m] of the body that must still be able to walk everywhere."""
_STEP_M = 0.1
_DOOR_M = 0.35
_HIGH_M = 3.0
_BODY_M = 1.8
_TRIES = 12
_SWING_M = 0.13
"""The space that a door needs next to it to open wider than a right angle."""


class RoomSpace:
    """A room, the things in it, and the floor that must stay free.

    Attributes:
        pieces: the placed pieces, in order. solids, keeps: (N, 6) rectangles.
        doorways: floor that must stay free at the doors. swept: space that furniture's doors and drawers need.
    """

    def __init__(self, room: RoomPlan, plan: FloorPlan, doors: Sequence[Door], space: FreeSpace) -> None:
        self.room, self._plan, self._space = room, plan, space
        self.pieces: list[Piece] = []
        self.walls = _slabs(room)
        mine = [door for door in doors if room.number in (door.room0, door.room1)]
        leaves = [leaf(door) for door in mine if door.sort == "leaf" and door.room0 == room.number]
        self.solids = np.array([*self.walls, *((*rect, 0.0, _HIGH_M) for rect in leaves)])
        kept = [zone[1:] for door in mine for zone in zones(door) if zone[0] == room.number]
        self.doorways: tuple[Rect, ...] = tuple(kept)
        self.keeps = np.array([(*rect, 0.0, _HIGH_M) for rect in kept]).reshape(-1, 6)
        self._free, self._origin = self._crop()
        for rect in leaves:
            self._block(self._free, rect)
        self._doors = [self._inside(door) for door in mine if door.sort != "outside"]
        self._served: list[Rect] = []
        self.swept: list[Box] = []

    def _crop(self) -> tuple[Bools, Vec2]:
        xs, ys = zip(*self.room.polygon, strict=True)
        cell = self._space.cell
        j0, i0 = self._space.cell_of(min(xs) - 2 * cell, min(ys) - 2 * cell)
        j1, i1 = self._space.cell_of(max(xs) + 2 * cell, max(ys) + 2 * cell)
        j0, i0 = max(j0, 0), max(i0, 0)
        free = self._space.free[j0 : j1 + 1, i0 : i1 + 1].copy()
        origin = (self._space.origin[0] + i0 * cell, self._space.origin[1] + j0 * cell)
        ys_, xs_ = (origin[axis] + (np.arange(free.shape[1 - axis]) + 0.5) * cell for axis in (1, 0))
        labels, scale = self._plan.labels, self._plan.scale
        rows = np.clip((ys_ / scale).astype(int), 0, labels.shape[0] - 1)
        columns = np.clip((xs_ / scale).astype(int), 0, labels.shape[1] - 1)
        free &= labels[rows][:, columns] == self.room.number
        return free, origin

    def _inside(self, door: Door) -> Vec2:
        nx, ny = inward(door, self.room.number)
        return ((door.a[0] + door.b[0]) / 2 + nx * _DOOR_M, (door.a[1] + door.b[1]) / 2 + ny * _DOOR_M)

    def place(self, group: PieceGroup, dice: Dice, wish: Any = None) -> bool:
        """Put the group at a random good place; False when there is no place.

        Args:
            wish: gives a bonus (N,) for origins (N, 2), turns (N,) [quarter turns]; None for none.
        """
        for anchor in group.anchors:
            origins, turns = self._origins(group, anchor)
            if not len(origins):
                continue
            keep = self._suits(group, origins, turns)
            origins, turns = origins[keep], turns[keep]
            if not len(origins):
                continue
            scores = dice.scatter(len(origins), group.name, anchor)
            if wish is not None:
                scores = scores + wish(origins, turns)
            for index in np.argsort(-scores, kind="stable")[:_TRIES]:
                if self._settle(group, origins[index], int(turns[index])):
                    return True
        return False

    def _settle(self, group: PieceGroup, origin: Floats, quarter: int) -> bool:
        at, yaw = (float(origin[0]), float(origin[1])), quarter * math.pi / 2
        pieces = [move_piece(piece, at, yaw) for piece in group.pieces]
        free = self._free.copy()
        for piece in pieces:
            if piece.bottom < _BODY_M:
                self._block(free, piece.rect)
        served = [_turned(rect, at, quarter) for rect in group.free[: group.serve]]
        claims = [*self._served, *served]
        if not self._reachable(free, claims):
            return False
        self._free, self._served = free, claims
        self.pieces += pieces
        self.solids = np.vstack([self.solids, [(*p.rect, p.bottom, p.top) for p in pieces]])
        kept = [(*_turned(rect, at, quarter), 0.0, _HIGH_M) for rect in group.free]
        swept = [box for piece in pieces for box in swept_boxes_of_piece(piece)]
        self.swept += swept
        kept += swept
        self.keeps = np.vstack([self.keeps, np.array(kept).reshape(-1, 6)])
        return True

    def spread(self, piece: Piece, near: Vec2, within: float, dice: Dice) -> bool:
        """Lay a flat thing on free floor as near to a place as possible, at most ``within`` [m]; it blocks nothing."""
        origins, turns = self._middles(0.1)
        w, d, _ = piece.size
        boxes = _placed((-w / 2 - GAP_M, -d / 2 - GAP_M, w / 2 + GAP_M, d / 2 + GAP_M), origins, turns)
        good = self._indoors(origins) & ~_hits(boxes, self.solids, 0.0, _HIGH_M)
        zones = np.array([(*rect, 0.0, 1.0) for rect in self.doorways]).reshape(-1, 6)
        origins, turns = origins[good & ~_hits(boxes, zones, 0.0, 1.0)], turns[good & ~_hits(boxes, zones, 0.0, 1.0)]
        if not len(origins):
            return False
        far = np.hypot(*(origins - np.array(near)).T)
        best = int(np.argmin(far + 0.1 * dice.scatter(len(far), "spread")))
        if far[best] > within:
            return False
        at = (float(origins[best][0]), float(origins[best][1]))
        self.pieces.append(move_piece(piece, at, int(turns[best]) * math.pi / 2))
        return True

    def hang(self, pieces: Sequence[Piece]) -> None:
        """Add things on walls to the things in the room."""
        self.pieces += pieces
        self.solids = np.vstack([self.solids, [(*p.rect, p.bottom, p.top) for p in pieces]])

    def _origins(self, group: PieceGroup, anchor: str) -> tuple[Floats, NDArray[np.int64]]:
        if anchor == "middle":
            return self._middles(0.2)
        x0, y0, x1, _ = group.extent
        margin = WALL_M / 2 + GAP_M
        origins: list[Floats] = []
        turns: list[int] = []
        polygon = self.room.polygon
        for k, (p, q) in enumerate(zip(polygon, (*polygon[1:], polygon[0]), strict=True)):
            length = math.dist(p, q)
            d = np.array([(q[0] - p[0]) / length, (q[1] - p[1]) / length])
            quarter = round(math.atan2(d[1], d[0]) / (math.pi / 2)) % 4
            low, high = margin - x0, length - margin - x1
            if high < low - 1e-9:
                continue
            along = np.append(np.arange(low, high, _STEP_M), high)
            if anchor != "wall":
                left = anchor in ("corner", "left") and self._convex(k)
                right = anchor in ("corner", "right") and self._convex((k + 1) % len(polygon))
                ends = [low, low + _SWING_M] * left + [high, high - _SWING_M] * right
                along = np.array([s for s in ends if low - 1e-9 <= s <= high + 1e-9])
            inner = np.array([-d[1], d[0]])
            origins.append(np.array(p) + along[:, None] * d + (margin - y0) * inner)
            turns += [quarter] * len(along)
        return (np.concatenate(origins).reshape(-1, 2) if origins else np.zeros((0, 2))), np.array(turns, dtype=int)

    def _convex(self, k: int) -> bool:
        polygon = self.room.polygon
        (px, py), (x, y), (qx, qy) = polygon[k - 1], polygon[k], polygon[(k + 1) % len(polygon)]
        return (x - px) * (qy - y) - (y - py) * (qx - x) > 0.0

    def _middles(self, step: float) -> tuple[Floats, NDArray[np.int64]]:
        xs, ys = zip(*self.room.polygon, strict=True)
        us, vs = np.arange(min(xs) + 0.4, max(xs), step), np.arange(min(ys) + 0.4, max(ys), step)
        grid = np.array(np.meshgrid(us, vs)).reshape(2, -1).T
        return np.concatenate([grid] * 4), np.repeat(np.arange(4), len(grid))

    def _suits(self, group: PieceGroup, origins: Floats, turns: NDArray[np.int64]) -> Bools:
        good = np.ones(len(origins), dtype=bool)
        for piece in group.pieces:
            x0, y0, x1, y1 = piece.rect
            boxes = _placed((x0, y0, x1, y1), origins, turns)
            good &= self._indoors((boxes[:, :2] + boxes[:, 2:]) / 2)
            grown = boxes + np.array([-GAP_M, -GAP_M, GAP_M, GAP_M]) * 0.9
            good &= ~_hits(grown, self.solids, piece.bottom, piece.top)
            good &= ~_hits(boxes, self.keeps, piece.bottom, piece.top)
            for x0, y0, x1, y1, low, high in swept_boxes_of_piece(piece):
                good &= ~_hits(_placed((x0, y0, x1, y1), origins, turns), self.solids, low, high)
        for rect in group.free:
            boxes = _placed(rect, origins, turns)
            good &= self._indoors((boxes[:, :2] + boxes[:, 2:]) / 2)
            good &= ~_hits(boxes, self.solids, 0.0, _HIGH_M)
        for rect in group.backs:
            good &= _hits(_placed(rect, origins, turns), np.array(self.walls), 0.0, _HIGH_M)
        return good

    def _indoors(self, places: Floats) -> Bools:
        labels, scale = self._plan.labels, self._plan.scale
        columns, rows = np.floor(places / scale).astype(int).T
        within = (rows >= 0) & (rows < labels.shape[0]) & (columns >= 0) & (columns < labels.shape[1])
        found = labels[np.clip(rows, 0, labels.shape[0] - 1), np.clip(columns, 0, labels.shape[1] - 1)]
        inside: Bools = within & (found == self.room.number)
        return inside

    def _cells(self, rect: Rect, margin: float) -> tuple[slice, slice]:
        cell = self._space.cell
        i0, i1 = ((rect[k] + s * margin - self._origin[0]) / cell for k, s in ((0, -1), (2, 1)))
        j0, j1 = ((rect[k] + s * margin - self._origin[1]) / cell for k, s in ((1, -1), (3, 1)))
        return slice(max(math.floor(j0), 0), max(math.ceil(j1), 0)), slice(
            max(math.floor(i0), 0), max(math.ceil(i1), 0)
        )

    def _block(self, free: Bools, rect: Rect) -> None:
        rows, columns = self._cells(rect, RADIUS_M)
        view, cell = free[rows, columns], self._space.cell
        x = self._origin[0] + (columns.start + np.arange(view.shape[1]) + 0.5) * cell
        y = self._origin[1] + (rows.start + np.arange(view.shape[0]) + 0.5) * cell
        dx = np.maximum(np.maximum(rect[0] - x, x - rect[2]), 0.0)
        dy = np.maximum(np.maximum(rect[1] - y, y - rect[3]), 0.0)
        view[np.hypot(dx[None, :], dy[:, None]) < RADIUS_M] = False

    def _reachable(self, free: Bools, claims: Sequence[Rect]) -> bool:
        """Whether one connected stretch of floor joins all doors, and comes to every rectangle of ``claims``."""
        from skimage.measure import label  # late: a slow import

        labels = label(free, connectivity=1)
        cell, marks = self._space.cell, []
        for x, y in self._doors:
            i, j = int((x - self._origin[0]) / cell), int((y - self._origin[1]) / cell)
            marks.append(int(labels[j, i]) if 0 <= j < labels.shape[0] and 0 <= i < labels.shape[1] else 0)
        if not marks or marks[0] == 0 or len(set(marks)) > 1:
            return False
        main = labels == marks[0]
        return all(main[self._cells(rect, 0.0)].any() for rect in claims)


def _slabs(room: RoomPlan) -> list[tuple[float, ...]]:
    half = WALL_M / 2
    slabs: list[tuple[float, ...]] = []
    for (ax, ay), (bx, by) in zip(room.polygon, (*room.polygon[1:], room.polygon[0]), strict=True):
        slabs.append((min(ax, bx) - half, min(ay, by) - half, max(ax, bx) + half, max(ay, by) + half, 0.0, _HIGH_M))
    return slabs


def _turned(rect: Rect, origin: Vec2, quarter: int) -> Rect:
    x0, y0, x1, y1 = (float(v) for v in _placed(rect, np.array([origin]), np.array([quarter]))[0])
    return (x0, y0, x1, y1)


def _placed(rect: Rect, origins: Floats, turns: NDArray[np.int64]) -> Floats:
    """(N, 4) a rectangle of a group's frame, for groups at these origins with these quarter turns."""
    x0, y0, x1, y1 = rect
    four = np.array([(x0, y0, x1, y1), (-y1, x0, -y0, x1), (-x1, -y1, -x0, -y0), (y0, -x1, y1, -x0)])
    placed: Floats = four[turns] + np.tile(origins, (1, 2))
    return placed


def _hits(boxes: Floats, others: Floats, low: float, high: float) -> Bools:
    """(N,) whether boxes (N, 4) share floor with any of the others (M, 6) that overlap the heights low to high."""
    rivals = others[(others[:, 4] < high) & (others[:, 5] > low)]
    x = np.minimum(boxes[:, None, 2], rivals[None, :, 2]) - np.maximum(boxes[:, None, 0], rivals[None, :, 0])
    y = np.minimum(boxes[:, None, 3], rivals[None, :, 3]) - np.maximum(boxes[:, None, 1], rivals[None, :, 1])
    hit = (x > 1e-6) & (y > 1e-6)
    return np.asarray(hit.any(axis=1), dtype=np.bool_)
