"""A low two-wheeled base with a camera on a mast, in the manner of a LoCoBot: it looks and tells, it cannot grasp."""

from __future__ import annotations

import math

from hthor import rules
from hthor.types import Part, Rgba, RobotSpec

SPEC = RobotSpec(
    name="scout",
    title="scout",
    radius=0.18,
    height=0.95,
    eye=0.90,
    fov=(2.0, math.pi / 2),  # a wide-angle camera, 115 by 90 degrees
    speed=1.8,  # 1.0 turns included, 2.6 times a person's pace; the paper's results imply 1.5 to 5.5 times
    turn_rate=math.pi,  # of a Kobuki base, 180 degrees a second
    sight_range=rules.DETECTOR_RANGE_M,
    scan_range=5.0,
    scan_beams=61,
    pitch_limit=rules.PITCH_LIMIT_RAD,
    capabilities=frozenset({"navigate"}),
)

_WHITE: Rgba = (0.92, 0.92, 0.93, 1.0)
_DARK: Rgba = (0.15, 0.16, 0.18, 1.0)
_MINT: Rgba = (0.30, 0.72, 0.62, 1.0)


def look() -> tuple[Part, ...]:
    """Drum, wheels, deck, mast and camera head."""
    return (
        Part(shape="cylinder", centre=(0.0, 0.0, 0.10), half=(0.17, 0.17, 0.06), rgba=_DARK),
        *(
            Part(shape="box", centre=(0.0, side * 0.165, 0.05), half=(0.05, 0.015, 0.05), rgba=_DARK)
            for side in (-1.0, 1.0)
        ),
        Part(shape="cylinder", centre=(0.0, 0.0, 0.17), half=(0.18, 0.18, 0.012), rgba=_MINT),
        Part(shape="cylinder", centre=(0.0, 0.0, 0.28), half=(0.15, 0.15, 0.10), rgba=_WHITE),
        Part(shape="cylinder", centre=(-0.04, 0.0, 0.60), half=(0.025, 0.025, 0.24), rgba=_WHITE),
        Part(shape="box", centre=(0.0, 0.0, 0.895), half=(0.05, 0.09, 0.055), rgba=_WHITE),
        Part(shape="box", centre=(0.051, 0.0, 0.90), half=(0.004, 0.07, 0.025), rgba=_DARK),
        *(
            Part(shape="sphere", centre=(0.054, side * 0.045, 0.90), half=(0.013, 0.013, 0.013), rgba=_MINT)
            for side in (-1.0, 1.0)
        ),
    )
