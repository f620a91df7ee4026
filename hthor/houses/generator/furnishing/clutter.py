"""Puts small things on furniture, so that every surface still has room for every target."""

import math
from collections import Counter
from collections.abc import Sequence

import msgspec
import numpy as np
from numpy.typing import NDArray

from hthor import catalog, rules
from hthor.houses.generator.draws import Dice
from hthor.houses.generator.furnishing.clutter_table import (
    BATHROOM,
    CLUTTER_RULES,
    MAX_COUNT,
    SCREENS,
    USUAL_PLACES,
    ClutterRule,
    Size,
)
from hthor.houses.generator.furnishing.item_styles import ItemStyler
from hthor.houses.generator.furnishing.pieces import Piece, swept_boxes
from hthor.houses.generator.furnishing.requirements import Requirements
from hthor.types import Surface

Floats = NDArray[np.float64]

GAP_M, EDGE_M = 0.014, 0.014
"""Least gap between things on a surface, also to a target; least distance from the surface's edge."""
_SLACK_M = 0.002
"""Tolerance below these distances when a finished house is checked."""
_STEP_M = 0.04
_COVER = 0.45
"""The share of a surface that small things may cover."""
_HEAD_M = 0.02
_TRIES = 10
_LOW_M = 0.3


class Table:
    """One piece of furniture while small things are put on it. ``room`` is its room's type."""

    def __init__(self, piece: Piece, room: str) -> None:
        self.piece, self.room = piece, room
        rests = piece.sort.rests(piece.size)
        height = piece.bottom + piece.size[2] / 2
        # Things on a shelf's lowest board are visible only from far away.
        self.surfaces = [rest for rest in rests if piece.kind != "shelf" or rest.centre[2] + height > _LOW_M]
        self.children: list[Piece] = []
        self._laid: list[list[tuple[float, ...]]] = [[] for _ in self.surfaces]
        self._swept: list[list[tuple[float, ...]]] = [[] for _ in self.surfaces]

    @property
    def habits(self) -> tuple[ClutterRule, ...]:
        """The small things that people leave on this furniture."""
        if self.room == "Bathroom" and self.piece.kind in BATHROOM:
            return BATHROOM[self.piece.kind]
        return CLUTTER_RULES.get(self.piece.kind, ())

    def lay(self, habit: ClutterRule, maker: ItemStyler, dice: Dice) -> bool:
        """Put a small thing down as the rule says; False when there is no place."""
        for k in dice.order(range(len(self.surfaces)), "surface"):
            surface, laid = self.surfaces[k], self._laid[k]
            size = _screen(self.piece) if habit.kind == "television" else habit.size
            child = maker.make(habit.kind, self.piece.asset, len(self.children), size=size)
            quarter = dice.whole(0, 3, "turn", k) if habit.spot == "any" else 0
            if habit.kind == "pillow" and self.piece.kind == "sofa":
                quarter = 0
            w, d = child.size[:2] if quarter % 2 == 0 else (child.size[1], child.size[0])
            covered = sum((x1 - x0) * (y1 - y0) for x0, y0, x1, y1, *_ in laid) + w * d
            if child.size[2] + _HEAD_M > surface.clearance:
                continue
            if covered > _COVER * 4 * surface.half[0] * surface.half[1] and habit.kind not in ("television", "pillow"):
                continue
            opens = swept_boxes(child.kind, child.size)
            if opens and quarter:
                quarter, (w, d) = 0, child.size[:2]
            ahead = max((box[3] - d / 2 for box in opens), default=0.0)
            place = _spot(surface, laid, self._swept[k], (w, d, child.size[2]), ahead, habit.spot, dice.of("place", k))
            if place is not None:
                self._swept[k] += [tuple(v + place[n % 2] for n, v in enumerate(box[:4])) for box in opens]
                laid.append((place[0] - w / 2, place[1] - d / 2, place[0] + w / 2, place[1] + d / 2, child.size[2]))
                self.children.append(self._child(child, surface, place, quarter))
                return True
        return False

    def _child(self, child: Piece, surface: Surface, place: tuple[float, float], quarter: int) -> Piece:
        """The thing in the frame of its parent, its height counted from the floor."""
        return msgspec.structs.replace(
            child,
            middle=(round(surface.centre[0] + place[0], 4), round(surface.centre[1] + place[1], 4)),
            bottom=self.piece.bottom + self.piece.size[2] / 2 + surface.centre[2],
            yaw=quarter * math.pi / 2,
        )


def _screen(stand: Piece) -> Size:
    """The largest television that leaves space next to it on its stand."""
    fitting = [size for size in SCREENS if size[0] / 100 <= stand.size[0] - 0.5]
    return fitting[-1] if fitting else SCREENS[0]


def _spot(
    surface: Surface,
    laid: list[tuple[float, ...]],
    swept: list[tuple[float, ...]],
    size: tuple[float, float, float],
    ahead: float,
    spot: str,
    dice: Dice,
) -> tuple[float, float] | None:
    """The middle of a free place of that size that still leaves places for the targets; local to the surface's middle.

    ``ahead`` [m] is the depth that the thing's door needs in front of it; ``swept`` is the space of others' doors.
    """
    spare = (surface.half[0] - size[0] / 2 - EDGE_M, surface.half[1] - size[1] / 2 - EDGE_M)
    if min(spare) < 0.0:
        return None
    axes = [np.append(np.arange(-s, s, _STEP_M), s).round(3) for s in spare]
    u, v = (axis.ravel() for axis in np.meshgrid(*axes))
    noise = dice.scatter(len(u), "noise")
    scores = {
        "any": noise,
        "back": 0.35 * noise - (v + spare[1]),
        "front": 0.15 * noise + v,
        "middle": 0.1 * noise - np.hypot(u, v) - 0.5 * np.abs(u),
        "head": 0.5 * noise - 3.0 * (v + spare[1]) + 0.6 * np.abs(u),
    }[spot]
    free = _clear(u, v, size[:2], [*laid, *swept]) & _clear(u, v + ahead / 2, (size[0], size[1] + ahead), laid)
    order = [int(k) for k in np.argsort(-scores, kind="stable") if free[k]]
    stride = max(1, len(order) // 40) if spot == "middle" else 1
    for k in order[: _TRIES * stride : stride]:
        box = (u[k] - size[0] / 2, v[k] - size[1] / 2, u[k] + size[0] / 2, v[k] + size[1] / 2, size[2])
        if all_fit(surface, [*laid, box]):
            return (float(u[k]), float(v[k]))
    return None


def _clear(u: Floats, v: Floats, size: Sequence[float], laid: Sequence[Sequence[float]]) -> NDArray[np.bool_]:
    free = np.ones(len(u), dtype=bool)
    for x0, y0, x1, y1, *_ in laid:
        out = (u + size[0] / 2 + GAP_M <= x0) | (u - size[0] / 2 - GAP_M >= x1)
        free &= out | (v + size[1] / 2 + GAP_M <= y0) | (v - size[1] / 2 - GAP_M >= y1)
    return free


def all_fit(surface: Surface, laid: Sequence[Sequence[float]], *, strict: bool = False) -> bool:
    """Whether every target finds a place among the boxes put on a surface.

    A target for which even the empty surface has no place counts only when ``strict``.
    Places are looked for on the grid on which objects are put down: square to the surface, from its middle outwards.
    """
    for name in catalog.TARGETS:
        w, d, h = catalog.kind(name).size
        slack = _SLACK_M if strict else 0.0
        spare = (surface.half[0] - w / 2 - EDGE_M + slack, surface.half[1] - d / 2 - EDGE_M + slack)
        if min(spare) < 0.0 or h + _HEAD_M > surface.clearance:
            if strict:
                return False
            continue
        counts = [math.floor(s / rules.GRID_M) for s in spare]
        u, v = (axis.ravel() for axis in np.meshgrid(*(np.arange(-n, n + 1) * rules.GRID_M for n in counts)))
        if not _clear(u, v, (w - 2 * slack, d - 2 * slack), laid).any():
            return False
    return True


def place_clutter(tables: Sequence[Table], wants: Requirements, maker: ItemStyler, dice: Dice) -> str:
    """Put small things on all tables; returns the first required kind without a place, or an empty string."""
    count: Counter[str] = Counter()
    for kind, homes in USUAL_PLACES.items():
        if kind in wants.must and not _need(kind, homes, tables, maker, dice.of("need", kind)):
            return kind
        count[kind] += kind in wants.must
    zeal = dice.between(0.45, 0.85, "zeal")
    for number, table in enumerate(tables):
        for row, habit in enumerate(table.habits):
            own = dice.of(number, row)
            had = sum(child.kind == habit.kind for child in table.children)
            for again in range(had, habit.most):
                share = habit.share if habit.kind in ("pillow", "television") else habit.share * zeal
                full = count[habit.kind] >= MAX_COUNT.get(habit.kind, 99)
                if full or not wants.allows(habit.kind) or not own.chance(share * 0.75**again, "wanted", again):
                    break
                if not table.lay(habit, maker, own.of("lay", again)):
                    break
                count[habit.kind] += 1
    return ""


def _need(kind: str, homes: Sequence[str], tables: Sequence[Table], maker: ItemStyler, dice: Dice) -> bool:
    for home in homes:
        fitting = [table for table in tables if table.piece.kind == home]
        habit = next(habit for habit in CLUTTER_RULES[home] if habit.kind == kind)
        for number, table in enumerate(dice.order(fitting, home)):
            if table.lay(habit, maker, dice.of(home, number)):
                return True
    return False
