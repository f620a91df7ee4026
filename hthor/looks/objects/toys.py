"""Balls, bears, bats and other things for play, training or decoration."""

import math

import numpy as np

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Material, Piece


def basketball(_: Draft) -> list[Piece]:
    """A ball with seams."""
    shape = solids.ball((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), 28, whole=True)
    return [materials.piece(shape, Material(texture="basketball", specular=0.15, shininess=0.2))]


def teddy_bear(draft: Draft) -> list[Piece]:
    """A sitting bear."""
    fur, pale, dark = (materials.cloth(rgba, "felt") for rgba in (draft.color(0), c.SHELL, c.BLACK))
    limbs = [((0.0, 0.0, 0.34), (0.26, 0.22, 0.28)), ((0.0, 0.02, 0.74), (0.22, 0.19, 0.19))]
    for s in (-1.0, 1.0):
        limbs += [((s * 0.20, 0.26, 0.11), (0.10, 0.24, 0.11)), ((s * 0.29, 0.12, 0.44), (0.10, 0.14, 0.18)),
            ((s * 0.17, 0.0, 0.91), (0.085, 0.05, 0.085))]  # fmt: skip
    found = [materials.piece(solids.ball(at, half, 16), fur) for at, half in limbs]
    found.append(materials.piece(solids.ball((0.0, 0.17, 0.69), (0.10, 0.08, 0.075), 12), pale))
    found.append(materials.piece(solids.ball((0.0, 0.13, 0.36), (0.15, 0.10, 0.18), 12), pale))
    found.append(materials.piece(solids.ball((0.0, 0.245, 0.715), (0.030, 0.02, 0.022), 10), dark))
    for s in (-1.0, 1.0):
        found.append(materials.piece(solids.ball((s * 0.075, 0.185, 0.79), (0.021, 0.016, 0.021), 8), dark))
        found.append(materials.piece(solids.ball((s * 0.20, 0.485, 0.11), (0.06, 0.02, 0.065), 10), pale))
    return found


def statue(draft: Draft) -> list[Piece]:
    """A bust on a plinth."""
    stone = materials.tinted("marble", draft.color(0), 0.4, 0.5)
    plinth = [(0.0, 0.0), (0.42, 0.0), (0.42, 0.05), (0.34, 0.08), (0.26, 0.12), (0.24, 0.2), (0.3, 0.23), (0.0, 0.25)]
    chest = [(0.0, 0.24), (0.2, 0.25), (0.28, 0.33), (0.4, 0.44), (0.43, 0.5), (0.36, 0.55), (0.18, 0.6), (0.13, 0.72)]
    head = solids.ball((0.0, 0.03, 0.82), (0.17, 0.20, 0.21), 18)
    nose = solids.ball((0.0, 0.22, 0.80), (0.03, 0.05, 0.05), 8)
    hair = solids.ball((0.0, -0.02, 0.87), (0.19, 0.19, 0.18), 14)
    shapes = [solids.lathe(plinth, 24), shaping.stretched(solids.lathe(chest, 24), 1.0, 0.72, 1.0), head, nose, hair]
    return [materials.piece(shape, stone) for shape in shapes]


def bat(draft: Draft) -> list[Piece]:
    """A wooden baseball bat with a taped grip."""
    w, d, _ = draft.size
    r = w / 2
    body = [(0.0, -0.5), (0.62, -0.5), (0.66, -0.488), (0.36, -0.47), (0.38, -0.15), (0.72, 0.12), (1.0, 0.32),
        (1.0, 0.47), (0.8, 0.5), (0.0, 0.5)]  # fmt: skip
    tape = [(0.40, -0.46), (0.42, -0.20)]
    return [
        materials.piece(solids.along(solids.lathe(body, 16, (r, d)), "y"), materials.wood(draft.color(0))),
        materials.piece(solids.along(solids.lathe(tape, 16, (r, d)), "y"), materials.leather(c.IRON)),
    ]


def racket(draft: Draft) -> list[Piece]:
    """A tennis racket: an oval frame with strings, a throat and a grip."""
    w, d, h = draft.size
    r, a, b = h / 2, w / 2 - h / 2, 0.26 * d
    at = d / 2 - b - h / 2
    angle = np.linspace(0.0, 2 * math.pi, 32, endpoint=False)
    rim = sweeps.tube(np.stack([a * np.cos(angle), at + b * np.sin(angle), np.full(32, r)], -1), r, 8, closed=True)
    strings = []
    for share in np.linspace(-0.75, 0.75, 7):
        x, y = a * float(share), b * float(share)
        long, wide = b * math.sqrt(1 - float(share) ** 2), a * math.sqrt(1 - float(share) ** 2)
        strings.append(solids.box((x - 0.0008, at - long, r - 0.0008), (x + 0.0008, at + long, r + 0.0008), 0.0, 0))
        strings.append(solids.box((-wide, at + y - 0.0008, r - 0.0008), (wide, at + y + 0.0008, r + 0.0008), 0.0, 0))
    throat = [
        sweeps.tube([(s * 0.55 * a, at - 0.82 * b, r), (s * 0.01, at - 1.55 * b, r)], 0.7 * r, 8) for s in (-1, 1)
    ]
    grip = sweeps.tube([(0.0, at - 1.45 * b, r), (0.0, -d / 2, r)], 0.98 * r, 10)
    frame = materials.paint(c.RED, 0.6)
    return [
        *(materials.piece(shape, frame) for shape in (rim, *throat)),
        materials.piece(grip, materials.leather(draft.colors()[-1])),
        *(materials.piece(shape, materials.paint(c.PAPER, 0.1)) for shape in strings),
    ]


def dumbbell(draft: Draft) -> list[Piece]:
    """Two heads on a knurled bar that lies along y."""
    w, d, _ = draft.size
    r, z = w / 2, w / 2
    found = [materials.piece(solids.cylinder((0.0, 0.0, z), 0.2 * r, 0.6 * d, "y", 14), materials.chrome())]
    head = [(0.0, -0.15), (0.8, -0.15), (1.0, -0.10), (1.0, 0.10), (0.8, 0.15), (0.0, 0.15)]
    for s in (-1.0, 1.0):
        disc = solids.along(solids.lathe(head, 6, (r, d)), "y")
        found.append(materials.piece(shaping.moved(disc, 0.0, s * 0.35 * d, z), materials.paint(draft.color(0), 0.3)))
    return found


def watering_can(draft: Draft) -> list[Piece]:
    """A can with a long spout to the front and a bow over it."""
    w, d, h = draft.size
    r, at = 0.46 * w, 0.46 * w - d / 2
    body = [(0.0, 0.0), (0.96, 0.0), (1.0, 0.03), (0.9, 0.62), (0.80, 0.66), (0.30, 0.68), (0.0, 0.66)]
    spout = sweeps.tube(
        [(0.0, at + 0.7 * r, 0.18 * h), (0.0, at + 1.5 * r, 0.42 * h), (0.0, d / 2 - 0.03, 0.84 * h)],
        [0.03, 0.018, 0.012],
        10,
    )
    rose = shaping.moved(
        shaping.turned(solids.lathe([(0.0, -0.02), (0.012, -0.02), (0.032, 0.014), (0.0, 0.02)], 14), "x", -0.7),
        0.0,
        d / 2 - 0.024,
        0.87 * h,
    )
    bow = sweeps.tube(
        sweeps.bend(
            (0.0, at + 0.6 * r, 0.66 * h),
            (0.0, at + 0.2 * r, 0.98 * h),
            (0.0, at - 0.8 * r, 0.86 * h),
            (0.0, at - 0.92 * r, 0.30 * h),
            steps=4,
        ),
        0.009,
        8,
    )
    coat = materials.paint(draft.color(0), 0.5)
    return [
        materials.piece(shape, coat)
        for shape in (shaping.moved(solids.lathe(body, 24, (r, h)), 0.0, at), spout, rose, bow)
    ]
