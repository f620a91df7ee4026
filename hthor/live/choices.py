"""What a person can do with their hands where they stand and look, in the words of a page.

It follows from what the person sees, so the page offers nothing that they cannot know of. Whether a motion succeeds is
decided by the world, whose reason is shown when it does not.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

from hthor.live.wire import Choice, Choices, Hand
from hthor.types import Close, Detection, Drop, Observation, Open, Pick, Place, Thing, Vec3
from hthor.world.state.support_surfaces import SupportSurfaces

_AIM = math.radians(24.0)
"""[rad] A thing is aimed at when its middle is no farther from the line of sight. Our choice."""
_TOUCH_M = 0.15
"""[m] A hand of a person with a headset touches what is no farther from it. Our choice."""
_ABOVE_M = 0.6
"""[m] A hand that is no higher above furniture puts things down straight below it. Our choice."""
_DOWN = (0.0, 0.0, -1.0)


def find_choices(seen: Observation, eye: float, reach: float, hand: Hand | None = None) -> Choices:
    """What a person whose eyes are so high and whose arms reach so far [m] may do now.

    Args:
        hand: of a person with a headset, who does what the hand is near or points at; else what they look at counts.
    """
    if not seen.idle:
        return Choices()
    near = [one for one in seen.detections if _gap(one, seen) <= reach]
    sight = _sight(seen, eye) if hand is None else hand
    aim = _aimed(near, *sight, touch=0.0 if hand is None else _TOUCH_M)
    door = aim(lambda one: one.state in ("open", "closed"))
    opens = None
    if door is not None:
        shut = door.state == "closed"
        motion = Open(thing=door.id) if shut else Close(thing=door.id)
        opens = Choice(words=f"{'open' if shut else 'close'} the {_name(door.kind)}", motion=motion)
    lines = [(*sight, math.inf)] if hand is None else [(hand.place, _DOWN, _ABOVE_M), (*hand, math.inf)]
    return Choices(hand=_held(seen, near, lines, reach) if seen.holding else _free(aim), door=opens)


def _free(aim: Callable[[Callable[[Detection], bool]], Detection | None]) -> Choice | None:
    thing = aim(lambda one: one.family == "object" and not one.held_by)
    return None if thing is None else Choice(words=f"pick up the {_name(thing.kind)}", motion=Pick(object=thing.id))


def _held(
    seen: Observation, near: Sequence[Detection], lines: Iterable[tuple[Vec3, Vec3, float]], reach: float
) -> Choice | None:
    """What to do with what is in hand: put it where one of the lines meets furniture in reach, or let go of it.

    Args:
        lines: where each begins [m], its direction, and its length [m]; the first that meets something counts.

    Returns:
        None where a line meets furniture that is near, but whose surfaces are too far inside for the hand to reach.
    """
    held = next((one.kind for one in seen.detections if one.id == seen.holding), seen.holding)
    for start, way, length in lines:
        met = [(_meets(one, start, way), one) for one in near if one.family == "furniture"]
        hits = [(distance, one) for distance, one in met if distance is not None and distance <= length]
        if hits:
            break
    else:
        return Choice(words=f"let go of the {_name(held)}", motion=Drop())
    distance, thing = min(hits, key=lambda hit: (hit[0], hit[1].id))
    if _surface_gap(thing, seen) > reach:
        return None
    point = (start[0] + distance * way[0], start[1] + distance * way[1], start[2] + distance * way[2])
    inside = "in" if thing.state else "on"
    words = f"put the {_name(held)} {inside} the {_name(thing.kind)}"
    return Choice(words=words, motion=Place(on=thing.id, position=point))


def _aimed(
    near: Iterable[Detection], eye: Vec3, way: Vec3, touch: float
) -> Callable[[Callable[[Detection], bool]], Detection | None]:
    """A function that finds what the person touches, or else aims at, among what fits."""

    def angle(one: Detection) -> float:
        if touch > 0.0 and (gap := _outside(one, eye)) <= touch:
            return gap - touch
        if _meets(one, eye, way) is not None:
            return 0.0
        to = tuple(a - b for a, b in zip(one.position, eye, strict=True))
        length = math.hypot(*to)
        return math.acos(max(-1.0, min(1.0, sum(a * b for a, b in zip(to, way, strict=True)) / length)))

    ranked = sorted((round(angle(one), 3), one.distance, one.id, one) for one in near)

    def find(fits: Callable[[Detection], bool]) -> Detection | None:
        return next((one for off, _, _, one in ranked if off <= _AIM and fits(one)), None)

    return find


def _sight(seen: Observation, eye: float) -> tuple[Vec3, Vec3]:
    """The eye [m] and the direction of sight."""
    pose = seen.pose
    flat = math.cos(pose.pitch)
    return (pose.x, pose.y, eye), (
        flat * math.cos(pose.gaze),
        flat * math.sin(pose.gaze),
        math.sin(pose.pitch),
    )


def _gap(one: Detection, seen: Observation) -> float:
    """[m] How far an object's middle, or the nearest side of anything else, is from the body's axis."""
    x, y = _local(one, (seen.pose.x, seen.pose.y, 0.0))[:2]
    if one.family == "object":
        return math.hypot(x, y)
    return math.hypot(max(0.0, abs(x) - one.size[0] / 2), max(0.0, abs(y) - one.size[1] / 2))


def _surface_gap(one: Detection, seen: Observation) -> float:
    """[m] How far the nearest surface of furniture is from the body's axis, as the world has it; 0 without any."""
    surfaces = SupportSurfaces(
        [Thing(id=one.id, kind=one.kind, asset="", centre=one.position, size=one.size, yaw=one.yaw, room="")]
    )
    surfaces.pull(one.id, 1.0 if one.state == "open" else 0.0)
    return min((place.distance(seen.pose.x, seen.pose.y) for place in surfaces.of(one.id)), default=0.0)


def _meets(one: Detection, eye: Vec3, way: Vec3) -> float | None:
    """[m] How far along the line of sight a thing's box begins; None where the line misses it."""
    start, tip = _local(one, eye), _local(one, (eye[0] + way[0], eye[1] + way[1], eye[2] + way[2]))
    first, last = 0.0, math.inf
    for begin, end, size in zip(start, tip, one.size, strict=True):
        slope = end - begin
        if abs(slope) < 1e-9:
            if abs(begin) > size / 2:
                return None
            continue
        a, b = (-size / 2 - begin) / slope, (size / 2 - begin) / slope
        first, last = max(first, min(a, b)), min(last, max(a, b))
    return first if first <= last else None


def _outside(one: Detection, point: Vec3) -> float:
    """[m] How far a point is from a thing's box; 0 inside."""
    return math.hypot(
        *(max(0.0, abs(along) - size / 2) for along, size in zip(_local(one, point), one.size, strict=True))
    )


def _local(one: Detection, point: Vec3) -> Vec3:
    """A point in the frame of a thing's box."""
    dx, dy = point[0] - one.position[0], point[1] - one.position[1]
    cos, sin = math.cos(one.yaw), math.sin(one.yaw)
    return (cos * dx + sin * dy, cos * dy - sin * dx, point[2] - one.position[2])


def _name(kind: str) -> str:
    return kind.replace("_", " ").replace("|", " ")
