"""Walking a body somewhere by the house's own plan: which way, and where to stand."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from hthor.errors import HthorError
from hthor.geometry import plane
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.geodesic import Geodesics
from hthor.types import BodySpec, Outcome, Pose, Rotate, Vec2, Vec3
from hthor.world import numbers
from hthor.world.state import doorways

if TYPE_CHECKING:
    from hthor.world.actor import Actor
    from hthor.world.world import World

_NEAR_M = 0.8
"""How close to go to something: this share of the arm's reach, or as many metres for a body without hands."""
_FAR_M, _FARTHEST_M = 0.97, 0.9999
"""And to what cannot be seen or got at from any place so close."""
_SHORT_M = 0.3
"""Ending this much farther away than the house alone asks means that somebody is in the way."""
_BESIDE_M = 1.0
"""As near as one can be expected to come to a place that another body has."""
_TURN_RAD = 1e-3
_ROUND = ((1.0, 0.5), (0.87, 0.8), (0.6, 1.0))
"""Half sides of rectangles that cover a disc of radius 1."""
_MARGIN_M = 0.04
"""Half the diagonal of a cell: ways run anywhere in free cells, but what is asked is whether their middles are free."""
_LOOKS = 100
"""How many of the places around a body, or in reach of an object, are tried before all of them are."""


def towards(pose: Pose, body: BodySpec, point: Vec3) -> Rotate:
    """The rotation after which a body at ``pose`` faces ``point`` [m], its camera as far as that tilts."""
    dx, dy = point[0] - pose.x, point[1] - pose.y
    yaw = plane.wrap(math.atan2(dy, dx) - pose.yaw)
    up = math.atan2(point[2] - body.eye, max(math.hypot(dx, dy), 1e-6))
    return Rotate(yaw=yaw, pitch=max(-body.pitch_limit, min(body.pitch_limit, up)) - pose.pitch)


def go(actor: Actor, world: World, target: str | Vec2) -> Outcome:
    """Walk ``actor`` to a place, or to where a thing is in reach, and face it then."""
    pose = actor.pose
    ways = Geodesics(_around(world, actor))
    space, here = ways.space, (pose.x, pose.y)
    if not space.is_free(*here):
        here = _aside(world, actor, space)
    place = _stand(world, actor, ways, here, target) if isinstance(target, str) else _point(world, target)
    path = ways.path(here, space.nearest_free(*place, within=space.component(*here)))
    for point in path if here != (pose.x, pose.y) else path[1:]:
        outcome = _leg(actor, point)
        if not outcome.ok:
            return outcome
    if _short(world, actor, target) > _SHORT_M:
        by = _nearest(world, actor)
        return Outcome(motion="move", ok=False, reason=f"{by} is in the way", by=by)
    if not isinstance(target, str):
        return Outcome(motion="move", ok=True)
    facing = actor.look_at(target)
    reason = _out_of_hand(world, actor, target)
    return Outcome(motion="move", ok=False, reason=reason) if facing.ok and reason else facing


def _out_of_hand(world: World, actor: Actor, target: str) -> str:
    """Why the body cannot pick up what it has gone to, empty when it can, or when that is no object."""
    states = {state.id: state for state in world.truth()}
    reason = world.out_of_hand(actor.seat, target) if _small(world, target) else ""
    inside = states.get(states[target].support) if reason else None
    closed = inside is not None and not inside.open and reason.endswith("out of sight")
    return f"{reason}; {states[target].support} is closed" if closed else reason


def _small(world: World, target: str) -> bool:
    """Whether it is an object, not furniture or a body."""
    return any(state.id == target for state in world.objects())


def _nearest(world: World, actor: Actor) -> str:
    """The seat of the body next to this one."""
    pose = actor.pose
    others = {seat: other for seat, other in world.poses().items() if seat != actor.seat}
    return min(others, key=lambda seat: math.dist((others[seat].x, others[seat].y), (pose.x, pose.y)))


def _short(world: World, actor: Actor, target: str | Vec2) -> float:
    """How much nearer [m] the body could be if it were alone in the house."""
    if len(world.seats) == 1:
        return 0.0
    pose, space = actor.pose, world.space[actor.seat]
    alone = space.component(*space.nearest_free(pose.x, pose.y))
    here = np.array([(pose.x, pose.y)])
    if not isinstance(target, str):
        goal = space.nearest_free(*target, within=alone)
        return math.dist((pose.x, pose.y), goal) - (_BESIDE_M if _taken(world, actor, goal) else 0.0)
    enough = max(_FAR_M * (actor.body.reach or 1.0), float(_gaps(world, target, space.centres(alone)).min()))
    return float(_gaps(world, target, here)[0]) - enough


def _taken(world: World, actor: Actor, goal: Vec2) -> bool:
    """Whether somebody stands where this body should: then beside them is as good."""
    others = [(world.pose(seat), world.bodies[seat].radius) for seat in world.seats if seat != actor.seat]
    return any(math.dist((pose.x, pose.y), goal) < _SHORT_M + actor.body.radius + radius for pose, radius in others)


def _point(world: World, target: Vec2) -> Vec2:
    x, y = target
    if not any(plane.inside((x, y), room.polygon) for room in world.house.rooms):
        place = f"({numbers.format_number(x)}, {numbers.format_number(y)})"
        raise HthorError(f"{place} is in no room of the house; give a point indoors, or the id of a thing")
    return (x, y)


def _aside(world: World, actor: Actor, space: FreeSpace) -> Vec2:
    """The nearest free floor for a body that stands close to others, on a straight way that leads past none of them."""
    pose = actor.pose
    places = space.centres(space.free)
    order = np.argsort(np.hypot(places[:, 0] - pose.x, places[:, 1] - pose.y), kind="stable")[:_LOOKS]
    others = [(world.pose(seat), world.bodies[seat].radius) for seat in world.seats if seat != actor.seat]
    for x, y in places[order].tolist():
        way = np.linspace((pose.x, pose.y), (x, y), 20)
        gaps = (np.hypot(way[:, 0] - other.x, way[:, 1] - other.y).min() - radius for other, radius in others)
        if all(gap >= actor.body.radius for gap in gaps):
            return (x, y)
    return space.nearest_free(pose.x, pose.y)


def _around(world: World, actor: Actor) -> FreeSpace:
    """The floor that is free for this body while the others stand where they are."""
    rows = []
    for seat, pose in world.poses().items():
        if seat != actor.seat:
            radius = world.bodies[seat].radius + _MARGIN_M
            rows += [(pose.x, pose.y, a * radius, b * radius, 0.0) for a, b in _ROUND]
    return doorways.with_obstacles(world.space[actor.seat], rows)


def _leg(actor: Actor, point: Vec2) -> Outcome:
    pose = actor.pose
    length = math.dist((pose.x, pose.y), point)
    turn = plane.wrap(math.atan2(point[1] - pose.y, point[0] - pose.x) - pose.yaw)
    if length > 1e-6 and abs(turn) > _TURN_RAD:
        actor.rotate(turn)
    return actor.move(length)


def _stand(world: World, actor: Actor, ways: Geodesics, here: Vec2, target: str) -> Vec2:
    """The free place by ``target`` that is the shortest walk away: in front of a thing, within reach of an object.

    From there the hand gets at it; if there is no such place, it is in sight at least; if there is none either, it is
    close.
    """
    places = ways.space.centres(ways.space.component(*here))
    if not len(places):
        raise HthorError(f"{actor.seat} stands where it cannot move")
    gaps = _gaps(world, target, places)
    small = _small(world, target)
    rings = []
    for share in (_NEAR_M, _FAR_M, _FARTHEST_M) if small else (_NEAR_M,):
        near = places[gaps <= max(share * (actor.body.reach or 1.0), float(gaps.min()) + 1e-9)]
        rings.append(near[np.argsort(ways.distances(here, near), kind="stable")])

    def handy(place: Vec2) -> bool:
        return not world.out_of_hand(actor.seat, target, place)

    def visible(place: Vec2) -> bool:
        return not small or not world.hidden(target, (*place, actor.body.eye))

    for good in (lambda place: handy(place) and visible(place), visible):
        for near in rings:
            for every in {max(1, len(near) // _LOOKS): 0, 1: 0}:  # a few of them first
                for x, y in near[::every].tolist():
                    if good((x, y)):
                        return (x, y)
    x, y = rings[0][0].tolist()
    return (x, y)


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
