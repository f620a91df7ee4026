"""Bodies of robots and of the person: moved like puppets, without degrees of freedom; knows nothing of who moves them.

A body meets nothing in the engine. Walls, furniture and other bodies stop it on the free-space grid (see `motion`),
which is exactly what planners see.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable

from hthor import plugins
from hthor.types import HUMAN, BodySpec, Part, Rgba, RobotSpec, Vec3
from hthor.world import avatar, geoms
from hthor.world.engine import Entity, mjcf

_HAND_HEIGHT = 0.62
"""Height of the hand as a share of the body's height."""
_HAND_AHEAD_M = 0.14
_SHELL: Rgba = (0.80, 0.82, 0.84, 1.0)
_LENS: Rgba = (0.10, 0.11, 0.13, 1.0)


def hand(spec: BodySpec) -> Vec3:
    """Where a body holds things [m], in its own frame (x ahead, y left, z up from the floor)."""
    return (spec.radius + _HAND_AHEAD_M, 0.0, round(_HAND_HEIGHT * spec.height, 3))


def look(spec: BodySpec) -> tuple[Part, ...]:
    """The body's solids in its own frame: its file's own look, or a plain drum with a mast."""
    if spec.name == avatar.HUMAN.name:
        return avatar.look()
    if spec.name in plugins.names("robot"):
        module = importlib.import_module(f"hthor.world.robots.{spec.name}")
        draw: Callable[[], tuple[Part, ...]] | None = getattr(module, "look", None)
        if draw is not None:
            return draw()
    return _plain(spec)


def robot(name: str) -> RobotSpec:
    """The body of the robot with this name.

    Raises:
        UnknownName: when there is none.
    """
    spec: RobotSpec = plugins.load("robot", name)
    return spec


def seat_names(robots: int) -> tuple[str, ...]:
    """The seats of a world with that many robots: "human", "robot", "robot2", ..."""
    return (HUMAN, *(f"robot{number if number > 1 else ''}" for number in range(1, robots + 1)))


class Body(Entity):
    """The figure in a seat; its frame stands on the floor, x ahead."""

    def _build(self, seat: str, spec: BodySpec) -> None:
        self.seat, self.spec = seat, spec
        self._root = mjcf.RootElement(model=f"body|{seat}")
        for index, part in enumerate(look(spec)):
            bits = geoms.GHOST
            geoms.add_part(self._root.worldbody, f"part:{index}", part, group=geoms.BODIES, **bits)

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        return self._root


def _plain(spec: BodySpec) -> tuple[Part, ...]:
    r, h = spec.radius, spec.height
    return (
        Part(shape="cylinder", centre=(0.0, 0.0, 0.1 * h), half=(r, r, 0.1 * h), rgba=_SHELL),
        Part(shape="cylinder", centre=(0.0, 0.0, 0.55 * h), half=(0.03, 0.03, 0.35 * h), rgba=_SHELL),
        Part(shape="box", centre=(0.0, 0.0, 0.95 * h), half=(0.05, 0.09, 0.05 * h), rgba=_LENS),
    )
