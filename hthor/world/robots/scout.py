"""A low two-wheeled base with a camera on a mast, similar to a LoCoBot: it looks and reports but cannot grasp."""

import math

from hthor import rules
from hthor.looks.meshes.mesh import Piece
from hthor.types import Part, Rgba, RobotSpec, Vec3
from hthor.world.model.bodies import meshes
from hthor.world.model.bodies.primitives import HEAD, ball, box, post, rod, wheel

SPEC = RobotSpec(
    name="scout",
    title="scout",
    radius=0.18,
    height=0.95,
    eye=0.90,
    fov=(2.0, math.pi / 2),  # a wide-angle camera, 115 by 90 degrees
    speed=2.5,  # the only system setting that the calibration depends on, see docs/humans.md
    turn_rate=2.0 * math.pi,  # the robots of the paper turn instantly
    sight_range=rules.DETECTOR_RANGE_M,
    scan_range=5.0,
    scan_beams=61,
    pitch_limit=rules.PITCH_LIMIT_RAD,
    capabilities=frozenset({"navigate"}),
)

NECK: Vec3 = (-0.02, 0.0, 0.88)

_WHITE: Rgba = (0.92, 0.92, 0.93, 1.0)
_DARK: Rgba = (0.15, 0.16, 0.18, 1.0)
_RUBBER: Rgba = (0.08, 0.08, 0.09, 1.0)
_STEEL: Rgba = (0.62, 0.64, 0.67, 1.0)
_MINT: Rgba = (0.30, 0.72, 0.62, 1.0)


def look() -> tuple[Part, ...]:
    """Drum on two wheels, two decks on posts with the computer between them, mast and camera head."""
    return (
        *(wheel((0.0, side * 0.15, 0.052), 0.052, 0.018, _RUBBER) for side in (-1.0, 1.0)),
        post((0.0, 0.0, 0.075), 0.165, 0.045, _DARK),
        post((0.0, 0.0, 0.127), 0.172, 0.007, _MINT),
        *(post((x, y, 0.195), 0.008, 0.062, _STEEL) for x in (-0.09, 0.09) for y in (-0.09, 0.09)),
        box((-0.01, 0.0, 0.18), (0.075, 0.065, 0.035), _WHITE),
        post((0.0, 0.0, 0.262), 0.155, 0.006, _MINT),
        box((-0.04, 0.0, 0.56), (0.018, 0.022, 0.295), _STEEL),
        box((-0.03, 0.0, 0.865), (0.03, 0.03, 0.025), _DARK),
        box((0.0, 0.0, 0.912), (0.045, 0.085, 0.035), _WHITE, HEAD),
        box((0.042, 0.0, 0.905), (0.006, 0.075, 0.022), _DARK, HEAD),
        *(rod((0.05, side * 0.045, 0.905), 0.014, 0.006, _STEEL, HEAD) for side in (-1.0, 1.0)),
        ball((0.048, 0.0, 0.905), 0.008, _MINT, HEAD),
    )


def pieces() -> tuple[Piece, ...]:
    """The robot's meshes, for pictures for people."""
    white, dark, mint = meshes.gloss(_WHITE), meshes.matte(_DARK), meshes.gloss(_MINT)
    steel, rubber = meshes.metal(_STEEL), meshes.matte(_RUBBER)
    drum = [(0.0, 0.028), (0.15, 0.028), (0.168, 0.045), (0.172, 0.075), (0.168, 0.105), (0.155, 0.12), (0.0, 0.12)]
    return (
        *(meshes.tire((0.0, side * 0.15, 0.052), 0.052, 0.02, rubber) for side in (-1.0, 1.0)),
        *(meshes.rod((0.0, side * 0.168, 0.052), 0.024, 0.008, "y", steel) for side in (-1.0, 1.0)),
        meshes.turned(drum, dark),
        meshes.rod((0.0, 0.0, 0.127), 0.174, 0.012, "z", mint),
        *(meshes.rod((x, y, 0.195), 0.007, 0.13, "z", steel) for x in (-0.09, 0.09) for y in (-0.09, 0.09)),
        meshes.box((-0.01, 0.0, 0.176), (0.078, 0.068, 0.042), white, 0.014),
        *(meshes.box((0.069, y, 0.176), (0.001, 0.003, 0.02), dark, 0.0005) for y in (-0.03, -0.015, 0.0, 0.015, 0.03)),
        meshes.rod((0.0, 0.0, 0.262), 0.157, 0.012, "z", mint),
        meshes.rod((0.075, 0.0, 0.288), 0.036, 0.04, "z", dark),
        meshes.box((-0.04, 0.0, 0.56), (0.018, 0.022, 0.295), steel, 0.004),
        *(meshes.box((-0.04, side * 0.0225, 0.56), (0.004, 0.001, 0.28), dark, 0.0005) for side in (-1.0, 1.0)),
        meshes.tube(((-0.064, 0.0, 0.27), (-0.066, 0.01, 0.55), (-0.06, 0.0, 0.86)), 0.005, dark),
        meshes.rod((-0.03, 0.0, 0.862), 0.034, 0.03, "z", dark),
        meshes.rod((-0.02, 0.0, 0.885), 0.018, 0.09, "y", steel, HEAD),
        meshes.box((0.0, 0.0, 0.914), (0.044, 0.088, 0.034), white, 0.022, HEAD),
        meshes.box((0.040, 0.0, 0.908), (0.006, 0.076, 0.022), meshes.gloss(_DARK), 0.005, HEAD),
        *(meshes.rod((0.048, side * 0.045, 0.908), 0.015, 0.010, "x", steel, HEAD) for side in (-1.0, 1.0)),
        *(meshes.ball((0.050, side * 0.045, 0.908), 0.010, meshes.gloss(_RUBBER), HEAD) for side in (-1.0, 1.0)),
        meshes.ball((0.046, 0.0, 0.908), 0.007, meshes.glow(_MINT), HEAD),
    )
