"""A broad service robot with two arms and a tray, similar to a Fetch or a TIAGo: strong, wide and slow."""

from typing import Any

from hthor import rules
from hthor.looks.meshes import sweeps
from hthor.looks.meshes.mesh import Piece
from hthor.types import Part, Rgba, RobotSpec, Vec3
from hthor.world.model.bodies import meshes
from hthor.world.model.bodies.primitives import HEAD, ball, box, post, rod, wheel

# Service robots of this kind measure 0.5 to 0.6 m across and 1.1 to 1.5 m in height; their arms reach 0.9 m and hold
# 3 to 6 kg. Speed, turn rate, field of view and handling time are our choice.
SPEC = RobotSpec(
    name="porter",
    title="porter",
    radius=0.30,
    height=1.34,
    eye=1.25,
    fov=(1.4, 1.1),
    speed=0.7,
    turn_rate=1.2,
    sight_range=rules.DETECTOR_RANGE_M,
    scan_range=6.0,
    scan_beams=73,
    pitch_limit=rules.PITCH_LIMIT_RAD,
    capabilities=frozenset({"navigate", "pick", "open"}),
    reach=1.0,
    reach_low=0.0,
    reach_high=1.6,
    strength=6.0,
    handling=2.5,
)

NECK: Vec3 = (0.0, 0.0, 1.16)
HAND: Vec3 = (0.40, 0.0, 0.855)

_WHITE: Rgba = (0.91, 0.92, 0.93, 1.0)
_NAVY: Rgba = (0.16, 0.24, 0.40, 1.0)
_DARK: Rgba = (0.13, 0.14, 0.16, 1.0)
_CORAL: Rgba = (0.92, 0.42, 0.34, 1.0)
_GLOW: Rgba = (0.55, 0.86, 0.98, 1.0)
_RUBBER: Rgba = (0.08, 0.08, 0.09, 1.0)


def look() -> tuple[Part, ...]:
    """Wide base, torso, two bent arms that hold a tray, and a round head with a face."""
    return (
        *(wheel((0.0, side * 0.235, 0.07), 0.07, 0.025, _RUBBER) for side in (-1.0, 1.0)),
        post((0.0, 0.0, 0.16), 0.29, 0.10, _WHITE),
        post((0.0, 0.0, 0.07), 0.27, 0.03, _DARK),
        post((0.0, 0.0, 0.268), 0.25, 0.008, _CORAL),
        post((-0.04, 0.0, 0.45), 0.12, 0.18, _DARK),
        post((-0.03, 0.0, 0.84), 0.185, 0.22, _WHITE),
        ball((-0.03, 0.0, 1.00), 0.17, _WHITE),
        box((0.13, 0.0, 0.92), (0.03, 0.09, 0.06), _NAVY),
        post((-0.01, 0.0, 1.155), 0.05, 0.03, _DARK),
        *(part for side in (-1.0, 1.0) for part in _arm(side)),
        box((0.38, 0.0, 0.845), (0.12, 0.17, 0.01), _NAVY),
        ball((0.0, 0.0, 1.24), 0.10, _WHITE, HEAD),
        post((0.0, 0.0, 1.325), 0.045, 0.012, _CORAL, HEAD),
        box((0.07, 0.0, 1.25), (0.032, 0.068, 0.042), _DARK, HEAD),
        *(rod((0.103, side * 0.032, 1.255), 0.012, 0.003, _GLOW, HEAD) for side in (-1.0, 1.0)),
    )


def _arm(side: float) -> tuple[Part, ...]:
    return (
        ball((-0.03, side * 0.215, 1.0), 0.07, _CORAL),
        post((-0.03, side * 0.225, 0.91), 0.045, 0.08, _WHITE),
        ball((-0.03, side * 0.225, 0.83), 0.05, _DARK),
        rod((0.11, side * 0.215, 0.83), 0.036, 0.13, _WHITE),
        ball((0.26, side * 0.19, 0.84), 0.045, _DARK),
    )


def pieces() -> tuple[Piece, ...]:
    """The robot's meshes, for pictures for people."""
    white, navy, dark = meshes.gloss(_WHITE), meshes.gloss(_NAVY), meshes.gloss(_DARK)
    coral, rubber, light = meshes.gloss(_CORAL), meshes.matte(_RUBBER), meshes.glow(_GLOW)
    skirt = [(0.0, 0.035), (0.26, 0.035), (0.275, 0.05), (0.275, 0.075), (0.0, 0.075)]
    base = [(0.0, 0.07), (0.28, 0.07), (0.297, 0.09), (0.292, 0.17), (0.27, 0.235), (0.235, 0.262), (0.0, 0.262)]
    band = [(0.272, 0.225), (0.278, 0.232), (0.262, 0.250), (0.252, 0.252)]
    waist = [(0.17, 0.255), (0.135, 0.30), (0.115, 0.40), (0.115, 0.52), (0.135, 0.63)]
    chest = (
        (-0.035, 0.0, 0.61, 0.10, 0.12),
        (-0.033, 0.0, 0.65, 0.15, 0.17),
        (-0.030, 0.0, 0.80, 0.165, 0.185),
        (-0.030, 0.0, 0.96, 0.165, 0.195),
        (-0.026, 0.0, 1.06, 0.135, 0.170),
        (-0.018, 0.0, 1.12, 0.075, 0.09),
        (-0.012, 0.0, 1.135, 0.05, 0.055),
    )
    return (
        *(meshes.tire((0.0, side * 0.235, 0.07), 0.07, 0.028, rubber) for side in (-1.0, 1.0)),
        meshes.turned(skirt, dark),
        meshes.turned(base, white),
        meshes.turned(band, coral),
        *(meshes.tube(_slit(z), 0.006, dark) for z in (0.14, 0.151, 0.162)),
        meshes.turned(waist, dark, (-0.035, 0.0, 0.0)),
        meshes.limb(chest, white, fullness=2.5),
        meshes.box((0.128, 0.0, 0.92), (0.016, 0.085, 0.058), navy, 0.012),
        *(meshes.box((0.1445, 0.0, z), (0.001, w, 0.006), light, 0.0008) for z, w in ((0.94, 0.05), (0.915, 0.035))),
        meshes.rod((-0.008, 0.0, 1.15), 0.046, 0.07, "z", dark),
        *(piece for side in (-1.0, 1.0) for piece in _limb(side)),
        meshes.box((0.385, 0.0, 0.846), (0.125, 0.175, 0.006), navy, 0.005),
        *(meshes.tube(edge, 0.009, coral) for edge in _rim()),
        *_face(),
    )


def _limb(side: float) -> tuple[Piece, ...]:
    """A bent arm whose hand grips the tray's side."""
    white, dark, coral = meshes.gloss(_WHITE), meshes.gloss(_DARK), meshes.gloss(_CORAL)
    upper = sweeps.bend((-0.03, side * 0.225, 0.99), (-0.04, side * 0.232, 0.90), (-0.03, side * 0.228, 0.83))
    fore = sweeps.bend((-0.01, side * 0.226, 0.828), (0.12, side * 0.215, 0.822), (0.25, side * 0.192, 0.835))
    return (
        meshes.ball((-0.03, side * 0.215, 1.0), 0.073, coral),
        meshes.tube(upper, 0.045, white),
        meshes.ball((-0.03, side * 0.227, 0.828), 0.052, dark),
        meshes.tube(fore, [0.042 - 0.012 * k / (len(fore) - 1) for k in range(len(fore))], white),
        meshes.ball((0.275, side * 0.188, 0.842), (0.042, 0.026, 0.034), dark),
        *(meshes.tube(_grip(side, x), 0.011, dark) for x in (0.29, 0.318)),
    )


def _grip(side: float, x: float) -> Any:
    return sweeps.bend((x - 0.01, side * 0.195, 0.85), (x, side * 0.178, 0.874), (x + 0.004, side * 0.152, 0.862))


def _slit(z: float) -> Any:
    """The range finder's window in the front of the base."""
    return sweeps.bend((0.2805, -0.08, z), (0.2915, 0.0, z), (0.2805, 0.08, z))


def _rim() -> list[Any]:
    """The tray's four edges."""
    corners = [(x, y, 0.854) for x, y in ((0.265, -0.17), (0.505, -0.17), (0.505, 0.17), (0.265, 0.17))]
    return [(corners[k - 1], corners[k]) for k in range(4)]


def _face() -> tuple[Piece, ...]:
    white, dark, light = meshes.gloss(_WHITE), meshes.gloss(_DARK), meshes.glow(_GLOW)
    smile = sweeps.bend((0.099, 0.022, 1.222), (0.104, 0.0, 1.216), (0.099, -0.022, 1.222))
    return (
        meshes.ball((0.0, 0.0, 1.235), (0.098, 0.104, 0.092), white, HEAD),
        meshes.ball((0.028, 0.0, 1.24), (0.077, 0.084, 0.062), dark, HEAD),
        *(meshes.ball((0.098, side * 0.033, 1.248), (0.007, 0.012, 0.016), light, HEAD) for side in (-1.0, 1.0)),
        meshes.tube(smile, 0.003, light, HEAD),
        *(
            meshes.rod((0.0, side * 0.104, 1.235), 0.032, 0.014, "y", meshes.gloss(_CORAL), HEAD)
            for side in (-1.0, 1.0)
        ),
        meshes.rod((-0.01, 0.0, 1.327), 0.012, 0.024, "z", meshes.glow(_CORAL), HEAD),
    )
