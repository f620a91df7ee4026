"""Electronics: televisions, computers, laptops, phones, remote controls."""

import math

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Mesh, Piece
from hthor.types import Rgba

_LIT = 0.85


def _screen(w: float, low: float, high: float, back: float, front: float, picture: str, body: Rgba) -> list[Piece]:
    """A thin panel with a dark rim around a glowing picture."""
    edge = min(0.012, 0.03 * w)
    slab = solids.box((-w / 2, back + 0.35 * (front - back), low), (w / 2, front, high), 0.004)
    bulge = solids.box(
        (-0.34 * w, back, low + 0.1 * (high - low)), (0.34 * w, front - 0.002, high - 0.2 * (high - low)), 0.01
    )
    show = sweeps.panel((0.0, front + 0.0006, (low + high) / 2 + 0.3 * edge), w - 2 * edge, high - low - 2.6 * edge)
    dark = materials.paint(body, 0.5)
    return [
        materials.piece(slab, dark),
        materials.piece(bulge, dark),
        materials.piece(show, materials.picture(picture, _LIT)),
    ]


def television(draft: Draft) -> list[Piece]:
    """A flat screen with a picture on it, on two splayed feet."""
    w, d, h = draft.size
    body = draft.color(0)
    low, y = 0.075 * h, 0.08 * d
    feet: list[Mesh] = []
    for s in (-1.0, 1.0):
        at, foot = s * 0.33 * w, d / 2 - 0.006
        path = [(at + s * 0.02, foot, 0.006), (at, y - 0.02, low + 0.01), (at + s * 0.02, -foot, 0.006)]
        feet.append(sweeps.tube(path, 0.006, 6))
    return [
        *_screen(w, low, h, -0.10 * d, max(y, 0.02), "show", body),
        *(materials.piece(shape, materials.metal(c.IRON)) for shape in feet),
    ]


def computer(draft: Draft) -> list[Piece]:
    """A monitor on a metal stand; its foot is as deep as the thing."""
    w, d, h = draft.size
    low = 0.24 * h
    foot = solids.box((-0.24 * w, -d / 2, 0.0), (0.24 * w, d / 2, 0.012), 0.005)
    neck = sweeps.tube([(0.0, -0.22 * d, 0.01), (0.0, -0.16 * d, 0.6 * h)], 0.018, 10)
    return [
        *_screen(w, low, h, -0.16 * d, 0.02 * d, "desktop", draft.color(0)),
        *(materials.piece(shape, materials.metal(c.STEEL)) for shape in (foot, neck)),
    ]


def laptop(draft: Draft) -> list[Piece]:
    """An open laptop: keys and a touchpad below, and a lit screen that leans back a little."""
    w, d, h = draft.size
    t = min(0.016, 0.1 * h)
    shell, dark = materials.metal(draft.color(0)), materials.paint(c.BLACK, 0.4)
    lean = min(0.03, 0.1 * d)
    base = solids.box((-w / 2, lean - d / 2, 0.0), (w / 2, d / 2, t), 0.005)
    keys = sweeps.lying((0.0, lean - d / 2 + 0.36 * d, t + 0.0005), 0.86 * w, 0.40 * d)
    pad = solids.box((-0.15 * w, 0.24 * d, t - 0.001), (0.15 * w, 0.44 * d, t + 0.0006), 0.0004)
    angle = math.atan2(lean - 0.006, h - t)
    high = (h - t) / math.cos(angle) - 0.002

    def hung(shape: Mesh) -> Mesh:
        return shaping.moved(shaping.turned(shape, "x", angle), 0.0, lean - d / 2 + 0.003, t - 0.001)

    lid = solids.box((-w / 2, -0.007, 0.0), (w / 2, 0.0, high), 0.003)
    face = sweeps.panel((0.0, 0.0006, high / 2), 0.97 * w, 0.94 * high)
    show = sweeps.panel((0.0, 0.0012, high / 2 + 0.004), 0.93 * w, 0.86 * high)
    return [
        materials.piece(base, shell),
        materials.piece(hung(lid), shell),
        materials.piece(pad, materials.metal(c.GREY)),
        materials.piece(keys, materials.picture("keyboard")),
        materials.piece(hung(face), dark),
        materials.piece(hung(show), materials.picture("desktop_2", _LIT)),
    ]


def phone(draft: Draft) -> list[Piece]:
    """A phone that lies on its back."""
    w, d, h = draft.size
    slab = solids.box((-w / 2, -d / 2, 0.0), (w / 2, d / 2, h), 0.45 * h, 2)
    show = sweeps.lying((0.0, 0.0, h + 0.0003), 0.90 * w, 0.92 * d)
    return [
        materials.piece(slab, materials.paint(draft.color(0), 0.7)),
        materials.piece(show, materials.picture("desktop", 0.35)),
    ]


def remote_control(draft: Draft) -> list[Piece]:
    """A slim remote control: rounded ends, a red key, a round pad, rows of small keys."""
    w, d, h = draft.size
    low = 0.82 * h
    body, keys = materials.paint(draft.color(0), 0.3), materials.paint(c.GREY, 0.2)
    slab = solids.box((-w / 2, -d / 2, 0.0), (w / 2, d / 2, low), 0.48 * low, 2)
    power = solids.cylinder((-0.28 * w, 0.42 * d, 0.5 * (low + h)), 0.10 * w, h - low + 0.004, "z", 12)
    found = [
        materials.piece(slab, body),
        materials.piece(power, materials.paint(draft.color(1), 0.3)),
        materials.piece(sweeps.ring((0.0, 0.14 * d, low), 0.27 * w, 0.05 * w, "z", 20, 6), keys),
        materials.piece(solids.cylinder((0.0, 0.14 * d, low), 0.12 * w, 0.003, "z", 12), materials.paint(c.STEEL, 0.4)),
        materials.piece(solids.box((0.12 * w, 0.395 * d, low - 0.001), (0.36 * w, 0.445 * d, h), 0.001), keys),
    ]
    high = low + 0.55 * (h - low)
    for y in (-0.04 * d - row * 0.085 * d for row in range(5)):
        for x in (column * 0.29 * w for column in (-1, 0, 1)):
            key = solids.box((x - 0.10 * w, y - 0.024 * d, low - 0.001), (x + 0.10 * w, y + 0.024 * d, high), 0.0, 0)
            found.append(materials.piece(key, keys))
    return found
