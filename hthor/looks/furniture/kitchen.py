"""Kitchen things with one big door or none: fridge, coffee machine, toaster."""

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.furniture import fronts, plain
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.types import Part


def fridge(draft: Draft) -> list[Piece]:
    """A shell with a lit interior and glass shelves; its door looks like a fridge's door above a freezer's."""
    shell = [part for part in draft.parts if not part.moves]
    moving = [part for part in draft.parts if part.moves]
    leaf = max(moving, key=lambda part: part.half[0] * part.half[2])
    found = [plain.piece(part, _lining(draft, part)) for part in shell]
    found += [materials.piece(shape, materials.paint(c.WHITE, 0.3)) for part in shell for shape in _liner(draft, part)]
    (x0, y0, z0), (x1, y1, z1) = fronts.corners(leaf)
    split = z0 + 0.36 * (z1 - z0)
    coat, name = materials.guess(leaf.rgba), leaf.moves
    face = y0 + 0.35 * (y1 - y0)
    for low, high in ((z0, split - 0.004), (split + 0.004, z1)):
        shape = solids.box((x0, face, low), (x1, y1, high), 0.014, 2)
        found.append(materials.piece(shape, coat, name))
    inner = solids.box((x0 + 0.01, y0, z0 + 0.01), (x1 - 0.01, face, z1 - 0.01), 0.004)
    found.append(materials.piece(inner, materials.paint(c.WHITE, 0.3), name))
    side = -1.0 if draft.joints and draft.joints[0].anchor[0] > 0.0 else 1.0
    for low, high in ((split - 0.30 * (split - z0), split - 0.05), (split + 0.05, split + 0.42 * (z1 - split))):
        handle = fronts.grip(side * 0.42 * draft.size[0], y1, draft.size[1] / 2, low, high)
        found.append(materials.piece(handle, materials.chrome(), name))
    return found


def _liner(draft: Draft, part: Part) -> list[Mesh]:
    """A white sheet on the inner side of a wall that has the body's color."""
    (x0, y0, z0), (x1, y1, z1) = fronts.corners(part)
    thin, low, high = 0.002, z0 + 0.05, z1 - 0.05
    if part.rgba != draft.color(0) or part.half[2] < 0.3 * draft.size[2]:
        return []
    if part.half[0] < part.half[1]:
        inner = x1 if part.centre[0] < 0.0 else x0 - thin
        return [solids.box((inner, y0, low), (inner + thin, y1 - 0.002, high), 0.0)]
    edge = 0.05 * draft.size[0]
    return [solids.box((x0 + edge, y1, low), (x1 - edge, y1 + thin, high), 0.0)]


def _lining(draft: Draft, part: Part) -> Material:
    shelf = part.half[2] < 0.012 and part.half[0] > 0.3 * draft.size[0] / 2
    return materials.glass((0.82, 0.92, 0.95, 0.5)) if shelf else materials.guess(part.rgba)


def coffee_machine(draft: Draft) -> list[Piece]:
    """A tank at the back, a head with keys over a drip tray, and between them a glass jug with coffee."""
    w, d, h = draft.size
    x, y = w / 2, d / 2
    body, steel = materials.paint(draft.color(0), 0.4), materials.metal(c.STEEL)
    r, at = 0.30 * min(w, d), y - 0.30 * d
    jug = [(0.0, 0.115), (0.9, 0.115), (1.0, 0.16), (1.0, 0.36), (0.72, 0.50), (0.66, 0.54), (0.70, 0.56)]
    brew = [(0.0, 0.12), (0.86, 0.12), (0.95, 0.16), (0.95, 0.33), (0.0, 0.33)]
    lid = [(0.0, 0.55), (0.72, 0.55), (0.70, 0.58), (0.2, 0.60), (0.0, 0.60)]
    ear = sweeps.bend(
        (0.66 * r, at, 0.52 * h), (1.45 * r, at, 0.48 * h), (1.40 * r, at, 0.26 * h), (0.96 * r, at, 0.20 * h), steps=4
    )
    placed = [(shaping.moved(solids.lathe(p, 24, (r, h)), 0.0, at),
        m) for p, m in ((brew, materials.paint((0.16, 0.09, 0.05, 1.0), 0.5)), (lid, body),
        (jug, materials.glass((0.85, 0.92, 0.94, 0.18))))]  # fmt: skip
    lamp = solids.cylinder((0.28 * w, y - 0.002, 0.86 * h), 0.010, 0.006, "y", 10)
    return [
        materials.piece(solids.box((-x, -y, 0.0), (x, 0.44 * d - y, h), 0.02, 2), body),
        materials.piece(solids.box((-x, 0.30 * d - y, 0.0), (x, y, 0.09 * h), 0.012, 2), body),
        materials.piece(solids.box((-x, 0.30 * d - y, 0.70 * h), (x, y - 0.004, h), 0.02, 2), body),
        materials.piece(solids.box((-0.8 * x, y - 0.008, 0.78 * h), (0.30 * x, y - 0.002, 0.94 * h), 0.002), steel),
        materials.piece(solids.cylinder((0.0, at, 0.105 * h), 1.1 * r, 0.03 * h, "z", 24), steel),
        materials.piece(sweeps.tube(ear, 0.007, 8), body),
        *(materials.piece(shape, coat) for shape, coat in placed[:2]),
        materials.piece(lamp, materials.glow((0.35, 0.85, 0.40, 1.0))),
        materials.piece(*placed[2]),
    ]


def toaster(draft: Draft) -> list[Piece]:
    """A box with rounded shoulders, two slots, toast in one slot, and a lever."""
    w, d, h = draft.size
    x, y, edge = w / 2, d / 2, 0.94
    dark, steel = materials.paint(c.BLACK, 0.3), materials.chrome(draft.color(0))
    shell = solids.box((-edge * x, -y, 0.012), (edge * x, y, 0.96 * h), 0.035, 3)
    fittings = [
        solids.box((-0.96 * x, 0.02 - y, 0.0), (0.96 * x, y - 0.02, 0.02), 0.004),
        solids.box((edge * x - 0.006, -0.010, 0.3 * h), (edge * x + 0.002, 0.010, 0.8 * h), 0.001),
        solids.box((edge * x, -0.022, 0.66 * h), (x, 0.022, 0.74 * h), 0.005),
        solids.box((-x, -0.02, 0.5 * h), (-0.92 * x, 0.02, 0.6 * h), 0.005),
    ]
    for at in (-0.22, 0.22):
        fittings.append(
            solids.box((-0.72 * x, at * d - 0.014, 0.955 * h), (0.72 * x, at * d + 0.014, 0.963 * h), 0.002)
        )
    toast = solids.box((-0.60 * x, -0.22 * d - 0.009, 0.9 * h), (0.60 * x, -0.22 * d + 0.009, h), 0.008)
    crumb = materials.tinted("bread", (0.72, 0.46, 0.22, 1.0))
    return [materials.piece(shell, steel), *(materials.piece(s, dark) for s in fittings), materials.piece(toast, crumb)]
