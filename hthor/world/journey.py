"""Walking a body somewhere by the house's own plan: which way, and where to stand; knows nothing of minds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from hthor import geometry
from hthor.errors import HthorError
from hthor.houses.freespace import FreeSpace
from hthor.houses.geodesic import Geodesics
from hthor.types import BodySpec, Outcome, Pose, Rotate, Vec2, Vec3

from hthor.world import passages

if TYPE_CHECKING:
    from hthor.world.actor import Actor
    from hthor.world.world import World

_NEAR_M = 0.8
"""How close to go to something: this share of the arm's reach, or as many metres for a body without hands."""
_TURN_RAD = 1e-3


def towards(pose: Pose, body: BodySpec, point: Vec3) -> Rotate:
    """The rotation after which a body at ``pose`` faces ``point`` [m], its camera as far as that tilts."""
    dx, dy = point[0] - pose.x, point[1] - pose.y
    yaw = geometry.wrap(math.atan2(dy, dx) - pose.yaw)
    up = math.atan2(point[2] - body.eye, max(math.hypot(dx, dy), 1e-6))
    return Rotate(yaw=yaw, pitch=max(-body.pitch_limit, min(body.pitch_limit, up)) - pose.pitch)


def go(actor: Actor, world: World, target: str | Vec2) -> Outcome:
    """Walk ``actor`` to a place, or to where a thing is in reach, and face it then."""
    pose = actor.pose
    ways = Geodesics(_around(world, actor))
    here = (pose.x, pose.y)
    space = ways.space
    place = target if not isinstance(target, str) else _stand(world, actor, ways, target)
    path = ways.path(here, space.nearest_free(*place, within=space.component(*here)))
    for point in path[1:]:
        outcome = _leg(actor, point)
        if not outcome.ok:
            return outcome
    return actor.look_at(target) if isinstance(target, str) else Outcome(motion="move", ok=True)


def _around(world: World, actor: Actor) -> FreeSpace:
    """The floor that is free for this body while the others stand where they are."""
    rows = []
    for seat, pose in world.poses().items():
        radius = world.bodies[seat].radius
        if seat != actor.seat:
            rows.append((pose.x, pose.y, radius, radius, 0.0))
    space = passages.without(world.space[actor.seat], rows)
    return space if space.is_free(actor.pose.x, actor.pose.y) else world.space[actor.seat]


def _leg(actor: Actor, point: Vec2) -> Outcome:
    pose = actor.pose
    length = math.dist((pose.x, pose.y), point)
    turn = geometry.wrap(math.atan2(point[1] - pose.y, point[0] - pose.x) - pose.yaw)
    if length > 1e-6 and abs(turn) > _TURN_RAD:
        actor.rotate(turn)
    return actor.move(length)


def _stand(world: World, actor: Actor, ways: Geodesics, target: str) -> Vec2:
    """The free place by ``target`` that is the shortest walk away: in front of a thing, within reach of an object."""
    pose = actor.pose
    places = ways.space.centres(ways.space.component(pose.x, pose.y))
    if not len(places):
        raise HthorError(f"{actor.seat} stands where it cannot move")
    gaps = _gaps(world, target, places)
    near = places[gaps <= max(_NEAR_M * (actor.body.reach or 1.0), float(gaps.min()) + 1e-9)]
    x, y = near[int(np.argmin(ways.distances((pose.x, pose.y), near)))]
    return (float(x), float(y))


def _gaps(world: World, target: str, places: Any) -> Any:
    """(N,) [m] from each of the ``places`` (N, 2) to a thing's footprint, or to an object's or body's middle.

    What stands behind a thing that has a back is as far as can be.
    """
    thing = next((thing for thing in world.furniture() if thing.id == target), None)
    x, y, _ = world.position(target)
    if thing is None:
        return np.hypot(places[:, 0] - x, places[:, 1] - y)
    cos, sin = math.cos(thing.yaw), math.sin(thing.yaw)
    u = cos * (places[:, 0] - x) + sin * (places[:, 1] - y)
    v = cos * (places[:, 1] - y) - sin * (places[:, 0] - x)
    gaps = np.hypot(np.maximum(np.abs(u) - thing.size[0] / 2, 0.0), np.maximum(np.abs(v) - thing.size[1] / 2, 0.0))
    in_front = (v > 0.0) & (np.abs(u) <= thing.size[0] / 2)
    return np.where(in_front, gaps, np.inf) if in_front.any() and gaps[in_front].min() < _NEAR_M else gaps
