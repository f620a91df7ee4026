"""Builds the pieces of a thing of any kind: finds the kind's builder, and merges the pieces that it makes."""

from collections.abc import Callable, Iterable, Mapping
from types import ModuleType

from hthor.catalog import Kind
from hthor.looks.draft import Draft
from hthor.looks.furniture import appliances, bathroom, beds, fronts, kitchen, lamps, plain, seats, sinks, wall_items
from hthor.looks.meshes import shaping
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.looks.objects import food, paper, plants, screens, small, tableware, toys, trunks
from hthor.types import Vec3

_CLOSE_M = 1e-4

Builder = Callable[[Draft], Iterable[Piece]]
"""Makes the pieces of a thing that stands on z = 0 with its middle above the origin."""


def _named(module: ModuleType, kinds: str) -> dict[str, Builder]:
    """The builders of these kinds: the functions of the module that have the kinds' names."""
    return {kind: getattr(module, kind) for kind in kinds.split()}


_TABLES, _CASES = ("dining_table", "coffee_table", "side_table", "desk", "tv_stand", "cart"), ("dresser", "shelf")
_BUILDERS: Mapping[str, Builder] = {
    **dict.fromkeys((*_TABLES, *_CASES, "wardrobe", "kitchen_cabinet"), fronts.joinery),
    "counter_top": fronts.counter,
    "furniture": fronts.cabinet,
    **_named(kitchen, "fridge coffee_machine toaster"),
    **_named(sinks, "sink faucet"),
    **_named(appliances, "stove microwave range_hood"),
    "safe": appliances.microwave,
    "washing_machine": appliances.washer,
    **_named(seats, "sofa chair stool ottoman"),
    "armchair": seats.sofa,
    **_named(beds, "bed pillow dog_bed"),
    **_named(bathroom, "toilet bathtub shower shower_head towel_holder towel toilet_paper soap"),
    **_named(lamps, "floor_lamp candle vacuum_cleaner brush"),
    "lamp": lamps.table_lamp,
    **_named(wall_items, "painting mirror clock curtain rug light_switch"),
    "trunk": trunks.trunk,
    "house_plant": plants.house_plant,
    **_named(screens, "television computer laptop phone remote_control"),
    **_named(food, "apple tomato lettuce bread egg potato"),
    **_named(tableware, "mug cup bowl plate pot pan kettle bottle shaker vase cutlery"),
    "soap_bottle": tableware.dispenser,
    "cooking_spoon": tableware.spoon,
    **_named(toys, "basketball teddy_bear statue bat racket dumbbell watering_can"),
    **_named(paper, "book newspaper tissue_box paper_roll cloth sponge"),
    "box": paper.carton,
    **_named(small, "alarm_clock boots keys watch pen disc"),
    "bin": small.bin_,
    "laundry_hamper": small.hamper,
}


def build_pieces(kind: Kind, size: Vec3 | None, variant: int) -> tuple[Piece, ...]:
    """Build a thing of ``kind`` in its local frame: one piece for each material and joint."""
    form = kind.form(size, variant)
    extent = kind.size if size is None else size
    draft = Draft.standing(kind.name, extent, form, variant)
    build = _BUILDERS.get(kind.name)
    found = build(draft) if build else plain.plain_pieces(draft.parts)
    return tuple(merge_by_material(_boxed(list(found), extent), -extent[2] / 2.0))


def _boxed(pieces: list[Piece], size: Vec3) -> list[Piece]:
    """The pieces, moved and stretched into their bounding box if they do not fill it."""
    w, d, h = size
    lo, hi = (-w / 2, -d / 2, 0.0), (w / 2, d / 2, h)
    low, high = shaping.bounds(pieces)
    missed = max(float(abs(low - lo).max()), float(abs(high - hi).max()))
    return shaping.fitted(pieces, lo, hi) if missed > _CLOSE_M else pieces


def merge_by_material(pieces: Iterable[Piece], lift: float = 0.0) -> list[Piece]:
    """Merge pieces of the same material and joint, and lift them by ``lift`` [m]."""
    groups: dict[tuple[Material, str], list[Mesh]] = {}
    for piece in pieces:
        groups.setdefault((piece.material, piece.moves), []).append(piece.mesh)
    return [
        Piece(shaping.moved(shaping.merged(*meshes), z=lift), material, moves)
        for (material, moves), meshes in groups.items()
    ]
