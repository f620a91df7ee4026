"""A flat disc on the floor, similar to a robot vacuum: it can only move, look up from below, and report."""

from hthor import rules
from hthor.looks.meshes import sweeps
from hthor.looks.meshes.mesh import Piece
from hthor.types import Part, Rgba, RobotSpec, Vec3
from hthor.world.model.bodies import meshes
from hthor.world.model.bodies.primitives import HEAD, ball, box, post, rod, wheel

# Robot vacuums measure 0.34 to 0.35 m across and 0.09 m in height. Speed, turn rate and field of view are our choice.
SPEC = RobotSpec(
    name="puck",
    title="puck",
    radius=0.17,
    height=0.12,
    eye=0.10,
    fov=(2.0, 1.6),
    speed=0.8,
    turn_rate=3.0,
    sight_range=rules.DETECTOR_RANGE_M,
    scan_range=4.0,
    scan_beams=61,
    pitch_limit=rules.PITCH_LIMIT_RAD,
    capabilities=frozenset({"navigate"}),
)

NECK: Vec3 = (0.09, 0.0, 0.09)

_GRAPHITE: Rgba = (0.20, 0.21, 0.24, 1.0)
_SILVER: Rgba = (0.78, 0.79, 0.81, 1.0)
_BUMPER: Rgba = (0.11, 0.11, 0.13, 1.0)
_RUBBER: Rgba = (0.06, 0.06, 0.07, 1.0)
_SKY: Rgba = (0.30, 0.66, 0.95, 1.0)
_LENS: Rgba = (0.04, 0.04, 0.06, 1.0)


def look() -> tuple[Part, ...]:
    """Disc with a bumper, a silver lid with a lit button, wheels below, and a small eye in front."""
    return (
        *(wheel((0.0, side * 0.12, 0.03), 0.03, 0.012, _RUBBER) for side in (-1.0, 1.0)),
        ball((-0.11, 0.0, 0.015), 0.015, _SILVER),
        post((0.0, 0.0, 0.045), 0.17, 0.027, _BUMPER),
        post((0.0, 0.0, 0.080), 0.163, 0.008, _GRAPHITE),
        post((-0.01, 0.0, 0.089), 0.12, 0.002, _SILVER),
        post((-0.03, 0.0, 0.092), 0.026, 0.003, _SKY),
        box((0.095, 0.0, 0.103), (0.022, 0.036, 0.016), _GRAPHITE, HEAD),
        rod((0.118, 0.0, 0.103), 0.011, 0.004, _LENS, HEAD),
    )


def pieces() -> tuple[Piece, ...]:
    """The robot's meshes, for pictures for people."""
    silver, graphite, rubber = meshes.gloss(_SILVER), meshes.gloss(_GRAPHITE), meshes.matte(_RUBBER)
    bumper = [(0.0, 0.016), (0.15, 0.016), (0.166, 0.026), (0.17, 0.045), (0.168, 0.066), (0.160, 0.072), (0.0, 0.072)]
    lid = [(0.162, 0.071), (0.163, 0.078), (0.156, 0.086), (0.13, 0.0895), (0.0, 0.0895)]
    plate = [(0.122, 0.088), (0.121, 0.0905), (0.117, 0.0915), (0.0, 0.0915)]
    return (
        *(meshes.tire((0.0, side * 0.12, 0.03), 0.03, 0.013, rubber) for side in (-1.0, 1.0)),
        meshes.ball((-0.11, 0.0, 0.014), 0.014, silver),
        meshes.turned(bumper, meshes.matte(_BUMPER)),
        meshes.turned(lid, graphite),
        meshes.turned(plate, silver, (-0.01, 0.0, 0.0)),
        meshes.rod((-0.03, 0.0, 0.0925), 0.028, 0.006, "z", meshes.glow(_SKY)),
        *(meshes.rod((-0.03, side * 0.055, 0.092), 0.010, 0.004, "z", graphite) for side in (-1.0, 1.0)),
        meshes.tube(sweeps.bend((0.137, -0.075, 0.05), (0.168, 0.0, 0.05), (0.137, 0.075, 0.05)), 0.004, graphite),
        meshes.box((0.095, 0.0, 0.102), (0.023, 0.038, 0.017), graphite, 0.012, HEAD),
        meshes.rod((0.117, 0.0, 0.103), 0.013, 0.008, "x", silver, HEAD),
        meshes.ball((0.118, 0.0, 0.103), 0.010, meshes.gloss(_LENS), HEAD),
    )
