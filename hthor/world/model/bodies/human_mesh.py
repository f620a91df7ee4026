"""The person's meshes: a dressed figure with shoes, trousers, belt, jumper, hands, face and hair; it has no joints."""

from typing import Any

from hthor.looks.meshes import shaping, sweeps
from hthor.looks.meshes.mesh import Piece
from hthor.types import Vec3
from hthor.world.model.bodies import avatar, meshes
from hthor.world.model.bodies.primitives import HEAD

CODE_PART = "pictures"

_SKIN = meshes.matte(avatar.SKIN)
_JUMPER = meshes.matte(avatar.JUMPER)
_CUFF = meshes.matte(avatar.CUFF)
_TROUSERS = meshes.matte(avatar.TROUSERS)
_HAIR = meshes.matte(avatar.HAIR)
_DARK = meshes.gloss(avatar.EYE)
_SIDES = (1.0, -1.0)


def pieces() -> tuple[Piece, ...]:
    """All meshes, in the body frame (x ahead, y left), the right hand held out with the palm up."""
    legs = [piece for side in _SIDES for piece in _leg(side)]
    return (*legs, *_trunk(), *_hanging_arm(), *_holding_arm(), *_head(), *_face())


def _leg(side: float) -> tuple[Piece, ...]:
    y = side * 0.095
    trousers = (
        (-0.012, y, 0.065, 0.066, 0.056),
        (-0.012, y, 0.085, 0.068, 0.058),
        (-0.012, y, 0.28, 0.066, 0.058),
        (0.0, y * 0.98, 0.50, 0.066, 0.062),
        (0.0, y * 0.92, 0.70, 0.084, 0.078),
        (-0.005, y * 0.85, 0.88, 0.105, 0.090),
        (-0.005, y * 0.80, 0.93, 0.105, 0.088),
    )
    sole = ((0.028, y, 0.0, 0.125, 0.042), (0.028, y, 0.02, 0.127, 0.044))
    shoe = (
        (0.027, y, 0.018, 0.121, 0.040),
        (0.024, y, 0.05, 0.112, 0.038),
        (-0.005, y, 0.082, 0.078, 0.036),
        (-0.030, y, 0.105, 0.045, 0.034),
    )
    return (
        meshes.limb(sole, meshes.matte(avatar.SOLES), fullness=2.6),
        meshes.limb(shoe, meshes.gloss(avatar.SHOES), fullness=2.3),
        meshes.limb(trousers, _TROUSERS),
    )


def _trunk() -> tuple[Piece, ...]:
    hips = (
        (-0.005, 0.0, 0.83, 0.06, 0.10),
        (-0.005, 0.0, 0.87, 0.108, 0.160),
        (0.0, 0.0, 0.94, 0.114, 0.168),
        (0.0, 0.0, 1.02, 0.104, 0.154),
    )
    belt = ((0.0, 0.0, 0.985, 0.113, 0.163), (0.0, 0.0, 1.02, 0.110, 0.159))
    hem = ((0.0, 0.0, 1.005, 0.120, 0.170), (0.0, 0.0, 1.04, 0.120, 0.168))
    jumper = (
        (0.0, 0.0, 1.02, 0.112, 0.160),
        (0.0, 0.0, 1.06, 0.116, 0.160),
        (0.0, 0.0, 1.16, 0.114, 0.158),
        (0.002, 0.0, 1.28, 0.122, 0.178),
        (0.0, 0.0, 1.38, 0.108, 0.182),
        (-0.004, 0.0, 1.44, 0.080, 0.130),
        (-0.004, 0.0, 1.475, 0.062, 0.070),
    )
    neck = ((-0.008, 0.0, 1.44, 0.052, 0.056), (0.0, 0.0, 1.50, 0.050, 0.052), (0.012, 0.0, 1.56, 0.050, 0.050))
    collar = sweeps.ring((0.0, 0.0, 0.0), 0.062, 0.013, "z", 28, 10)
    collar = shaping.moved(collar, -0.002, 0.0, 1.474)
    return (
        meshes.limb(hips, _TROUSERS),
        meshes.limb(belt, meshes.gloss(avatar.BELT), fullness=2.2),
        meshes.box((0.115, 0.0, 1.0), (0.006, 0.022, 0.014), meshes.metal((0.75, 0.72, 0.62, 1.0)), 0.003),
        meshes.limb(jumper, _JUMPER, fullness=2.2),
        meshes.limb(hem, _CUFF, fullness=2.2),
        Piece(collar, meshes.matte(avatar.COLLAR)),
        meshes.limb(neck, _SKIN),
    )


def _hanging_arm() -> tuple[Piece, ...]:
    line = sweeps.bend((0.0, 0.135, 1.375), (0.0, 0.188, 1.25), (0.005, 0.208, 1.10), (0.03, 0.200, 0.92))
    fingers = [
        meshes.tube(sweeps.bend((x, 0.197, 0.845), (x + 0.006, 0.192, 0.80), (x + 0.004, 0.182, 0.765)), 0.0095, _SKIN)
        for x in (0.012, 0.031, 0.050, 0.067)
    ]
    thumb = meshes.tube(sweeps.bend((0.06, 0.19, 0.885), (0.078, 0.185, 0.85), (0.08, 0.183, 0.82)), 0.011, _SKIN)
    return (
        meshes.tube(line, _sleeve(len(line)), _JUMPER),
        meshes.limb(((0.03, 0.2, 0.905, 0.043, 0.040), (0.03, 0.2, 0.935, 0.044, 0.041)), _CUFF),
        meshes.ball((0.036, 0.198, 0.862), (0.042, 0.018, 0.052), _SKIN),
        *fingers,
        thumb,
    )


def _holding_arm() -> tuple[Piece, ...]:
    """The right arm; the palm's upper side is at `avatar.HAND`."""
    x, y, z = avatar.HAND
    line = sweeps.bend((0.0, -0.135, 1.375), (-0.012, -0.193, 1.23), (-0.01, -0.205, 1.10), (0.075, -0.185, 1.06))
    fore = sweeps.bend((-0.01, -0.205, 1.10), (0.05, -0.19, 1.065), (0.20, -0.152, z - 0.008))
    fingers = [
        meshes.tube(_finger(x, y + offset, z, abs(offset)), 0.0095, _SKIN) for offset in (-0.03, -0.01, 0.01, 0.03)
    ]
    thumb = sweeps.bend((x - 0.06, y + 0.03, z - 0.01), (x - 0.03, y + 0.058, z), (x, y + 0.062, z + 0.012))
    wrist = ((0.19, -0.155, z - 0.008), (0.245, -0.138, z - 0.014))
    return (
        meshes.tube(line, _sleeve(len(line)), _JUMPER),
        meshes.tube(fore, [0.046 - 0.009 * k / (len(fore) - 1) for k in range(len(fore))], _JUMPER),
        meshes.tube(((0.19, -0.155, z - 0.007), (0.212, -0.149, z - 0.009)), 0.040, _CUFF),
        meshes.tube(wrist, 0.026, _SKIN),
        meshes.ball((x - 0.03, y, z - 0.013), (0.058, 0.044, 0.013), _SKIN),
        *fingers,
        meshes.tube(thumb, 0.0115, _SKIN),
    )


def _finger(x: float, y: float, z: float, spread: float) -> Any:
    tip = 0.088 - spread * 0.6
    return sweeps.bend((x, y, z - 0.013), (x + 0.5 * tip, y, z - 0.013), (x + tip, y, z + 0.012))


def _sleeve(points: int) -> list[float]:
    """Radii [m] from the shoulder to the end of a sleeve."""
    return [0.069 - 0.024 * min(1.0, 1.6 * k / (points - 1)) - 0.005 * k / (points - 1) for k in range(points)]


def _head() -> tuple[Piece, ...]:
    skull = (
        (0.040, 0.0, 1.508, 0.028, 0.026),
        (0.034, 0.0, 1.518, 0.054, 0.046),
        (0.024, 0.0, 1.550, 0.076, 0.064),
        (0.014, 0.0, 1.590, 0.093, 0.075),
        (0.008, 0.0, 1.640, 0.099, 0.080),
        (0.002, 0.0, 1.690, 0.088, 0.072),
        (-0.004, 0.0, 1.725, 0.055, 0.048),
        (-0.006, 0.0, 1.738, 0.02, 0.018),
    )
    hair = (
        (-0.045, 0.0, 1.565, 0.045, 0.064),
        (-0.034, 0.0, 1.600, 0.072, 0.082),
        (-0.024, 0.0, 1.640, 0.092, 0.090),
        (-0.010, 0.0, 1.690, 0.105, 0.088),
        (-0.006, 0.0, 1.728, 0.085, 0.066),
        (-0.010, 0.0, 1.748, 0.04, 0.03),
    )
    ears = [meshes.ball((0.0, side * 0.083, 1.612), (0.020, 0.010, 0.030), _SKIN, HEAD) for side in _SIDES]
    return meshes.limb(skull, _SKIN, HEAD), meshes.limb(hair, _HAIR, HEAD), *ears


def _face() -> tuple[Piece, ...]:
    white = meshes.gloss((0.95, 0.95, 0.94, 1.0))
    return (
        *(meshes.ball((0.094, side * 0.032, 1.632), (0.0125, 0.0165, 0.0105), white, HEAD) for side in _SIDES),
        *(meshes.ball((0.1025, side * 0.0315, 1.632), (0.006, 0.0075, 0.0078), _DARK, HEAD) for side in _SIDES),
        *(meshes.tube(_brow(side), 0.0035, _HAIR, HEAD) for side in _SIDES),
        meshes.tube(((0.103, 0.0, 1.632), (0.118, 0.0, 1.602)), (0.009, 0.0135), _SKIN, HEAD),
        meshes.tube(_lips(), 0.0045, meshes.matte(avatar.LIPS), HEAD),
    )


def _brow(side: float) -> Any:
    inner: Vec3 = (0.106, side * 0.016, 1.651)
    return sweeps.bend(inner, (0.104, side * 0.032, 1.656), (0.094, side * 0.047, 1.651))


def _lips() -> Any:
    return sweeps.bend((0.094, 0.024, 1.569), (0.105, 0.0, 1.566), (0.094, -0.024, 1.569))
