"""A slender column with a lift, an arm and a gripper, similar to a Stretch: it fetches, carries and opens."""

from typing import Any

from hthor import rules
from hthor.looks.meshes import sweeps
from hthor.looks.meshes.mesh import Piece
from hthor.types import Part, Rgba, RobotSpec, Vec3
from hthor.world.model.bodies import meshes
from hthor.world.model.bodies.primitives import HEAD, ball, box, post, rod, wheel

# Data sheet of Hello Robot's Stretch: 0.33 by 0.34 m on the floor, 1.41 m tall; the arm goes out by 0.52 m and up by
# 1.10 m, and holds 2 kg. Speed, turn rate, field of view and handling time are our choice.
SPEC = RobotSpec(
    name="tender",
    title="tender",
    radius=0.20,
    height=1.41,
    eye=1.35,
    fov=(1.2, 1.2),
    speed=0.8,
    turn_rate=1.8,
    sight_range=rules.DETECTOR_RANGE_M,
    scan_range=5.0,
    scan_beams=61,
    pitch_limit=rules.PITCH_LIMIT_RAD,
    capabilities=frozenset({"navigate", "pick", "open"}),
    reach=0.9,  # half the base, the arm's 0.52 m, and 0.2 m of wrist and gripper
    reach_low=0.0,
    reach_high=1.4,  # the lift's 1.10 m, the wrist above it, and the gripper tilted up
    strength=2.0,
    handling=2.0,
)

NECK: Vec3 = (-0.03, 0.0, 1.325)
HAND: Vec3 = (0.34, 0.0, 0.835)

_WHITE: Rgba = (0.90, 0.90, 0.91, 1.0)
_GREY: Rgba = (0.55, 0.57, 0.60, 1.0)
_DARK: Rgba = (0.17, 0.18, 0.20, 1.0)
_RUBBER: Rgba = (0.08, 0.08, 0.09, 1.0)
_AMBER: Rgba = (0.93, 0.62, 0.24, 1.0)


def look() -> tuple[Part, ...]:
    """Base, column, lift, telescoping arm, gripper and head."""
    return (
        *(wheel((0.03, side * 0.145, 0.05), 0.05, 0.015, _RUBBER) for side in (-1.0, 1.0)),
        box((-0.02, 0.0, 0.085), (0.14, 0.125, 0.05), _DARK),
        box((-0.02, 0.0, 0.14), (0.13, 0.115, 0.008), _WHITE),
        post((-0.08, 0.0, 0.72), 0.034, 0.58, _WHITE),
        box((-0.06, 0.0, 0.88), (0.065, 0.06, 0.075), _DARK),
        rod((0.06, 0.0, 0.88), 0.032, 0.07, _WHITE),
        rod((0.16, 0.0, 0.88), 0.025, 0.05, _GREY),
        rod((0.22, 0.0, 0.88), 0.018, 0.03, _WHITE),
        ball((0.255, 0.0, 0.88), 0.03, _DARK),
        *(box((0.30, side * 0.052, 0.88), (0.05, 0.006, 0.022), _AMBER) for side in (-1.0, 1.0)),
        *(wheel((0.355, side * 0.05, 0.88), 0.02, 0.01, _DARK) for side in (-1.0, 1.0)),
        post((-0.06, 0.0, 1.312), 0.028, 0.015, _DARK),
        box((-0.015, 0.0, 1.355), (0.035, 0.075, 0.028), _WHITE, HEAD),
        box((0.021, 0.0, 1.355), (0.004, 0.066, 0.02), _DARK, HEAD),
        post((-0.015, 0.0, 1.396), 0.026, 0.013, _AMBER, HEAD),
    )


def pieces() -> tuple[Piece, ...]:
    """The robot's meshes, for pictures for people."""
    white, dark, grey = meshes.gloss(_WHITE), meshes.gloss(_DARK), meshes.metal(_GREY)
    rubber, amber = meshes.matte(_RUBBER), meshes.gloss(_AMBER)
    arm = (
        (0.045, 0.034, 0.16, white),
        (0.13, 0.029, 0.13, grey),
        (0.19, 0.024, 0.11, white),
        (0.225, 0.019, 0.06, grey),
    )
    return (
        *(meshes.tire((0.03, side * 0.148, 0.05), 0.05, 0.017, rubber) for side in (-1.0, 1.0)),
        *(meshes.rod((0.03, side * 0.162, 0.05), 0.022, 0.008, "y", grey) for side in (-1.0, 1.0)),
        meshes.ball((-0.13, 0.0, 0.024), 0.024, rubber),
        meshes.box((-0.02, 0.0, 0.085), (0.142, 0.127, 0.048), dark, 0.03),
        meshes.box((-0.02, 0.0, 0.138), (0.132, 0.117, 0.010), white, 0.009),
        meshes.box((0.06, 0.0, 0.150), (0.045, 0.07, 0.008), amber, 0.006),
        meshes.box((-0.10, 0.0, 0.20), (0.055, 0.07, 0.06), dark, 0.02),
        meshes.rod((-0.08, 0.0, 0.72), 0.034, 1.16, "z", white),
        meshes.box((-0.045, 0.0, 0.72), (0.002, 0.008, 0.55), dark, 0.0015),
        meshes.box((-0.065, 0.0, 0.88), (0.068, 0.062, 0.078), dark, 0.022),
        meshes.box((0.004, 0.0, 0.93), (0.002, 0.04, 0.008), meshes.glow(_AMBER), 0.0015),
        *(meshes.rod((x, 0.0, 0.88), radius, length, "x", material) for x, radius, length, material in arm),
        meshes.ball((0.258, 0.0, 0.88), 0.03, dark),
        *(meshes.tube(_finger(side), 0.0075, amber) for side in (-1.0, 1.0)),
        *(meshes.rod((0.352, side * 0.05, 0.88), 0.021, 0.016, "y", rubber) for side in (-1.0, 1.0)),
        meshes.rod((-0.06, 0.0, 1.305), 0.030, 0.05, "z", dark),
        meshes.rod((-0.03, 0.0, 1.33), 0.017, 0.10, "y", grey, HEAD),
        meshes.box((-0.012, 0.0, 1.358), (0.034, 0.078, 0.028), white, 0.018, HEAD),
        meshes.box((0.018, 0.0, 1.357), (0.006, 0.068, 0.020), dark, 0.005, HEAD),
        *(meshes.ball((0.022, y, 1.357), 0.009, meshes.gloss(_RUBBER), HEAD) for y in (-0.045, 0.0, 0.045)),
        meshes.rod((-0.015, 0.0, 1.396), 0.027, 0.028, "z", meshes.glow(_AMBER), HEAD),
    )


def _finger(side: float) -> Any:
    """A bow that ends in a suction cup."""
    return sweeps.bend((0.262, side * 0.012, 0.88), (0.29, side * 0.066, 0.88), (0.352, side * 0.062, 0.88))
