"""Lights for a viewer: the lamp of the viewer's room, those of rooms seen through doors, a soft fill, and the sky.

The lamps cast shadows, so their light stays in their rooms.
"""

import itertools
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from hthor import seeds
from hthor.geometry import plane
from hthor.geometry.plane import distance_to_edge
from hthor.looks.furniture import building
from hthor.types import HouseSpec, Pose, Room, Vec2, Vec3
from hthor.world.model.engine import mujoco
from hthor.world.rendering.scene.apertures import placed_meshes
from hthor.world.rendering.scene.scene_mesh import INSIDE, SceneMesh

LAMPS = 3
"""OpenGL has eight lights: headlight, fill, and two for each of these lamps. Each light with shadows costs a pass."""
_SPAN_M2, _MOST = 24.0, 3
"""[m2] One lamp for this much floor of a room, and the most lamps per room."""
LAMP_DROP_M = 0.14
"""[m] Distance of a lamp's light below the ceiling."""
AMBIENT, HEAD = (0.30, 0.30, 0.31), (0.12, 0.12, 0.12)
LAMP, LAMP_FADE, _CUTOFF, LAMP_EXPONENT = (0.50, 0.48, 0.44), (1.0, 0.02, 0.012), 86.0, 2.0
"""Of a lamp: colour, attenuation with distance, half its cone's angle [degrees], and concentration downwards."""
BOUNCE, BOUNCE_FADE, BOUNCE_DROP_M = (0.28, 0.27, 0.25), (1.0, 0.05, 0.06), 0.8
"""Light reflected by the room: a point light without shadows below the lamp."""
FILL: tuple[Vec3, Vec3] = ((0.35, 0.55, -0.6), (0.10, 0.10, 0.10))
_SUN, _SUNNY = ((0.10, 0.15, -1.0), (0.32, 0.31, 0.28)), (0.42, 0.42, 0.44)
"""In the view from above: the direction and colour of the sunlight, and the light that the sky adds."""
_SHINE: Vec3 = (0.25, 0.25, 0.25)
_STEP_M, _TOUCH_M, _WALL_M, _ROUNDS = 0.25, 0.12, 0.6, 8
"""Grid of places for lamps, largest gap that counts as touching, least distance from walls [m]; rounds of spreading."""
_KINDS = {
    "directional": mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
    "spot": mujoco.mjtLightType.mjLIGHT_SPOT,
    "point": mujoco.mjtLightType.mjLIGHT_SPOT,
}

_SIDE = 256
_ZENITH, _HORIZON = np.array((0.36, 0.58, 0.86)), np.array((0.86, 0.93, 0.98))
_LEAVES, _GRASS = np.array((0.38, 0.52, 0.30)), np.array((0.52, 0.64, 0.36))


def attenuation(factors: Vec3, distance: Any) -> Any:
    """The share of a lamp's light that is left at a distance [m], as OpenGL computes it."""
    constant, linear, square = factors
    return 1.0 / (constant + linear * distance + square * distance**2)


class RoomLights:
    """A ceiling lamp for every room."""

    def __init__(self, house: HouseSpec) -> None:
        self._house = house
        self.places = {room.id: _spread(room) for room in house.rooms}
        self._next = {room.id: frozenset(_neighbours(house, room)) for room in house.rooms}

    def items(self) -> Iterator[SceneMesh]:
        """The meshes of the lamps."""
        for room, places in self.places.items():
            for x, y in places:
                at = (x, y, self._house.height - 0.001)
                for item in placed_meshes(f"ceiling of {room}", building.ceiling_lamp(), at, 0.0):
                    yield item._replace(group=INSIDE)

    def light(self, scene: Any, pose: Pose) -> None:
        """Light ``scene``, whose cameras are set, for a viewer at ``pose``."""
        self._common(scene, AMBIENT)
        height = self._house.height
        for (x, y), share in self._active((pose.x, pose.y)):
            bounce = (BOUNCE[0] * share, BOUNCE[1] * share, BOUNCE[2] * share)
            place = (x, y, height - BOUNCE_DROP_M)
            _add(scene, "point", pos=place, diffuse=bounce, attenuation=BOUNCE_FADE)
            place = (x, y, height - LAMP_DROP_M)
            fade: dict[str, Any] = {"attenuation": LAMP_FADE, "cutoff": _CUTOFF, "exponent": LAMP_EXPONENT}
            _add(scene, "spot", pos=place, diffuse=LAMP, castshadow=1, specular=_SHINE, **fade)

    def daylight(self, scene: Any, middle: Vec2, height: float) -> None:
        """Light ``scene``, whose cameras are set, for the view from above ``middle`` [m], a sun ``height`` [m] up."""
        self._common(scene, _SUNNY)
        direction, colour = _SUN
        aim = _unit(direction)
        back = height / -aim[2]
        pos = (middle[0] - aim[0] * back, middle[1] - aim[1] * back, height)
        _add(scene, "directional", pos=pos, dir=aim, diffuse=colour, castshadow=1)

    def _common(self, scene: Any, ambient: Vec3) -> None:
        scene.nlight = 0
        forward = tuple(float(value) for value in scene.camera[0].forward)
        _add(scene, "directional", headlight=1, dir=forward, ambient=ambient, diffuse=HEAD)
        _add(scene, "directional", dir=_unit(FILL[0]), diffuse=FILL[1])

    def _active(self, place: Vec2) -> list[tuple[Vec2, float]]:
        """The lamps of the viewer's room, then the nearest lamps of rooms next to it, each with its share of bounce."""
        rooms = self._house.rooms
        own = next((room.id for room in rooms if plane.inside(place, room.polygon)), None)
        if own is None:
            own = min(self.places, key=lambda room: min(math.dist(place, lamp) for lamp in self.places[room]))
        lamps = [(lamp, 1.0 / math.sqrt(len(self.places[own]))) for lamp in self.places[own]]
        others = [(lamp, 1.0 / len(self.places[room])) for room in self._next[own] for lamp in self.places[room]]
        others.sort(key=lambda lamp: (math.dist(place, lamp[0]), lamp))
        return [*lamps, *others][:LAMPS]


def _add(scene: Any, kind: str, **given: Any) -> None:
    light = scene.lights[scene.nlight]
    scene.nlight += 1
    blank = (0.0, 0.0, 0.0)
    default: dict[str, Any] = {"id": -1, "headlight": 0, "castshadow": 0, "texid": -1, "exponent": 0.0, "cutoff": 180.0}
    default |= {"type": _KINDS[kind], "pos": blank, "dir": (0.0, 0.0, -1.0)}
    default |= {"ambient": blank, "diffuse": blank, "specular": blank, "attenuation": (1.0, 0.0, 0.0)}
    for name, value in (default | given).items():
        if isinstance(value, tuple):
            getattr(light, name)[:] = value
        else:
            setattr(light, name, value)


def _unit(direction: Vec3) -> Vec3:
    length = math.hypot(*direction)
    return (direction[0] / length, direction[1] / length, direction[2] / length)


def _neighbours(house: HouseSpec, room: Room) -> Iterator[str]:
    """Rooms that can be seen from this room, through an open doorway or where there is no wall in between."""
    for opening in house.openings:
        if opening.passable and room.id in opening.rooms:
            yield from (other.id for other in house.rooms if other is not room and other.id in opening.rooms)
    faces = [face for face in house.walls if face.room == room.id]
    for a, b in zip(room.polygon, (*room.polygon[1:], room.polygon[0]), strict=True):
        count = max(1, round(math.dist(a, b) / _STEP_M))
        for k in range(count):
            share = (k + 0.5) / count
            point = (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]))
            if not any(distance_to_edge(point, (face.a, face.b)) < _TOUCH_M for face in faces):
                yield from (
                    other.id
                    for other in house.rooms
                    if other is not room and distance_to_edge(point, other.polygon) < _TOUCH_M
                )


def _spread(room: Room) -> list[Vec2]:
    """The places of a room's lamps: one in its middle, or several spread over its floor."""
    points = [(x, y) for x, y in itertools.product(*(_steps(list(axis)) for axis in zip(*room.polygon, strict=True)))]
    points = [point for point in points if plane.inside(point, room.polygon)]
    count = min(_MOST, max(1, round(abs(plane.signed_area(room.polygon)) / _SPAN_M2)))
    inner = [point for point in points if distance_to_edge(point, room.polygon) >= _WALL_M] or points
    if count == 1:
        return [_middle(room, inner)]
    lamps = [min(inner), max(inner), max(inner, key=lambda point: (-point[0] + point[1], point))][:count]
    for _ in range(_ROUNDS):
        owner = [min(range(count), key=lambda k: math.dist(point, lamps[k])) for point in points]
        for k in range(count):
            share = [point for point, other in zip(points, owner, strict=True) if other == k]
            if share:
                centre = (sum(x for x, _ in share) / len(share), sum(y for _, y in share) / len(share))
                lamps[k] = min(inner, key=lambda point: math.dist(point, centre))
    return lamps


def _middle(room: Room, points: list[Vec2]) -> Vec2:
    """The point farthest from all walls of the room; of equally far points, the nearest to the middle of its extent."""
    xs, ys = zip(*room.polygon, strict=True)
    centre = ((min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2)
    return max(points, key=lambda point: (round(distance_to_edge(point, room.polygon), 1), -math.dist(point, centre)))


def _steps(values: list[float]) -> list[float]:
    low, high = min(values), max(values)
    count = max(2, 2 * round((high - low) / (2 * _STEP_M)))
    return [low + (high - low) * k / count for k in range(1, count)]


def sky() -> Any:
    """Six square pictures one below the other, (6 S, S, 3) uint8: right, left, up, down, front, back."""
    axis = (np.arange(_SIDE) + 0.5) / _SIDE * 2.0 - 1.0
    s, t = np.meshgrid(axis, axis)
    one = np.ones_like(s)
    directions = ((one, -t, -s), (-one, -t, s), (s, one, t), (s, -one, -t), (s, -t, one), (-s, -t, -one))
    faces = [_colour(*direction) for direction in directions]
    return np.concatenate(faces).astype(np.uint8)


def _colour(x: Any, y: Any, z: Any) -> Any:
    """The sky's colour in direction (x, y, z); y is up."""
    length = np.sqrt(x * x + y * y + z * z)
    rise, angle = y / length, np.arctan2(z, x)
    share = np.clip(rise / 0.7, 0.0, 1.0)[..., None] ** 0.6
    colour = _HORIZON * (1.0 - share) + _ZENITH * share
    clouds = _waves(3.0 * x / (np.abs(y) + 0.35), 3.0 * z / (np.abs(y) + 0.35))
    veil = (np.clip(clouds - 0.15, 0.0, 0.8) * np.clip(rise * 5.0, 0.0, 1.0))[..., None]
    colour = colour * (1.0 - 0.8 * veil) + 0.8 * veil
    crown = 0.055 + 0.03 * np.sin(7 * angle + 1) + 0.02 * np.sin(17 * angle) + 0.012 * np.sin(43 * angle + 2)
    trees = np.clip((crown - rise) * 90.0, 0.0, 1.0)[..., None]
    leaves = _LEAVES * (1.0 + 0.12 * np.sin(60 * angle) * np.sin(130 * rise + 9 * angle))[..., None]
    colour = colour * (1.0 - trees) + leaves * trees
    ground = np.clip(-rise * 60.0, 0.0, 1.0)[..., None]
    return np.clip(colour * (1.0 - ground) + _GRASS * ground, 0.0, 1.0) * 255.0


def _waves(u: Any, v: Any) -> Any:
    """A smooth, irregular pattern of waves: a sum of a few sines in seeded directions."""
    total = np.zeros_like(u)
    for octave in range(5):
        turn, shift = (2.0 * np.pi * seeds.draw(0, "sky", name, octave) for name in ("turn", "shift"))
        scale = 1.7**octave
        total += np.sin(scale * (u * np.cos(turn) + v * np.sin(turn)) + shift) / (1.0 + octave)
    return total / 2.0
