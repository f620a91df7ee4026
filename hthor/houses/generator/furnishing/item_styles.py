"""Chooses sizes and finishes of things, the same within one house."""

from hthor import catalog
from hthor.houses.generator.draws import Dice
from hthor.houses.generator.furnishing.pieces import Piece
from hthor.types import Vec2, Vec3

FINISHES = 4
"""Variants 0 to 3 are drawn; a kind with fewer finishes repeats them."""

SIZES: dict[str, tuple[tuple[int, int, int], ...]] = {
    "fridge": ((75, 72, 178), (70, 70, 172), (80, 72, 184)),
    "counter_top": ((180, 62, 90), (150, 62, 90), (120, 62, 90), (210, 62, 90)),
    "sink": ((80, 62, 108), (70, 62, 108)),
    "dining_table": ((150, 90, 74), (170, 90, 75), (130, 85, 74), (190, 95, 75)),
    "coffee_table": ((105, 60, 42), (110, 55, 44), (90, 60, 40)),
    "sofa": ((195, 90, 82), (180, 88, 80), (215, 92, 84)),
    "armchair": ((85, 85, 85), (80, 80, 88)),
    "bed": ((160, 210, 95), (180, 212, 100), (140, 208, 92)),
    "desk": ((135, 65, 74), (120, 60, 74), (150, 70, 75)),
    "tv_stand": ((150, 42, 50), (170, 45, 48), (130, 42, 52), (180, 45, 50)),
    "chair": ((45, 50, 90), (44, 48, 88), (46, 52, 94)),
    "stool": ((36, 36, 48), (38, 38, 62)),
    "ottoman": ((70, 50, 42), (60, 60, 40)),
    "shelf": ((85, 32, 190), (70, 32, 182), (100, 34, 120), (120, 34, 82)),
    "dresser": ((110, 48, 82), (90, 48, 95), (130, 50, 78)),
    "side_table": ((45, 42, 52), (48, 40, 55), (42, 42, 50)),
    "cart": ((70, 45, 90), (60, 42, 85)),
    "toilet": ((42, 68, 80), (40, 66, 78)),
    "bathtub": ((75, 165, 56), (75, 170, 58)),
    "shower": ((90, 90, 205), (95, 85, 205)),
    "washing_machine": ((60, 60, 85),),
    "stove": ((60, 62, 90),),
    "wardrobe": ((120, 60, 200), (100, 58, 200), (140, 60, 210)),
    "clock": ((30, 5, 30),),
    "mirror": ((60, 4, 80),),
    "floor_lamp": ((42, 42, 162), (38, 38, 170), (45, 45, 155)),
    "house_plant": ((50, 50, 95), (60, 60, 125), (45, 45, 75), (55, 55, 150)),
    "bin": ((30, 30, 42), (28, 28, 36), (34, 34, 60)),
    "laundry_hamper": ((42, 36, 60), (45, 40, 65)),
    "dog_bed": ((75, 60, 14), (85, 65, 15)),
    "vacuum_cleaner": ((32, 32, 105),),
    "painting": ((80, 4, 60), (60, 4, 80), (100, 4, 70), (45, 4, 45), (50, 4, 70), (120, 4, 60)),
    "light_switch": ((8, 2, 12),),
    "towel_holder": ((55, 8, 5),),
    "towel": ((50, 4, 60),),
    "lamp": ((26, 26, 42), (22, 22, 38), (28, 28, 48)),
}
"""Sizes [cm] that are drawn. They are written into the house file, so a house keeps them permanently."""
_VARIED = frozenset({"painting", "house_plant", "bottle", "vase", "box", "bin", "pillow", "rug", "teddy_bear"})
"""Kinds whose things differ within one house."""
_MATCHES = {"kitchen_cabinet": "counter_top", "side_table": "dresser", "wardrobe": "dresser"}
"""Kinds that take the finish of another kind."""


class ItemStyler:
    """Makes the things of one house: all its sofas have the same finish, and all its chairs the same model."""

    def __init__(self, dice: Dice) -> None:
        self._dice = dice

    def make(
        self,
        kind: str,
        *names: str | int,
        middle: Vec2 = (0.0, 0.0),
        yaw: float = 0.0,
        bottom: float = 0.0,
        size: tuple[int, int, int] | None = None,
    ) -> Piece:
        """A thing of that kind; ``names`` key its random draws, ``size`` [cm] fixes its size."""
        dice = self._dice.of(kind, *names) if kind in _VARIED else self._dice.of(kind)
        options = SIZES.get(kind, ())
        extent = size or (dice.pick(options, "size") if options else None)
        look = self._dice.of(_MATCHES[kind]) if kind in _MATCHES else dice
        variant = look.whole(0, FINISHES - 1, "variant")
        asset = f"hthor_{kind}" + ("" if extent is None else "_{}x{}x{}".format(*extent))
        metres: Vec3 = catalog.kind(kind).size
        if extent is not None:
            metres = (extent[0] / 100.0, extent[1] / 100.0, extent[2] / 100.0)
        full = asset + (f"_v{variant}" if variant else "")
        return Piece(kind=kind, asset=full, size=metres, middle=middle, bottom=bottom, yaw=yaw)

    def against(self, kind: str, *names: str | int, x: float = 0.0, size: tuple[int, int, int] | None = None) -> Piece:
        """A thing with its back on its group's back edge."""
        piece = self.make(kind, *names, size=size)
        return self.make(kind, *names, middle=(x, piece.size[1] / 2), size=size)
