"""What a participant knows about the other people in the house: where each was seen last, and what they may do.

Nobody knows another's mind: all of this is inferred from bodies in view. With one person in a trial there is nothing to
know, and nothing changes.
"""

import math
from collections.abc import Mapping, Sequence

from msgspec import Struct

from hthor.types import Detection, Vec2, is_person

RECENT_S = 10.0
"""[s] How long people reckon with another person at the place where they saw them last. Our choice."""
_NEARER_M = 0.5
"""[m] Somebody who is nearer to a thing by this much gets there first. Our choice."""
_STILL_M = 0.05
"""[m] A person who has moved less than this between two glimpses is standing still. Our choice."""


class OtherPerson(Struct, frozen=True, kw_only=True):
    """Another person as last seen, at ``tick``: where they stood [m], their heading [rad], the object in their hands.

    ``since`` is the tick from which they have stood there.
    """

    seat: str
    spot: Vec2
    yaw: float
    tick: int
    since: int
    holding: str = ""


class OtherPeople:
    """The other people of a trial, as far as the participant has seen them; ``seats`` are empty if there are none."""

    def __init__(self, teammates: Sequence[str], tick_s: float) -> None:
        self.seats = tuple(seat for seat in teammates if is_person(seat))
        self._recent = round(RECENT_S / tick_s)
        self._seen: dict[str, OtherPerson] = {}

    def see(self, tick: int, detections: Sequence[Detection]) -> None:
        """Process one glimpse: people in view are noticed at once."""
        held = {seat: seen.id for seen in detections for seat in (seen.held_by, *seen.bearers) if seat}
        for seen in detections:
            if seen.family == "person":
                spot, last = seen.position[:2], self._seen.get(seen.id)
                still = last is not None and math.dist(spot, last.spot) < _STILL_M
                self._seen[seen.id] = OtherPerson(
                    seat=seen.id,
                    spot=spot,
                    yaw=seen.yaw,
                    tick=tick,
                    since=last.since if still and last is not None else tick,
                    holding=held.get(seen.id, ""),
                )

    def recent(self, tick: int) -> list[OtherPerson]:
        """Those who were seen a short while ago, in the order of their seats."""
        known = (self._seen[seat] for seat in self.seats if seat in self._seen)
        return [one for one in known if tick - one.tick <= self._recent]

    def is_nearer(self, tick: int, here: Vec2, point: Vec2) -> bool:
        """Whether somebody with free hands is clearly nearer to a point [m] than the participant is."""
        most = math.dist(here, point) - _NEARER_M
        return any(not one.holding and math.dist(one.spot, point) < most for one in self.recent(tick))

    def expected_to_take(self, tick: int, here: Vec2, objects: Mapping[str, Vec2]) -> frozenset[str]:
        """The ``objects`` [m] left to others: the nearest one of each with free hands who is clearly nearer to it."""
        left: set[str] = set()
        for one in self.recent(tick):
            far = {name: math.dist(one.spot, spot) for name, spot in objects.items() if name not in left}
            nearest = min(far, key=lambda name: (far[name], name), default="")
            if nearest and not one.holding and far[nearest] < math.dist(here, objects[nearest]) - _NEARER_M:
                left.add(nearest)
        return frozenset(left)
