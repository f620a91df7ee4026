"""From a kind to its pieces: who builds what, and how the pieces are put together."""

from collections.abc import Callable, Iterable, Mapping

from hthor.catalog import Kind
from hthor.looks.draft import Draft
from hthor.looks.furniture import appliances, bathroom, beds, fronts, kitchen, lamps, plain, seats, sinks, wall_items
from hthor.looks.meshes import shaping
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.looks.objects import food, paper, plants, screens, small, tableware, toys, trunks
from hthor.types import Vec3

_CLOSE_M = 1e-4

Builder = Callable[[Draft], Iterable[Piece]]
"""Makes the pieces of a thing that stands on z = 0, its middle over the origin."""

_JOINERY = (
    "dining_table",
    "coffee_table",
    "side_table",
    "desk",
    "dresser",
    "shelf",
    "tv_stand",
    "wardrobe",
    "kitchen_cabinet",
    "cart",
)
_BUILDERS: Mapping[str, Builder] = {
    **dict.fromkeys(_JOINERY, fronts.joinery),
    "counter_top": fronts.counter,
    "furniture": fronts.cabinet,
    "fridge": kitchen.fridge,
    "sink": sinks.sink,
    "faucet": sinks.faucet,
    "stove": appliances.stove,
    "microwave": appliances.microwave,
    "safe": appliances.microwave,
    "washing_machine": appliances.washer,
    "coffee_machine": kitchen.coffee_machine,
    "toaster": kitchen.toaster,
    "range_hood": appliances.range_hood,
    "sofa": seats.sofa,
    "armchair": seats.sofa,
    "chair": seats.chair,
    "stool": seats.stool,
    "ottoman": seats.ottoman,
    "bed": beds.bed,
    "pillow": beds.pillow,
    "dog_bed": beds.dog_bed,
    "trunk": trunks.trunk,
    "toilet": bathroom.toilet,
    "bathtub": bathroom.bathtub,
    "shower": bathroom.shower,
    "shower_head": bathroom.shower_head,
    "towel_holder": bathroom.towel_holder,
    "towel": bathroom.towel,
    "toilet_paper": bathroom.toilet_paper,
    "soap": bathroom.soap,
    "television": screens.television,
    "computer": screens.computer,
    "laptop": screens.laptop,
    "phone": screens.phone,
    "remote_control": screens.remote_control,
    "apple": food.apple,
    "tomato": food.tomato,
    "lettuce": food.lettuce,
    "bread": food.bread,
    "egg": food.egg,
    "potato": food.potato,
    "mug": tableware.mug,
    "cup": tableware.cup,
    "bowl": tableware.bowl,
    "plate": tableware.plate,
    "pot": tableware.pot,
    "pan": tableware.pan,
    "kettle": tableware.kettle,
    "bottle": tableware.bottle,
    "soap_bottle": tableware.dispenser,
    "shaker": tableware.shaker,
    "vase": tableware.vase,
    "cutlery": tableware.cutlery,
    "cooking_spoon": tableware.spoon,
    "lamp": lamps.table_lamp,
    "floor_lamp": lamps.floor_lamp,
    "candle": lamps.candle,
    "vacuum_cleaner": lamps.vacuum_cleaner,
    "brush": lamps.brush,
    "house_plant": plants.house_plant,
    "painting": wall_items.painting,
    "mirror": wall_items.mirror,
    "clock": wall_items.clock,
    "curtain": wall_items.curtain,
    "rug": wall_items.rug,
    "light_switch": wall_items.light_switch,
    "basketball": toys.basketball,
    "teddy_bear": toys.teddy_bear,
    "statue": toys.statue,
    "bat": toys.bat,
    "racket": toys.racket,
    "dumbbell": toys.dumbbell,
    "watering_can": toys.watering_can,
    "book": paper.book,
    "newspaper": paper.newspaper,
    "alarm_clock": small.alarm_clock,
    "box": paper.carton,
    "tissue_box": paper.tissue_box,
    "bin": small.bin_,
    "laundry_hamper": small.hamper,
    "boots": small.boots,
    "keys": small.keys,
    "watch": small.watch,
    "pen": small.pen,
    "disc": small.disc,
    "paper_roll": paper.paper_roll,
    "cloth": paper.cloth,
    "sponge": paper.sponge,
}


def build_pieces(kind: Kind, size: Vec3 | None, variant: int) -> tuple[Piece, ...]:
    """The pieces of a thing of ``kind`` in its local frame, one for each material and joint."""
    form = kind.form(size, variant)
    extent = kind.size if size is None else size
    draft = Draft.standing(kind.name, extent, form, variant)
    build = _BUILDERS.get(kind.name)
    found = build(draft) if build else plain.plain_pieces(draft.parts)
    return tuple(merge_by_material(_boxed(list(found), extent), -extent[2] / 2.0))


def _boxed(pieces: list[Piece], size: Vec3) -> list[Piece]:
    """Pieces that miss their bounding box, moved and stretched into it."""
    w, d, h = size
    lo, hi = (-w / 2, -d / 2, 0.0), (w / 2, d / 2, h)
    low, high = shaping.bounds(pieces)
    missed = max(float(abs(low - lo).max()), float(abs(high - hi).max()))
    return shaping.fitted(pieces, lo, hi) if missed > _CLOSE_M else pieces


def merge_by_material(pieces: Iterable[Piece], lift: float = 0.0) -> list[Piece]:
    """Pieces of the same material and joint made one, and lifted by ``lift`` [m]."""
    groups: dict[tuple[Material, str], list[Mesh]] = {}
    for piece in pieces:
        groups.setdefault((piece.material, piece.moves), []).append(piece.mesh)
    return [
        Piece(shaping.moved(shaping.merged(*meshes), z=lift), material, moves)
        for (material, moves), meshes in groups.items()
    ]
