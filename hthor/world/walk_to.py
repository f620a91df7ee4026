"""Routes for `Actor.go_to` on the house's true floor plan, and the places where they end."""

import math
from typing import Any

import numpy as np

from hthor.errors import HthorError
from hthor.geometry import plane
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.geodesic import Geodesics
from hthor.types import BodySpec, Pose, Rotate, Vec2, Vec3
from hthor.world import numbers
from hthor.world.interactive_simulation import InteractiveSimulation
from hthor.world.state import doors

_REACH_SHARES = (0.8, 0.97, 0.9999)
"""How close a body goes to an object, as shares of its reach (metres for a body without hands). If no place within one
share lets it see and grasp the object, the next share is tried. The margins absorb rounding to grid cells."""
_NEAR_M, _FAR_M, _ = _REACH_SHARES
_SHORT_M = 0.3
"""[m] A walk that ends this much farther from the target than the house requires has a body in its way."""
_BESIDE_M = 1.0
"""[m] How near a body has to come to a place that another body occupies."""
_ROUND = ((1.0, 0.5), (0.87, 0.8), (0.6, 1.0))
"""Half sides of three rectangles that together cover a disc of radius 1."""
_MARGIN_M = 0.04
"""[m] Half the diagonal of a cell: paths may cross a free cell anywhere, but only its middle is tested."""
_TRIES = 100
"""About how many places around a body, or within reach of an object, are tried before all of them are."""


def rotation_towards(pose: Pose, body: BodySpec, point: Vec3) -> Rotate:
    """The rotation after which the head of a body at ``pose`` faces ``point`` [m], tilted to it as far as possible."""
    dx, dy = point[0] - pose.x, point[1] - pose.y
    yaw = plane.wrap(math.atan2(dy, dx) - pose.gaze)
    up = math.atan2(point[2] - body.eye, max(math.hypot(dx, dy), 1e-6))
    return Rotate(yaw=yaw, pitch=max(-body.pitch_limit, min(body.pitch_limit, up)) - pose.pitch)


def route(world: InteractiveSimulation, seat: str, target: str | Vec2) -> tuple[Vec2, ...]:
    """The corners [m] of the shortest way of a seat's body to a place, or to a place from which a thing is in reach.

    Raises:
        UnknownName: when nothing has this id. HthorError: when the place is in no room, or the body cannot move.
    """
    pose = world.pose(seat)
    paths = Geodesics(_space_around_others(world, seat))
    space, here = paths.space, (pose.x, pose.y)
    if not space.is_free(*here):
        here = _nearest_free_floor(world, seat, space)
    goal = _standing_place(world, seat, paths, here, target) if isinstance(target, str) else _indoors(world, target)
    path = paths.path(here, space.nearest_free(*goal, within=space.component(*here)))
    return tuple(path if here != (pose.x, pose.y) else path[1:])


def body_in_the_way(world: InteractiveSimulation, seat: str, target: str | Vec2) -> str:
    """The seat whose body kept another one, at the end of its route, away from the target; empty for none."""
    if _detour(world, seat, target) <= _SHORT_M:
        return ""
    pose = world.pose(seat)
    others = {name: other for name, other in world.poses().items() if name != seat}
    return min(others, key=lambda name: math.dist((others[name].x, others[name].y), (pose.x, pose.y)))


def out_of_hand(world: InteractiveSimulation, seat: str, target: str) -> str:
    """Why a body cannot pick up the object that it walked to; empty when it can, or when it is not an object."""
    states = {state.id: state for state in world.truth()}
    reason = world.out_of_hand(seat, target) if _is_object(world, target) else ""
    inside = states.get(states[target].support) if reason else None
    closed = inside is not None and not inside.open and reason.endswith("out of sight")
    return f"{reason}; {states[target].support} is closed" if closed else reason


def _is_object(world: InteractiveSimulation, target: str) -> bool:
    """Whether ``target`` is an object, not furniture or a body."""
    return any(state.id == target for state in world.objects())


def _detour(world: InteractiveSimulation, seat: str, target: str | Vec2) -> float:
    """How much nearer [m] the body could be if it were alone in the house."""
    if len(world.seats) == 1:
        return 0.0
    pose, space = world.pose(seat), world.space[seat]
    alone = space.component(*space.nearest_free(pose.x, pose.y))
    here = np.array([(pose.x, pose.y)])
    if not isinstance(target, str):
        goal = space.nearest_free(*target, within=alone)
        return math.dist((pose.x, pose.y), goal) - (_BESIDE_M if _is_taken(world, seat, goal) else 0.0)
    enough = max(_FAR_M * (world.bodies[seat].reach or 1.0), float(_gaps(world, target, space.centres(alone)).min()))
    return float(_gaps(world, target, here)[0]) - enough


def _is_taken(world: InteractiveSimulation, seat: str, goal: Vec2) -> bool:
    """Whether another body stands at the goal; then a place next to that body is good enough."""
    others = [(world.pose(name), world.bodies[name].radius) for name in world.seats if name != seat]
    reach = _SHORT_M + world.bodies[seat].radius
    return any(math.dist((pose.x, pose.y), goal) < reach + radius for pose, radius in others)


def _indoors(world: InteractiveSimulation, target: Vec2) -> Vec2:
    x, y = target
    if not any(plane.inside((x, y), room.polygon) for room in world.house.rooms):
        place = f"({numbers.format_number(x)}, {numbers.format_number(y)})"
        raise HthorError(f"{place} is in no room of the house; give a point indoors, or the id of a thing")
    return (x, y)


def _nearest_free_floor(world: InteractiveSimulation, seat: str, space: FreeSpace) -> Vec2:
    """The nearest free floor for a body close to others, which it reaches in a straight line without touching them."""
    pose = world.pose(seat)
    places = space.centres(space.free)
    order = np.argsort(np.hypot(places[:, 0] - pose.x, places[:, 1] - pose.y), kind="stable")[:_TRIES]
    others = [(world.pose(name), world.bodies[name].radius) for name in world.seats if name != seat]
    for x, y in places[order].tolist():
        way = np.linspace((pose.x, pose.y), (x, y), 20)
        gaps = (np.hypot(way[:, 0] - other.x, way[:, 1] - other.y).min() - radius for other, radius in others)
        if all(gap >= world.bodies[seat].radius for gap in gaps):
            return (x, y)
    return space.nearest_free(pose.x, pose.y)


def _space_around_others(world: InteractiveSimulation, seat: str) -> FreeSpace:
    """The floor that is free for this body while the others stay where they are."""
    rows = []
    for name, pose in world.poses().items():
        if name != seat:
            radius = world.bodies[name].radius + _MARGIN_M
            rows += [(pose.x, pose.y, a * radius, b * radius, 0.0) for a, b in _ROUND]
    return doors.with_obstacles(world.space[seat], rows)


def _standing_place(world: InteractiveSimulation, seat: str, paths: Geodesics, here: Vec2, target: str) -> Vec2:
    """The place, by the shortest walk, that is in front of the thing or within reach of the object ``target``.

    A place from which the hand can grasp the target is preferred, then one from which it is in sight.
    """
    places = paths.space.centres(paths.space.component(*here))
    if not len(places):
        raise HthorError(f"{seat} stands where it cannot move")
    gaps = _gaps(world, target, places)
    small = _is_object(world, target)
    rings = []
    for share in _REACH_SHARES if small else (_NEAR_M,):
        near = places[gaps <= max(share * (world.bodies[seat].reach or 1.0), float(gaps.min()) + 1e-9)]
        rings.append(near[np.argsort(paths.distances(here, near), kind="stable")])

    def handy(place: Vec2) -> bool:
        return not world.out_of_hand(seat, target, place)

    def visible(place: Vec2) -> bool:
        return not small or not world.hidden(target, (*place, world.bodies[seat].eye))

    for good in (lambda place: handy(place) and visible(place), visible):
        for near in rings:
            for stride in {max(1, len(near) // _TRIES): 0, 1: 0}:  # first a few places, then all
                for x, y in near[::stride].tolist():
                    if good((x, y)):
                        return (x, y)
    x, y = rings[0][0].tolist()
    return (x, y)


def _gaps(world: InteractiveSimulation, target: str, places: Any) -> Any:
    """(N,) distances [m] from ``places`` (N, 2) to a thing's footprint, or to an object's or body's middle.

    If a near place is in front of the thing, the distance of all places that are not in front is infinite.
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
