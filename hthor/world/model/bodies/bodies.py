"""The bodies of robots and of people, whose poses are set directly: they have no degrees of freedom.

A body collides with nothing in the engine. Walls, furniture and other bodies stop it on the free-space grid that
planners use too (see `hthor.world.motion`). Its head turns with the camera: solids and meshes that move with "head" are
given in their pose while the camera looks straight ahead.
"""

import functools
import importlib
import math
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import msgspec
import numpy as np

from hthor import plugins
from hthor.errors import HthorError
from hthor.looks import Material, Piece
from hthor.looks.furniture import plain
from hthor.types import HUMAN, BodySpec, Part, Rgba, RobotSpec, Vec3, is_person
from hthor.world.model import geoms
from hthor.world.model.bodies import avatar
from hthor.world.model.bodies.primitives import HEAD, box, post
from hthor.world.model.engine import Entity, mjcf

_HAND_HEIGHT = 0.60
"""Height of the hand as a share of the body's height, if its file does not give it."""
_HAND_AHEAD_M = 0.14
"""[m] Distance from the body's rim to the hand, if its file does not give it."""
_NECK_HEIGHT = 0.93
"""Height of the neck as a share of the body's height, if its file does not give it."""
_SHELL: Rgba = (0.80, 0.82, 0.84, 1.0)
_LENS: Rgba = (0.10, 0.11, 0.13, 1.0)


def robot_spec(given: RobotSpec | str | Path) -> RobotSpec:
    """A robot's body as a caller gives it: itself, or what `load_robot` takes.

    Raises:
        HthorError: as `load_robot`, and when it is anything else.
    """
    if isinstance(given, RobotSpec):
        return given
    if not isinstance(given, (str, Path)):
        raise HthorError(f"a robot must be a name, the path of a file or a RobotSpec, got {given!r:.60}")
    return load_robot(str(given))


def load_robot(name: str) -> RobotSpec:
    """The body of the robot with this name, or of the robot in this file, such as ``my_robot.py``.

    Raises:
        UnknownName: when no robot has this name.
        HthorError: when the file does not load or does not define a robot.
    """
    spec = plugins.load("robot", name)
    own = Path(name).stem
    if not isinstance(spec, RobotSpec) or spec.name != own:
        given = f"a RobotSpec called '{spec.name}'" if isinstance(spec, RobotSpec) else f"a {type(spec).__name__}"
        raise HthorError(f"{name}: SPEC must be a RobotSpec called '{own}', as its file is; it is {given}.")
    return spec


def look(spec: BodySpec, seat: str = HUMAN) -> tuple[Part, ...]:
    """The body's solids in its own frame: those of its file, or a plain drum with a mast.

    People differ in the colours of their clothes, by their ``seat``.
    """
    draw = getattr(_module(spec), "look", None)
    parts = _plain(spec) if draw is None else tuple(draw())
    if seat == HUMAN or not is_person(seat):
        return parts
    colours = avatar.outfit(seat)
    return tuple(msgspec.structs.replace(part, rgba=colours.get(part.rgba, part.rgba)) for part in parts)


@functools.lru_cache(maxsize=64)
def pieces(spec: BodySpec, seat: str = HUMAN) -> tuple[Piece, ...]:
    """The body's meshes in its own frame, for pictures for people: those of its file, or meshes of its solids."""
    draw = _human_pieces if _module(spec) is avatar else getattr(_module(spec), "pieces", None)
    found = tuple(plain.plain_pieces(look(spec, seat)) if draw is None else draw())
    if seat == HUMAN or not is_person(seat):
        return found
    colours = avatar.outfit(seat)
    return tuple(piece._replace(material=_dyed(piece.material, colours)) for piece in found)


def _dyed(material: Material, colours: Mapping[Rgba, Rgba]) -> Material:
    return msgspec.structs.replace(material, rgba=colours.get(material.rgba, material.rgba))


def _human_pieces() -> tuple[Piece, ...]:
    from hthor.world.model.bodies import human_mesh  # drawn only in the profile nice, so trials need not load it

    return human_mesh.pieces()


def neck(spec: BodySpec) -> Vec3:
    """The point [m] about which the head turns, in the body's frame."""
    place: Vec3 = getattr(_module(spec), "NECK", (0.0, 0.0, round(_NECK_HEIGHT * spec.height, 3)))
    return place


def head_transform(spec: BodySpec, pitch: float, yaw: float = 0.0) -> tuple[Any, Any]:
    """The motion of a head that turns left by ``yaw`` and tilts up by ``pitch`` [rad]: rotation (3, 3), shift (3,) [m].

    A point that is at p while the camera looks straight ahead moves to ``rotation @ p + shift``, all in the
    body's frame.
    """
    cos, sin = math.cos(pitch), math.sin(pitch)
    rotation = np.array(((cos, 0.0, -sin), (0.0, 1.0, 0.0), (sin, 0.0, cos)))
    if yaw:
        left, ahead = math.sin(yaw), math.cos(yaw)
        rotation = np.array(((ahead, -left, 0.0), (left, ahead, 0.0), (0.0, 0.0, 1.0))) @ rotation
    pivot = np.array(neck(spec))
    return rotation, pivot - rotation @ pivot


def hand(spec: BodySpec) -> Vec3:
    """The point [m] on which an object in a body's hand rests, in the body's frame (x ahead, y left, z up)."""
    ahead = (spec.radius + _HAND_AHEAD_M, 0.0, round(_HAND_HEIGHT * spec.height, 3))
    place: Vec3 = getattr(_module(spec), "HAND", ahead)
    return place


def grasp_point(spec: BodySpec, size: Vec3) -> Vec3:
    """The centre [m] of a held object of ``size`` [m], which lies on the hand, in the body's frame."""
    x, y, z = hand(spec)
    return (x, y, z + size[2] / 2)


def seat_names(people: int, robots: int) -> tuple[str, ...]:
    """The seats of a world: the people's, "human", "human2", ..., then the robots', "robot", "robot2", ..."""
    counts = ((HUMAN, people), ("robot", robots))
    return tuple(f"{name}{number if number > 1 else ''}" for name, many in counts for number in range(1, many + 1))


class Body(Entity):
    """The figure of a seat's body, its camera level; its frame has its origin on the floor and x ahead."""

    def _build(self, seat: str, spec: BodySpec) -> None:
        self.seat, self.spec = seat, spec
        self._root = mjcf.RootElement(model=f"body|{seat}")
        for index, part in enumerate(look(spec, seat)):
            geoms.add_part(self._root.worldbody, f"part:{index}", part, group=geoms.BODIES, **geoms.GHOST)

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        return self._root


def _module(spec: BodySpec) -> ModuleType | None:
    """The module that a body was loaded from, None for a body that was made from a record only."""
    if spec.name == avatar.HUMAN.name:
        return avatar
    if spec.name in plugins.names("robot"):
        return importlib.import_module(f"hthor.world.robots.{spec.name}")
    return plugins.loaded("robot", spec.name)


def _plain(spec: BodySpec) -> tuple[Part, ...]:
    r, h = spec.radius, spec.height
    return (
        post((0.0, 0.0, 0.1 * h), r, 0.1 * h, _SHELL),
        post((0.0, 0.0, 0.55 * h), 0.15 * r, 0.35 * h, _SHELL),
        box((0.0, 0.0, 0.95 * h), (0.25 * r, 0.45 * r, 0.05 * h), _LENS, HEAD),
    )
