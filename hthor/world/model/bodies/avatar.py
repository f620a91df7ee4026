"""A person's body: its abilities and its looks.

Speed, turn rate and field of view are those of a person in a headset with a stick in either hand (see `rules`).
"""

import math

from hthor import rules
from hthor.types import HUMAN as SEAT
from hthor.types import BodySpec, Part, Rgba, Vec3, is_person
from hthor.world.model.bodies.primitives import HEAD, ball, box, post, rod, wheel

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

NECK: Vec3 = (0.0, 0.0, 1.53)
HAND: Vec3 = (0.318, -0.12, 1.045)

SKIN: Rgba = (0.84, 0.66, 0.54, 1.0)
HAIR: Rgba = (0.24, 0.17, 0.13, 1.0)
JUMPER: Rgba = (0.20, 0.45, 0.62, 1.0)
CUFF: Rgba = (0.15, 0.34, 0.48, 1.0)
COLLAR: Rgba = (0.93, 0.93, 0.90, 1.0)
TROUSERS: Rgba = (0.26, 0.28, 0.36, 1.0)
BELT: Rgba = (0.28, 0.19, 0.12, 1.0)
SHOES: Rgba = (0.16, 0.14, 0.14, 1.0)
SOLES: Rgba = (0.86, 0.85, 0.82, 1.0)
EYE: Rgba = (0.12, 0.11, 0.12, 1.0)
LIPS: Rgba = (0.70, 0.42, 0.38, 1.0)
_OUTFITS: tuple[tuple[Rgba, Rgba], ...] = (
    (JUMPER, CUFF),
    ((0.66, 0.33, 0.24, 1.0), (0.50, 0.24, 0.17, 1.0)),
    ((0.36, 0.50, 0.29, 1.0), (0.27, 0.38, 0.21, 1.0)),
    ((0.50, 0.38, 0.58, 1.0), (0.38, 0.28, 0.45, 1.0)),
)
"""Colours of the jumper and the cuffs of the first, second, third and fourth person; the fifth is dressed as the first.
"""
_SIDES = (1.0, -1.0)


def outfit(seat: str) -> dict[Rgba, Rgba]:
    """The colours of a person's clothes by those of the first person's; for any other seat, nothing."""
    number = int(seat.removeprefix(SEAT) or 1) - 1 if is_person(seat) else 0
    return dict(zip(_OUTFITS[0], _OUTFITS[number % len(_OUTFITS)], strict=True))


def look() -> tuple[Part, ...]:
    """A dressed figure 1.75 m tall, the right hand held out palm up, body frame (x ahead, y left)."""
    return (*(part for side in _SIDES for part in _leg(side)), *_trunk(), *_arms(), *_head())


def _leg(side: float) -> tuple[Part, ...]:
    y = side * 0.095
    return (
        box((0.03, y, 0.01), (0.118, 0.041, 0.01), SOLES),
        box((0.005, y, 0.042), (0.09, 0.038, 0.024), SHOES),
        ball((0.10, y, 0.038), 0.038, SHOES),
        post((-0.01, y, 0.27), 0.061, 0.21, TROUSERS),
        post((0.0, y * 0.95, 0.69), 0.073, 0.23, TROUSERS),
    )


def _trunk() -> tuple[Part, ...]:
    return (
        *(post((0.0, side * 0.055, 0.93), 0.108, 0.065, TROUSERS) for side in _SIDES),
        *(post((0.0, side * 0.055, 0.985), 0.112, 0.018, BELT) for side in _SIDES),
        *(post((0.0, side * 0.06, 1.20), 0.110, 0.20, JUMPER) for side in _SIDES),
        wheel((0.0, 0.0, 1.39), 0.085, 0.11, JUMPER),
        post((0.0, 0.0, 1.465), 0.066, 0.02, COLLAR),
        post((0.0, 0.0, 1.50), 0.05, 0.05, SKIN),
    )


def _arms() -> tuple[Part, ...]:
    return (
        *(ball((0.0, side * 0.15, 1.395), 0.078, JUMPER) for side in _SIDES),
        post((0.0, 0.185, 1.25), 0.050, 0.15, JUMPER),
        post((0.01, 0.19, 1.02), 0.043, 0.12, JUMPER),
        post((0.012, 0.19, 0.90), 0.045, 0.015, CUFF),
        box((0.02, 0.19, 0.845), (0.040, 0.018, 0.050), SKIN),
        post((0.0, -0.185, 1.24), 0.050, 0.14, JUMPER),
        ball((0.0, -0.185, 1.10), 0.052, JUMPER),
        rod((0.11, -0.17, 1.075), 0.042, 0.10, JUMPER),
        rod((0.215, -0.165, 1.07), 0.044, 0.014, CUFF),
        box((0.29, -0.135, 1.034), (0.065, 0.045, 0.011), SKIN),
        box((0.265, -0.185, 1.055), (0.035, 0.012, 0.022), SKIN),
    )


def _head() -> tuple[Part, ...]:
    return (
        post((0.015, 0.0, 1.56), 0.062, 0.03, SKIN, HEAD),
        ball((0.02, 0.0, 1.62), 0.098, SKIN, HEAD),
        ball((-0.012, 0.0, 1.643), 0.107, HAIR, HEAD),
        *(ball((0.0, side * 0.103, 1.615), 0.022, SKIN, HEAD) for side in _SIDES),
        *(ball((0.108, side * 0.036, 1.635), 0.012, EYE, HEAD) for side in _SIDES),
        ball((0.122, 0.0, 1.608), 0.014, SKIN, HEAD),
        box((0.103, 0.0, 1.572), (0.008, 0.024, 0.005), LIPS, HEAD),
    )
