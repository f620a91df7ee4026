"""A slender column with a lift, an arm and a gripper, in the manner of a Stretch: it fetches, carries and opens."""

from __future__ import annotations

from hthor import rules
from hthor.types import Part, Rgba, RobotSpec

SPEC = RobotSpec(
    name="tender",
    title="tender",
    radius=0.20,
    height=1.42,
    eye=1.35,
    fov=(1.2, 1.2),
    speed=0.8,
    turn_rate=1.8,
    sight_range=rules.DETECTOR_RANGE_M,
    scan_range=5.0,
    scan_beams=61,
    pitch_limit=rules.PITCH_LIMIT_RAD,
    capabilities=frozenset({"navigate", "pick", "open"}),
    reach=0.9,
    reach_low=0.0,
    reach_high=1.6,
    strength=2.0,
    handling=2.0,
)

_WHITE: Rgba = (0.90, 0.90, 0.91, 1.0)
_DARK: Rgba = (0.17, 0.18, 0.20, 1.0)
_AMBER: Rgba = (0.93, 0.62, 0.24, 1.0)


def look() -> tuple[Part, ...]:
    """Base, column, lift, arm, gripper and head."""
    return (
        Part(shape="box", centre=(0.0, 0.0, 0.09), half=(0.16, 0.12, 0.06), rgba=_DARK),
        Part(shape="cylinder", centre=(0.0, 0.0, 0.16), half=(0.14, 0.14, 0.015), rgba=_AMBER),
        *(
            Part(shape="box", centre=(0.04, side * 0.15, 0.05), half=(0.05, 0.02, 0.05), rgba=_DARK)
            for side in (-1.0, 1.0)
        ),
        Part(shape="cylinder", centre=(-0.06, 0.0, 0.74), half=(0.035, 0.035, 0.58), rgba=_WHITE),
        Part(shape="box", centre=(-0.04, 0.0, 0.88), half=(0.07, 0.06, 0.06), rgba=_DARK),
        Part(shape="box", centre=(0.12, 0.0, 0.88), half=(0.14, 0.025, 0.025), rgba=_WHITE),
        *(
            Part(shape="box", centre=(0.30, side * 0.05, 0.88), half=(0.05, 0.008, 0.02), rgba=_AMBER)
            for side in (-1.0, 1.0)
        ),
        Part(shape="box", centre=(0.0, 0.0, 1.35), half=(0.06, 0.09, 0.05), rgba=_WHITE),
        Part(shape="box", centre=(0.061, 0.0, 1.35), half=(0.004, 0.07, 0.025), rgba=_DARK),
        Part(shape="cylinder", centre=(0.0, 0.0, 1.41), half=(0.04, 0.04, 0.01), rgba=_AMBER),
    )
