"""When a participant has the map on their display, and what they remember of it while it is hidden.

With the map shown, people read the direction and distance of a place from it all the time. With the map hidden they
walk to where they remember the place: the direction is off by the error that people make when they point to a place
out of sight, and the memory lasts as long as that of a thing that was seen. Where they find nothing they show the map
again, and follow it.

No study says how often people hide the map of HumanTHOR, so by default (``map_hidden`` 0) they keep it shown as long as
they follow a message. That they hide it when it has served its purpose is our choice.
"""

import math

from msgspec import Struct

from hthor.humans.core.trial_context import HumanContext
from hthor.types import Show, Signal, Vec3


class _Remembered(Struct, frozen=True, kw_only=True):
    """Where a place is remembered to be [m], house frame, until ``last``, a tick; later it is forgotten."""

    position: Vec3
    last: float


class MapMemory:
    """How one participant uses the map in one trial; messages are known by their numbers."""

    def __init__(self, human: HumanContext) -> None:
        self.human = human
        self._remembered: dict[int, _Remembered] = {}
        self._consulted: set[int] = set()
        self._has_map = False

    def recall(self, number: int, position: Vec3) -> Vec3 | None:
        """Where the participant believes the place [m] of a message to be; None if they read it from the map.

        Args:
            position: where the message says that it is.
        """
        if not self.is_hidden_for(number):
            return None
        if number not in self._remembered:
            self._remembered[number] = self._remember(number, position)
        return self._remembered[number].position

    def is_hidden_for(self, number: int) -> bool:
        """Whether the participant follows a message with the map hidden, and still remembers its place."""
        share = self.human.traits.map_hidden
        if share <= 0.0 or number in self._consulted or self.human.draw("map hidden", number) >= share:
            return False
        known = self._remembered.get(number)
        return known is None or self.human.now.tick <= known.last

    def consult(self, number: int) -> None:
        """Use the map for this message from now on, because memory did not lead to its place."""
        self._consulted.add(number)

    @property
    def is_known(self) -> bool:
        """Whether the participant has, or has had, a map on their display."""
        if not self._has_map:
            display = self.human.now.display
            self._has_map = display is not None and display.map is not None
        return self._has_map

    def signals(self, followed: tuple[int, ...]) -> tuple[Signal, ...]:
        """What the participant does to the map now; ``followed`` are the messages that they mean to follow."""
        display = self.human.now.display
        if display is None or not self.is_known:
            return ()
        wanted = any(not self.is_hidden_for(number) for number in followed)
        if wanted == (display.map is not None):
            return ()
        return (Show(what="map", on=wanted),)

    def _remember(self, number: int, position: Vec3) -> _Remembered:
        """The place as it stays in memory: as far away as on the map, in a direction that is somewhat wrong."""
        human = self.human
        (x, y), traits = human.here, human.traits
        apart = math.dist((x, y), position[:2])
        towards = math.atan2(position[1] - y, position[0] - x) + traits.point_sd * human.normal("map error", number)
        span = -traits.tau_seen / human.tick_s * math.log(human.draw("forget map", number))
        there = (x + apart * math.cos(towards), y + apart * math.sin(towards), position[2])
        return _Remembered(position=there, last=human.now.tick + span)
