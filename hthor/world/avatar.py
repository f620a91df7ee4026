"""The person's body: what it can do and what it looks like; knows nothing of who is in it.

Speed, turn rate and field of view are those of a person in a headset with a stick in either hand (see `rules`).
"""

from __future__ import annotations

import math

from hthor import rules
from hthor.types import HUMAN as SEAT
from hthor.types import BodySpec, Part, Rgba, Vec3

HUMAN = BodySpec(
    name=SEAT,
    title="person",
    radius=0.20,
    height=1.75,
    eye=1.60,
    fov=(math.radians(97.0), math.radians(98.0)),
    speed=rules.PACE_M_S,
    turn_rate=2.5,
    sight_range=12.0,
    scan_range=8.0,
    scan_beams=49,
    pitch_limit=math.radians(60.0),
    capabilities=frozenset({"navigate", "pick", "open"}),
    reach=1.2,
    reach_low=0.0,
    reach_high=2.0,
    strength=5.0,
    handling=rules.HANDLING_S,
)

_SKIN: Rgba = (0.84, 0.66, 0.54, 1.0)
_HAIR: Rgba = (0.24, 0.17, 0.13, 1.0)
_SHIRT: Rgba = (0.20, 0.45, 0.62, 1.0)
_TROUSERS: Rgba = (0.26, 0.28, 0.36, 1.0)
_SHOES: Rgba = (0.16, 0.14, 0.14, 1.0)
_EYE: Rgba = (0.10, 0.10, 0.12, 1.0)


def look() -> tuple[Part, ...]:
    """A dressed figure 1.75 m tall, one arm held out in front of the chest, body frame (x ahead, y left)."""
    return (
        *(_leg(side) for side in (-1, 1)),
        *(_box((0.03, side * 0.09, 0.04), (0.12, 0.045, 0.04), _SHOES) for side in (-1, 1)),
        _pillar((0.0, 0.0, 0.92), 0.15, 0.07, _TROUSERS),
        _pillar((0.0, 0.0, 1.20), 0.16, 0.22, _SHIRT),
        _ball((0.0, 0.17, 1.38), 0.07, _SHIRT),
        _ball((0.0, -0.17, 1.38), 0.07, _SHIRT),
        _ball((0.0, 0.0, 1.40), 0.13, _SHIRT),
        _pillar((0.0, 0.0, 1.49), 0.05, 0.06, _SKIN),
        _ball((0.015, 0.0, 1.615), 0.108, _SKIN),
        _ball((-0.015, 0.0, 1.64), 0.11, _HAIR),
        *(_ball((0.112, side * 0.04, 1.63), 0.013, _EYE) for side in (-1, 1)),
        _pillar((0.0, 0.20, 1.16), 0.045, 0.20, _SHIRT),
        _ball((0.0, 0.20, 0.92), 0.05, _SKIN),
        _pillar((0.0, -0.20, 1.22), 0.045, 0.14, _SHIRT),
        _box((0.14, -0.18, 1.06), (0.14, 0.04, 0.04), _SHIRT),
        _ball((0.30, -0.15, 1.06), 0.05, _SKIN),
    )


def _leg(side: int) -> Part:
    return _pillar((0.0, side * 0.09, 0.46), 0.07, 0.40, _TROUSERS)


def _pillar(centre: Vec3, radius: float, half_height: float, rgba: Rgba) -> Part:
    return Part(shape="cylinder", centre=centre, half=(radius, radius, half_height), rgba=rgba)


def _ball(centre: Vec3, radius: float, rgba: Rgba) -> Part:
    return Part(shape="sphere", centre=centre, half=(radius, radius, radius), rgba=rgba)


def _box(centre: Vec3, half: Vec3, rgba: Rgba) -> Part:
    return Part(shape="box", centre=centre, half=half, rgba=rgba)
