"""Books, newspapers, cartons, rolls of paper, cloths and sponges."""

import math

import numpy as np

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Material, Mesh, Piece

_COVERS = {c.BLUE: 2, c.TEAL: 2, c.LEAF: 3, c.SAGE: 3, c.MUSTARD: 4, c.CREAM: 4}
"""The number of the cover of a book of that color; books of other colors have the first cover."""


def book(draft: Draft) -> list[Piece]:
    """A hardback that lies on its back: a printed cover, a rounded spine on the left, pages visible at three edges."""
    w, d, h = draft.size
    x, y, t = w / 2, d / 2, min(0.0035, 0.12 * h)
    cloth = materials.paint(draft.color(0), 0.12)
    # Seen from the thing's front, with y towards the reader, the spine is on the left: at +x.
    boards = [solids.box((-x, -y, 0.0), (x, y, t), 0.001), solids.box((-x, -y, h - t), (x, y, h), 0.001)]
    angle = np.linspace(-math.pi / 2, math.pi / 2, 9)
    spine = [(x - 0.006 + 0.006 * math.cos(a), h / 2 + (h / 2) * math.sin(a)) for a in angle]
    back = sweeps.extruded([*spine, (x - 0.012, h), (x - 0.012, 0.0)], -y, y)
    back = back._replace(
        vertices=back.vertices[:, [0, 2, 1]], normals=back.normals[:, [0, 2, 1]], faces=back.faces[:, ::-1]
    )
    leaves = solids.box((-x + 0.004, -y + 0.004, t - 0.0005), (x - 0.006, y - 0.004, h - t + 0.0005), 0.0, 0)
    front = sweeps.lying((-0.001, 0.0, h + 0.0003), w - 0.012, d - 0.002)
    return [
        *(materials.piece(shape, cloth) for shape in (*boards, back)),
        materials.piece(leaves, Material(texture="pages", specular=0.0)),
        materials.piece(front, materials.picture(f"cover_{_COVERS.get(draft.color(0), 1)}")),
    ]


def newspaper(draft: Draft) -> list[Piece]:
    """A folded newspaper."""
    w, d, h = draft.size
    slab = solids.box((-w / 2, -d / 2, 0.0), (w / 2, d / 2, h), 0.45 * h, 2)
    show = shaping.turned(sweeps.lying((0.0, 0.0, h + 0.0003), 0.97 * d, 0.97 * w), "z", math.pi / 2)
    return [
        materials.piece(slab, materials.paint(c.PAPER, 0.02)),
        materials.piece(show, materials.picture("newspaper")),
    ]


def carton(draft: Draft) -> list[Piece]:
    """A cardboard box, taped shut."""
    w, d, h = draft.size
    x, y = w / 2, d / 2
    body = solids.box((-x + 0.001, -y + 0.001, 0.0), (x - 0.001, y - 0.001, h - 0.001), 0.003)
    tape = [solids.box((-x, -0.03, h - 0.09), (x, 0.03, h), 0.0, 0)]
    flaps = solids.box((-x, -y, h - 0.004), (x, y, h - 0.0006), 0.0, 0)
    tint = draft.color(0)
    board = materials.tinted("cardboard", tint)
    return [
        *(materials.piece(s, board) for s in (body, flaps)),
        *(materials.piece(s, materials.paint((0.80, 0.68, 0.48, 1.0), 0.5)) for s in tape),
    ]


def tissue_box(draft: Draft) -> list[Piece]:
    """A box with a tissue that sticks out of it."""
    w, d, h = draft.size
    top = 0.72 * h
    box = solids.box((-w / 2, -d / 2, 0.0), (w / 2, d / 2, top), 0.003)
    slot = solids.cylinder((0.0, 0.0, top), 0.3 * min(w, d), 0.001, "z", 20)
    u, v = np.meshgrid(np.linspace(-1.0, 1.0, 9), np.linspace(0.0, 1.0, 5), indexing="ij")
    x, y = 0.22 * w * u * (0.35 + 0.65 * v), 0.10 * d * np.sin(3.5 * u + 2.0 * v) * v
    z = top - 0.004 + (h - top) * v * (1.0 - 0.2 * u**2)
    tissue = sweeps.sheet(np.stack([x, y, z], -1), np.stack([u, v], -1) * 0.1, 0.001)
    return [
        materials.piece(box, materials.tinted("dots", draft.color(0))),
        materials.piece(shaping.stretched(slot, 1.5, 0.8, 1.0), materials.paint(c.IRON, 0.0)),
        materials.piece(tissue, materials.paint(c.WHITE, 0.02)),
    ]


def paper_roll(draft: Draft) -> list[Piece]:
    """A kitchen roll that stands on its end."""
    r, h = min(draft.size[:2]) / 2, draft.size[2]
    paper = [(0.30 * r, 0.0), (0.97 * r, 0.0), (r, 0.01 * h), (r, 0.99 * h), (0.97 * r, h), (0.30 * r, h)]
    core = [(0.30 * r, h), (0.26 * r, h), (0.26 * r, 0.0)]
    return [materials.piece(solids.lathe(paper, 24), materials.cloth(draft.color(0), "quilt")),
        materials.piece(solids.lathe(core, 14), materials.tinted("cardboard", c.CARDBOARD))]  # fmt: skip


def cloth(draft: Draft) -> list[Piece]:
    """A folded cloth: soft layers, with the folds at one side."""
    w, d, h = draft.size
    layers: list[Mesh] = []
    for k in range(3):
        x, y, low, high = w / 2 - 0.006 * (k % 2), d / 2 - 0.006 * (k % 2), k * h / 3, (k + 1) * h / 3
        layers.append(solids.soft((-x, -y, low), (x, y, high), 0.45 * h / 3, 0.0, 2, 1))
    return [materials.piece(shape, materials.cloth(draft.color(0), "plaid")) for shape in layers]


def sponge(draft: Draft) -> list[Piece]:
    """A sponge with a scouring side."""
    w, d, h = draft.size
    foam = solids.box((-w / 2, -d / 2, 0.0), (w / 2, d / 2, 0.72 * h), 0.005, 2)
    pad = solids.box((-w / 2, -d / 2, 0.70 * h), (w / 2, d / 2, h), 0.004, 2)
    return [
        materials.piece(foam, materials.cloth(draft.color(0), "felt")),
        materials.piece(pad, materials.cloth(c.LEAF, "felt")),
    ]
