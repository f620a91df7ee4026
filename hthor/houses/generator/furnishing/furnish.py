"""Chooses the furniture of each room, required furniture first."""

from collections.abc import Iterable, Sequence

from hthor.houses.generator.draws import Dice
from hthor.houses.generator.floorplan.room_specs import BATHROOM, BEDROOM, KITCHEN, LIVING
from hthor.houses.generator.furnishing import groups
from hthor.houses.generator.furnishing.floor_space import RoomSpace
from hthor.houses.generator.furnishing.item_styles import ItemStyler
from hthor.houses.generator.furnishing.pieces import PieceGroup
from hthor.houses.generator.furnishing.requirements import ALWAYS, Requirements

_DINING_M2 = 15.0
"""Kitchens from this area on have the dining table."""
_CORNERS = ("corner", "wall")
_WALLS = ("wall", "corner")


def furnish_rooms(rooms: Sequence[RoomSpace], wants: Requirements, maker: ItemStyler, dice: Dice) -> str:
    """Furnish all rooms; returns the kind of the first required thing without a place, or an empty string."""
    by_kind = {
        kind: [room for room in rooms if room.room.kind == kind] for kind in (KITCHEN, LIVING, BEDROOM, BATHROOM)
    }
    kitchens, living, beds = by_kind[KITCHEN], by_kind[LIVING], by_kind[BEDROOM]
    for room in kitchens:
        _cook(room, maker, dice.of("kitchen", room.room.number))
    _sit(living, beds, wants, maker, dice.of("seating"))
    for number, room in enumerate(beds):
        own = dice.of("bed", number)
        _first(room, groups.sleeping(maker, own, double=number == 0 or own.chance(0.6, "double")), own)
    for room in by_kind[BATHROOM]:
        _wash(room, maker, dice.of("bath", room.room.number))
    _dine(kitchens, living, maker, dice.of("dining"))
    _work([*dice.order(beds, "desk"), *living[::-1], *kitchens], maker, dice.of("desk"))
    for room in kitchens:
        if room.room.area >= _ISLAND_M2 and dice.chance(0.6, "island"):
            _island(room, maker, dice.of("island", room.room.number))
    _store([*beds, *living, *kitchens], wants, maker, dice.of("needs"))
    for room in rooms:
        _fill(room, wants, maker, dice.of("more", room.room.number))
        _carpet(room, maker, dice.of("rug", room.room.number))
    had = {piece.kind for room in rooms for piece in room.pieces}
    furniture = [kind for kind in ("armchair", "shelf", "dresser") if kind in wants.must]
    return next((kind for kind in (*ALWAYS, *furniture) if kind not in had), "")


def _first(room: RoomSpace, options: Iterable[PieceGroup], dice: Dice) -> bool:
    """Place the first of these groups for which there is room."""
    return any(room.place(group, dice.of("try", number)) for number, group in enumerate(options))


def _cook(room: RoomSpace, maker: ItemStyler, dice: Dice) -> None:
    if not _first(room, groups.kitchen(maker, dice), dice):
        room.place(groups.fridge(maker), dice.of("fridge"))
        room.place(groups.washing_up(maker), dice.of("washing"))
    if dice.chance(0.55, "second"):
        size = dice.pick([(150, 62, 90), (120, 62, 90), (180, 62, 90)], "size")
        room.place(groups.sized(maker, "counter_top", size, front=0.7, anchors=_CORNERS), dice.of("second"))


def _sit(
    rooms: Sequence[RoomSpace], beds: Sequence[RoomSpace], wants: Requirements, maker: ItemStyler, dice: Dice
) -> None:
    for number, room in enumerate(sorted(rooms, key=lambda room: -room.room.area)):
        own = dice.of(number)
        if number and own.chance(0.5, "other use"):
            _first(room, groups.resting(maker), own.of("other use"))
            continue
        extras = tuple(
            kind
            for kind, share in (("armchair", 0.7), ("side_table", 0.5), ("floor_lamp", 0.4))
            if wants.allows(kind) and own.chance(share, kind)
        )
        if not _first(room, groups.seating(maker, own, _depths(room), extras[:2]), own) and not number:
            for other, place in enumerate(rooms):
                if _first(place, groups.resting(maker), own.of("resting", other)):
                    break
            else:
                _scatter([*rooms, *beds], maker, own)
            for other, place in enumerate([*rooms, *beds]):
                if place.place(groups.single(maker, "tv_stand", front=0.7), own.of("stand", other)):
                    break


def _scatter(rooms: Sequence[RoomSpace], maker: ItemStyler, dice: Dice) -> None:
    """Sofa and coffee table apart, when no room has space for both together."""
    for kind in ("sofa", "coffee_table"):
        for number, room in enumerate(rooms):
            if room.place(groups.single(maker, kind, front=0.5, anchors=_WALLS), dice.of(kind, number)):
                break


def _depths(room: RoomSpace) -> list[float]:
    """The distances between opposite walls of a room, inside [m]."""
    polygon = room.room.polygon
    depths: set[float] = set()
    for axis in (0, 1):
        values = sorted({corner[axis] for corner in polygon})
        depths |= {round(b - a - 0.14, 2) for k, a in enumerate(values) for b in values[k + 1 :]}
    return sorted(depths)


def _dine(kitchens: Sequence[RoomSpace], living: Sequence[RoomSpace], maker: ItemStyler, dice: Dice) -> None:
    small = [room for room in living if len(room.pieces) <= 2]
    roomy = [room for room in kitchens if room.room.area >= _DINING_M2]
    order = [*roomy, *small, *living, *kitchens] if dice.chance(0.75, "kitchen") else [*small, *living, *kitchens]
    tables = list(groups.dining(maker, dice))
    for free in (tables[:3], tables[3:]):
        for number, room in enumerate(order):
            if _first(room, free, dice.of("room", number)):
                return


def _work(rooms: Sequence[RoomSpace], maker: ItemStyler, dice: Dice) -> None:
    for number, room in enumerate(rooms):
        if _first(room, groups.working(maker, dice), dice.of(number)):
            return


def _wash(room: RoomSpace, maker: ItemStyler, dice: Dice) -> None:
    room.place(groups.single(maker, "toilet", front=0.5, anchors=_WALLS), dice.of("toilet"))
    room.place(groups.sized(maker, "sink", (65, 48, 105), front=0.6, anchors=_WALLS), dice.of("sink"))
    tub = dice.chance(0.5, "tub")
    shower = groups.single(maker, "shower", front=0.5, anchors=("left",))
    both = [groups.bath(maker), shower] if tub else [shower, groups.bath(maker)]
    _first(room, both, dice.of("water"))
    if room.room.area > 12.0 and not tub:
        room.place(groups.bath(maker), dice.of("tub too"))


def _store(rooms: Sequence[RoomSpace], wants: Requirements, maker: ItemStyler, dice: Dice) -> None:
    """The furniture that the house must have, in the first room that has space for it."""
    for kind in ("dresser", "shelf", "armchair"):
        if kind not in wants.must or any(piece.kind == kind for room in rooms for piece in room.pieces):
            continue
        order = rooms if kind == "dresser" else sorted(rooms, key=lambda room: room.room.kind != LIVING)
        for number, room in enumerate(order):
            own = dice.of(kind, number)
            options = [groups.single(maker, kind, number)]
            if kind == "armchair":
                options = [groups.reading(maker, lamp=True), groups.reading(maker, lamp=False), *options]
            if _first(room, options, own):
                break


_MORE = {
    KITCHEN: "bin 0.8, house_plant 0.4, shelf 0.2, cart 0.25, stool 0.3, box 0.1, dog_bed 0.1",
    LIVING: "shelf 0.65, reading 0.35, dresser 0.3, house_plant 0.8, floor_lamp 0.5, ottoman 0.25, house_plant 0.25, "
    "dog_bed 0.2, bin 0.25, box 0.2, basketball 0.15, side_table 0.2, watering_can 0.1",
    BEDROOM: "wardrobe 0.7, dresser 0.6, shelf 0.3, reading 0.2, desk 0.25, house_plant 0.4, laundry_hamper 0.25, "
    "floor_lamp 0.25, bin 0.25, box 0.2, ottoman 0.15, boots 0.2, basketball 0.15, teddy_bear 0.15, "
    "vacuum_cleaner 0.1, dumbbell 0.1",
    BATHROOM: "washing_machine 0.4, laundry_hamper 0.35, bin 0.5, brush 0.4, house_plant 0.15, side_table 0.1",
}
"""More furniture of a room, in this order: kinds, each with its probability."""
_RUGS: dict[str, tuple[tuple[str, ...], float, float, tuple[tuple[int, int, int], ...]]] = {
    LIVING: (("tv_stand", "coffee_table"), 0.6, 0.8, ((200, 140, 1), (180, 120, 1), (160, 90, 1), (140, 70, 1))),
    BEDROOM: (("bed",), 1.8, 0.55, ((160, 110, 1), (140, 80, 1), (120, 60, 1))),
    BATHROOM: (("sink",), 1.0, 0.5, ((80, 50, 1), (60, 45, 1))),
}
"""Rugs by room: the things that they lie near, how near [m], probability, and sizes [cm], the largest first."""
_ISLAND_M2 = 24.0
_BACKED = frozenset(
    {"wardrobe", "shelf", "dresser", "cart", "washing_machine", "side_table", "laundry_hamper", "ottoman"}
)
_ROOMY_M2 = 20.0


def _fill(room: RoomSpace, wants: Requirements, maker: ItemStyler, dice: Dice) -> None:
    size = min(max((room.room.area / _ROOMY_M2) ** 0.5, 0.55), 1.25)
    for number, row in enumerate(_MORE[room.room.kind].split(", ")):
        kind, share = row.split()
        own = dice.of(kind, number)
        wanted = "armchair" if kind == "reading" else kind
        if not wants.allows(wanted) or not own.chance(float(share) * size, "wanted"):
            continue
        names = (room.room.number, number)
        if kind == "reading":
            room.place(groups.reading(maker, lamp=own.chance(0.6, "lamp")), own)
        elif kind == "desk":
            _first(room, groups.working(maker, own), own)
        elif kind in _BACKED:
            front = 0.3 if kind in ("side_table", "laundry_hamper", "ottoman") else 0.55
            room.place(groups.single(maker, kind, *names, front=front, anchors=_WALLS), own)
        else:
            turned = kind not in ("bin", "dog_bed", "stool")
            room.place(groups.loose(maker, own, kind, *names, turned=turned, anchors=_CORNERS), own)


def _carpet(room: RoomSpace, maker: ItemStyler, dice: Dice) -> None:
    kinds, within, share, sizes = _RUGS.get(room.room.kind, ((), 0.0, 0.0, ()))
    marks = [next((piece.middle for piece in room.pieces if piece.kind == kind), None) for kind in kinds]
    places = [mark for mark in marks if mark is not None]
    if len(places) < len(kinds) or not places or not dice.chance(share, "rug"):
        return
    near = (sum(x for x, _ in places) / len(places), sum(y for _, y in places) / len(places))
    for number, size in enumerate(sizes):
        if room.spread(maker.make("rug", room.room.number, size=size), near, within, dice.of(number)):
            return


def _island(room: RoomSpace, maker: ItemStyler, dice: Dice) -> None:
    for size in ((150, 80, 90), (120, 70, 90)):
        if room.place(groups.island(maker, dice, size), dice.of("island", size[0])):
            return
