"""Groups of furniture as people put them together, in their own frames."""

import math
from collections.abc import Iterator

import msgspec

from hthor.houses.generator.draws import Dice
from hthor.houses.generator.furnishing.item_styles import SIZES, ItemStyler
from hthor.houses.generator.furnishing.pieces import Piece, PieceGroup, Rect
from hthor.types import Vec2

TUCK_M = 0.18
"""How far a chair is pushed under its table."""
_SEAM_M = 0.008
_TURN = math.radians(6.0)
HALF = math.pi


_RUNS: tuple[tuple[int | str, ...], ...] = (
    (150, "sink", 150, "stove"),
    (180, "sink", "stove"),
    (150, "sink", "stove"),
    ("sink", 150, "stove"),
    (120, "sink", "stove"),
    (150, "sink"),
    (120, "sink"),
)
"""Units to the left of the fridge, the longest run first; counters are given by their width [cm]. The unit next to the
fridge has no door at its right end, which would hit the fridge when open."""


def kitchen(maker: ItemStyler, dice: Dice) -> Iterator[PieceGroup]:
    """A run of counters, sink and stove with the fridge at its right end, the longest first."""
    fridge = maker.make("fridge")
    for run in _RUNS[dice.whole(0, 1, "longest") :]:
        left = 0.0
        pieces: list[Piece] = []
        for part in run:
            kind = part if isinstance(part, str) else "counter_top"
            size = (part, 62, 90) if isinstance(part, int) else (80, 62, 108) if kind == "sink" else (60, 62, 90)
            pieces.append(maker.make(kind, middle=(left + size[0] / 200, 0.31), size=size))
            left += size[0] / 100 + _SEAM_M
        w, d, _ = fridge.size
        pieces.append(maker.make("fridge", middle=(left + w / 2, d / 2)))
        swing = (left - 0.2, d + 0.01, left + w + 0.02, d + w + 0.12)
        front = (0.0, 0.63, left - 0.01, 1.37)
        yield PieceGroup(name="kitchen", pieces=tuple(pieces), free=(swing, front), anchors=("right", "wall"), serve=2)


def island(maker: ItemStyler, dice: Dice, size: tuple[int, int, int]) -> PieceGroup:
    """A counter free in the room, with stools at its back."""
    w, d = size[0] / 100, size[1] / 100
    stool = maker.make("stool")
    counter = maker.make("counter_top", middle=(0.0, d / 2), size=size)
    y = -stool.size[1] / 2 - 0.03
    stools = [_put(stool, (w * share, y)) for share in (-0.27, 0.27)]
    edge = y - stool.size[1] / 2
    free = ((-w / 2, d + 0.01, w / 2, d + 0.8), (-w / 2, edge - 0.6, w / 2, edge - 0.02))
    sides = ((-w / 2 - 0.6, 0.0, -w / 2 - 0.02, d), (w / 2 + 0.02, 0.0, w / 2 + 0.6, d))
    kept = stools if dice.chance(0.7, "stools") else []
    return PieceGroup(name="island", pieces=(counter, *kept), free=(*free, *sides), anchors=("middle",), serve=2)


def fridge(maker: ItemStyler) -> PieceGroup:
    """The fridge alone, with room for its door."""
    piece = maker.against("fridge")
    w, d, _ = piece.size
    swing = (-w / 2 - 0.2, d + 0.01, w / 2 + 0.02, d + w + 0.12)
    beside = (-w / 2 - 0.25, 0.03, -w / 2 - 0.03, d)
    return PieceGroup(name="fridge", pieces=(piece,), free=(swing, beside), anchors=("right", "wall"))


def washing_up(maker: ItemStyler) -> PieceGroup:
    """A short counter next to a sink."""
    sink = maker.make("sink", middle=(0.6 + _SEAM_M + 0.4, 0.31), size=(80, 62, 108))
    counter = maker.make("counter_top", middle=(0.0, 0.31), size=(120, 62, 90))
    return PieceGroup(
        name="washing up", pieces=(counter, sink), free=((-0.6, 0.63, 1.4, 1.3),), anchors=("corner", "wall")
    )


def dining(maker: ItemStyler, dice: Dice) -> Iterator[PieceGroup]:
    """A table with chairs: free in the room, then smaller tables, then with one long side to the wall."""
    for number, size in enumerate(((dice.pick(SIZES["dining_table"], "size")), (130, 85, 74), (110, 75, 74))):
        yield _table(maker, dice.of(number), size, wall=False)
    yield _table(maker, dice.of("wall"), (130, 80, 74), wall=True)
    yield _table(maker, dice.of("short"), (100, 70, 74), wall=True)
    yield _table(maker, dice.of("least"), (80, 66, 74), wall=True)


def _table(maker: ItemStyler, dice: Dice, size: tuple[int, int, int], *, wall: bool) -> PieceGroup:
    w, d = size[0] / 100, size[1] / 100
    table = maker.make("dining_table", middle=(0.0, d / 2), size=size)
    across = 2 if w >= 1.25 else 1
    places = [(w * ((k + 0.5) / across - 0.5) * 0.9, d, HALF) for k in range(across)]
    if not wall:
        places += [(x, 0.0, 0.0) for x, _, _ in places]
    ends = [(-w / 2, d / 2, -HALF / 2), (w / 2, d / 2, HALF / 2)]
    places += ends if w >= 1.6 or wall else dice.order(ends, "ends")[: dice.whole(0, 1, "end")]
    chairs = [_chair(maker, x, y, yaw, dice.of("chair", k)) for k, (x, y, yaw) in enumerate(places)]
    group = PieceGroup(name="dining", pieces=(table, *chairs), anchors=("wall", "corner") if wall else ("middle",))
    x0, y0, x1, y1 = group.extent
    around = [(x0 - 0.5, y0, x0 - 0.03, y1), (x1 + 0.03, y0, x1 + 0.5, y1), (x0, y1 + 0.03, x1, y1 + 0.5)]
    if wall:
        around = around[2:]
    else:
        around.append((x0, y0 - 0.5, x1, y0 - 0.03))
    return PieceGroup(
        name="dining", pieces=group.pieces, free=tuple(around), anchors=group.anchors, serve=1 if wall else 2
    )


def _chair(maker: ItemStyler, x: float, y: float, yaw: float, dice: Dice) -> Piece:
    """A chair at the point (x, y) of a table's edge; at yaw 0 it stands below the edge and faces up."""
    chair = maker.make("chair")
    away = chair.size[1] / 2 - TUCK_M + dice.between(0.0, 0.1, "out")
    fx, fy = -math.sin(yaw), math.cos(yaw)
    turn = dice.between(-_TURN, _TURN, "turn")
    return maker.make("chair", middle=(x - fx * away, y - fy * away), yaw=yaw + turn)


def seating(maker: ItemStyler, dice: Dice, depths: list[float], extras: tuple[str, ...]) -> Iterator[PieceGroup]:
    """TV stand against a wall, the sofa facing it over a coffee table; ``extras`` stand next to the sofa.

    ``depths`` are the room's widths [m]: a sofa stands with its back to the opposite wall, or free in the room.
    """
    stand, sofa = maker.make("tv_stand"), maker.make("sofa")
    own = stand.size[1] + sofa.size[1] + 0.16
    walls = [(depth - own, True) for depth in depths if 1.75 <= depth - own <= 3.3]
    free = [(dice.between(2.0, 2.7, "gap"), False), (1.85, False)]
    best = [*walls[:3], *free] if dice.chance(0.7, "wall") else [*free, *walls]
    for keep in (extras, extras[:1], ()):
        for gap, wall in best:
            yield _seating(maker, dice, gap, keep, wall=wall)
    yield _seating(maker, dice, 1.6, (), wall=False, small=True)


def resting(maker: ItemStyler) -> Iterator[PieceGroup]:
    """A sofa with its back to the wall and a coffee table in front of it, without a television."""
    for wide in (180, 155):
        sofa, low = maker.against("sofa", size=(wide, 88, 80)), maker.make("coffee_table", size=(90, 50, 40))
        table = maker.make("coffee_table", middle=(0.0, 0.88 + 0.38 + low.size[1] / 2), size=(90, 50, 40))
        half = wide / 200
        free = ((-half, 0.9, half, 1.24), (-half, 1.78, half, 2.2), (half - 0.5, 0.9, half, 1.8))
        yield PieceGroup(name="resting", pieces=(sofa, table), free=free, anchors=("wall",), serve=1)


def _seating(
    maker: ItemStyler, dice: Dice, gap: float, extras: tuple[str, ...], *, wall: bool, small: bool = False
) -> PieceGroup:
    sizes: dict[str, tuple[int, int, int]] = {}
    if small:
        sizes = {"tv_stand": (130, 42, 52), "sofa": (155, 86, 80), "coffee_table": (90, 50, 40)}
    stand, sofa, low = (maker.make(kind, size=sizes.get(kind)) for kind in ("tv_stand", "sofa", "coffee_table"))
    front = stand.size[1] + gap
    table_y = front - dice.between(0.36, 0.44, "reach") - low.size[1] / 2
    pieces = [
        _put(stand, (0.0, stand.size[1] / 2)),
        _put(sofa, (0.0, front + sofa.size[1] / 2), HALF),
        _put(low, (dice.between(-0.1, 0.1, "shift"), table_y)),
    ]
    side = 1.0 if dice.chance(0.5, "side") else -1.0
    for number, kind in enumerate(extras):
        piece = maker.make(kind)
        if kind == "armchair":
            x = side * (low.size[0] / 2 + 0.5 + piece.size[1] / 2)
            pieces.append(maker.make(kind, middle=(x, table_y - 0.1), yaw=side * HALF / 2))
        else:
            x = (-side if number else side) * (sofa.size[0] / 2 + 0.06 + piece.size[0] / 2)
            pieces.append(maker.make(kind, middle=(x, front + sofa.size[1] - piece.size[1] / 2 - 0.02), yaw=HALF))
    half = max(stand.size[0], low.size[0]) / 2
    free: list[Rect] = [
        (-half, stand.size[1] + 0.01, half, table_y - low.size[1] / 2 - 0.02),
        (-sofa.size[0] / 2, table_y + low.size[1] / 2 + 0.02, sofa.size[0] / 2, front - 0.02),
    ]
    back = front + sofa.size[1]
    edges = (-sofa.size[0] / 2, sofa.size[0] / 2)
    backs = ((edges[0], back + 0.03, edges[1], back + 0.3),) if wall else ()
    if not wall:
        free.append((edges[0], back + 0.03, edges[1], back + 0.7))
    return PieceGroup(name="seating", pieces=tuple(pieces), free=tuple(free), backs=backs, serve=1)


def sleeping(maker: ItemStyler, dice: Dice, *, double: bool) -> Iterator[PieceGroup]:
    """A bed with its head to the wall and side tables, then with fewer tables, then a narrow bed in a corner."""
    sizes = [dice.pick(SIZES["bed"], "size"), (140, 208, 92)] if double else [(120, 206, 90)]
    for size in (*sizes, (100, 204, 88)):
        for tables in (2, 1, 0) if size[0] >= 120 else (1, 0):
            yield _bed(maker, dice, size, tables)


def _bed(maker: ItemStyler, dice: Dice, size: tuple[int, int, int], tables: int) -> PieceGroup:
    bed = maker.against("bed", size=size)
    w, d = bed.size[0] / 2, bed.size[1]
    table = maker.make("side_table")
    reach = w + 0.05 + table.size[0]
    sides = (
        [(-1.0, 1.0), (1.0,), ()][2 - tables] if dice.chance(0.5, "side") else [(-1.0, 1.0), (-1.0,), ()][2 - tables]
    )
    stands = [maker.make("side_table", middle=(s * (w + 0.05 + table.size[0] / 2), table.size[1] / 2)) for s in sides]
    flanks = [(-reach, -w - 0.02) if s < 0 else (w + 0.02, reach) for s in sides] or [(w + 0.02, w + 0.6)]
    free: list[Rect] = [(x0, 0.6, x1, 1.2) for x0, x1 in flanks]
    free += [(x0, 1.2, x1, d) for x0, x1 in flanks]
    free.append((-w, d + 0.02, w, d + 0.5))
    anchors = ("wall",) if tables == 2 else ("corner", "wall")
    return PieceGroup(
        name="sleeping", pieces=(bed, *stands), free=tuple(free), anchors=anchors, serve=max(len(sides), 1)
    )


def working(maker: ItemStyler, dice: Dice) -> Iterator[PieceGroup]:
    """A desk against the wall with its chair, clear of the chest of drawers at its right."""
    for size in (dice.pick(SIZES["desk"], "size"), (120, 60, 74)):
        desk = maker.against("desk", size=size)
        w, d, _ = desk.size
        knees = (-w / 2 + 0.04 + w / 2 - min(0.4, 0.35 * w)) / 2
        chair = _chair(maker, knees, d, HALF, dice.of("chair"))
        free = ((-w / 2, d + 0.45, w / 2, d + 0.95), (w / 2 - 0.42, d + 0.01, w / 2, d + 0.5))
        yield PieceGroup(name="working", pieces=(desk, chair), free=free, anchors=("wall", "corner"), serve=1)


def _put(piece: Piece, middle: Vec2, yaw: float = 0.0) -> Piece:
    return msgspec.structs.replace(piece, middle=middle, yaw=yaw)


def single(
    maker: ItemStyler, kind: str, *names: str | int, front: float = 0.6, anchors: tuple[str, ...] = ("wall",)
) -> PieceGroup:
    """One thing with its back to the wall and ``front`` [m] of free floor in front of it."""
    piece = maker.against(kind, *names)
    w, d, _ = piece.size
    free = ((-w / 2, d + 0.01, w / 2, d + front),) if front > 0.0 else ()
    return PieceGroup(name=kind, pieces=(piece,), free=free, anchors=anchors, serve=len(free))


def sized(
    maker: ItemStyler, kind: str, size: tuple[int, int, int], *, front: float, anchors: tuple[str, ...]
) -> PieceGroup:
    """As `single`, with this size [cm]."""
    piece = maker.against(kind, size=size)
    w, d, _ = piece.size
    return PieceGroup(name=kind, pieces=(piece,), free=((-w / 2, d + 0.01, w / 2, d + front),), anchors=anchors)


def reading(maker: ItemStyler, *, lamp: bool) -> PieceGroup:
    """An armchair in a corner with a lamp next to it."""
    chair = maker.make("armchair")
    wide, deep, _ = chair.size
    chair = _put(chair, (wide / 2, deep / 2))
    lamps = [maker.make("floor_lamp")] if lamp else []
    stands = [maker.make("floor_lamp", middle=(wide + 0.03 + piece.size[0] / 2, piece.size[1] / 2)) for piece in lamps]
    free = ((0.0, deep + 0.02, wide, deep + 0.5),)
    return PieceGroup(name="reading", pieces=(chair, *stands), free=free, anchors=("left", "wall"))


def bath(maker: ItemStyler) -> PieceGroup:
    """A bathtub with a long side to the wall."""
    tub = maker.make("bathtub")
    w, d, _ = tub.size
    piece = maker.make("bathtub", middle=(0.0, w / 2), yaw=HALF / 2)
    return PieceGroup(
        name="bathtub", pieces=(piece,), free=((-d / 2, w + 0.01, d / 2, w + 0.55),), anchors=("corner", "wall")
    )


def loose(
    maker: ItemStyler, dice: Dice, kind: str, *names: str | int, turned: bool = True, anchors: tuple[str, ...]
) -> PieceGroup:
    """A thing that stands loosely in the room, in any direction if ``turned``."""
    yaw = dice.between(-HALF, HALF, *names, "yaw") if turned else 0.0
    piece = maker.make(kind, *names, yaw=yaw)
    piece = maker.make(kind, *names, yaw=yaw, middle=(0.0, -piece.rect[1]))
    return PieceGroup(name=kind, pieces=(piece,), anchors=anchors, serve=0)
