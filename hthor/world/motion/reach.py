"""Which points a hand can reach, which objects an arm can lift, and where a held object is."""

import math

from hthor import catalog
from hthor.types import Vec3
from hthor.world.model import geoms
from hthor.world.model.bodies import bodies
from hthor.world.model.composer_env import QPose
from hthor.world.model.geom_index import GeomIndex
from hthor.world.perception import view_frustum
from hthor.world.state.body_state import BodyState
from hthor.world.state.movable_object import MovableObject


def out_of_reach(seat: BodyState, name: str, point: Vec3, lean: float = 1e-6) -> str:
    """Why a hand cannot reach ``point`` [m] if its reach is extended by ``lean`` [m]; empty when it can."""
    pose, spec = seat.pose, seat.spec
    dx, dy = point[0] - pose.x, point[1] - pose.y
    if math.hypot(dx, dy) > spec.reach + lean:
        return f"{name} is {math.hypot(dx, dy):.2f} m away; reach is {spec.reach:.2f} m"
    if dx * math.cos(pose.yaw) + dy * math.sin(pose.yaw) < -1e-6:
        return f"{name} is behind {seat.name}; turn towards it"
    if not spec.reach_low - 1e-6 <= point[2] <= spec.reach_high + 1e-6:
        return f"{name} is at height {point[2]:.2f} m; reach is {spec.reach_low:.2f} to {spec.reach_high:.2f} m"
    return ""


def out_of_sight(seat: BodyState, item: MovableObject, scene: GeomIndex) -> str:
    """Why the eye cannot see an object in any viewing direction; empty when it can."""
    eye = view_frustum.eye_position(seat.pose, seat.spec)
    if all(scene.hidden(eye, point, item.id) for point in view_frustum.look_points(item.position, item.size)):
        return f"{item.id} is out of sight"
    return ""


def too_heavy(seat: BodyState, item: MovableObject) -> str:
    """Why an arm cannot lift an object, empty when it can."""
    if item.mass > seat.spec.strength:
        title = catalog.kind(item.kind).title
        return f"{title} weighs {item.mass:.1f} kg; {seat.spec.title} lifts {seat.spec.strength:.1f} kg"
    return ""


def held_pose(seat: BodyState, size: Vec3) -> QPose:
    """Pose of an object of ``size`` [m] in the hand of ``seat``: it lies on the hand and turns with the body."""
    ahead, left, up = bodies.grasp_point(seat.spec, size)
    cos, sin = math.cos(seat.pose.yaw), math.sin(seat.pose.yaw)
    x, y = seat.pose.x + cos * ahead - sin * left, seat.pose.y + sin * ahead + cos * left
    return (x, y, up, *geoms.quaternion(seat.pose.yaw))
