"""Things to lie on: beds with duvet and pillows, cushions, baskets for dogs."""

import math

import numpy as np

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Mesh, Piece


def bed(draft: Draft) -> list[Piece]:
    """A headboard, a frame, a mattress, a duvet turned down, and pillows that lean against the headboard.

    The pillows are outside the surface for objects, so that nothing is drawn where an object may lie.
    """
    w, d, h = draft.size
    rest = draft.surfaces[0]
    top, start = rest.centre[2], rest.centre[1] - rest.half[1]
    x, y, head = w / 2, d / 2, min(0.045, 0.04 * d)
    wood, cover = materials.guess(draft.parts[0].rgba), draft.parts[-1].rgba
    low, fold = 0.5 * top, -y + 0.34 * d
    frame = [
        solids.box((-x, -y, 0.0), (x, head - y, h), 0.012),
        solids.box((0.01 - x, head - y, 0.28 * low), (x - 0.01, y - 0.03, low), 0.01),
        *(solids.cylinder((s * (x - 0.06), y - 0.10, 0.15 * low), 0.022, 0.3 * low, "z", 10, 0.03) for s in (-1, 1)),
    ]
    for k in range(3):
        a, b = -x + 0.05 + k * (w - 0.1) / 3, -x + 0.05 + (k + 1) * (w - 0.1) / 3
        frame.append(solids.box((a + 0.01, head - y - 0.01, top + 0.02), (b - 0.01, head - y + 0.012, h - 0.05), 0.01))
    mattress = solids.soft((0.03 - x, head - y, low - 0.02), (x - 0.03, y - 0.07, top - 0.003), 0.05, 0.0, 2, 1)
    sheets = [materials.piece(mattress, materials.cloth(c.WHITE, "linen"))]
    duvet = _draped(x, fold, y, low - 0.06, top)
    turned = solids.soft((0.004 - x, fold - 0.16, top - 0.05), (x - 0.004, fold + 0.04, top + 0.004), 0.022, 0.0, 2, 1)
    count = 2 if w > 1.2 else 1
    broad = min(0.72, (w - 0.08) / count - 0.03)
    pillows = []
    for k in range(count):
        at = (k - (count - 1) / 2) * (w / count)
        deep = max(0.04, start - (head - y) - 0.004)
        tall = min(0.42, h - top - 0.03)
        shape = shaping.turned(solids.cushion((0.0, 0.0, 0.0), (broad, tall, deep), 10, 3.0), "x", math.pi / 2)
        pillows.append(shaping.moved(shape, at, head - y + deep / 2 + 0.002, top + tall / 2 - 0.012))
    return [
        *(materials.piece(shape, wood) for shape in frame),
        *sheets,
        materials.piece(duvet, materials.cloth(cover, "quilt")),
        materials.piece(turned, materials.cloth(c.WHITE, "stripes_fine")),
        *(materials.piece(shape, materials.cloth(c.WHITE, "linen")) for shape in pillows),
    ]


def _draped(x: float, start: float, y: float, low: float, top: float) -> Mesh:
    """A cover on a mattress from ``start`` to the foot: flat on top, with sides that hang down to ``low`` in folds."""
    across = np.array([-1.0, -1.0, -1.0, -0.995, -0.97, -0.90, -0.45, 0.0, 0.45, 0.90, 0.97, 0.995, 1.0, 1.0, 1.0])
    fall = np.array([1.0, 0.55, 0.22, 0.08, 0.015, 0.0, 0.0, 0.0, 0.0, 0.0, 0.015, 0.08, 0.22, 0.55, 1.0])
    down = np.concatenate([np.linspace(0.0, 0.93, 13), [0.97, 0.99, 1.0, 1.0, 1.0]])
    sink = np.concatenate([np.zeros(13), [0.01, 0.06, 0.2, 0.6, 1.0]])
    hang = np.maximum(fall[:, None], sink[None, :])
    fold = (
        0.012
        * np.sin(np.arange(len(down)) * 2.3)[None, :]
        * np.where((fall[:, None] > 0.3) & (sink[None, :] < 0.3), 1.0, 0.0)
    )
    width = across[:, None] * (x - 0.012) + np.sign(across)[:, None] * fold
    length = (
        start
        + (y - 0.012 - start) * down[None, :]
        + 0.012 * np.sin(np.arange(len(across)) * 2.1)[:, None] * (sink > 0.3) * (np.abs(across) < 1.0)[:, None]
    )
    heights = top - hang * (top - low)
    points = np.stack(np.broadcast_arrays(width, length, heights), -1)
    return sweeps.sheet(points, np.stack([points[..., 0] + points[..., 2], points[..., 1] - points[..., 2]], -1), 0.012)


def pillow(draft: Draft) -> list[Piece]:
    """A plump pillow with a seam."""
    w, d, h = draft.size
    shape = solids.cushion((0.0, 0.0, h / 2), (w, d, h), 14, 3.2)
    weave = "linen" if draft.color(0) in (c.CREAM, c.WHITE) else "canvas"
    return [materials.piece(shape, materials.cloth(draft.color(0), weave))]


def dog_bed(draft: Draft) -> list[Piece]:
    """A padded ring around a cushion, lower in front."""
    w, d, h = draft.size
    coat, inner = materials.cloth(draft.color(0), "felt"), materials.cloth(c.CREAM, "terry")
    r = 0.5 * h
    angle = np.linspace(0.0, 2 * math.pi, 36, endpoint=False)
    wide, deep = (
        np.abs(np.cos(angle)) ** 0.6 * np.sign(np.cos(angle)),
        np.abs(np.sin(angle)) ** 0.6 * np.sign(np.sin(angle)),
    )
    path = np.stack([(w / 2 - r) * wide, (d / 2 - r) * deep, np.full(36, r)], -1)
    pad = solids.cushion((0.0, 0.0, 0.32 * h), (w - 2.1 * r, d - 2.1 * r, 0.62 * h), 10, 4.0)
    return [
        *shaping.fitted(
            [materials.piece(sweeps.tube(path, r, 12, closed=True), coat)], (-w / 2, -d / 2, 0.0), (w / 2, d / 2, h)
        ),
        materials.piece(pad, inner),
    ]
