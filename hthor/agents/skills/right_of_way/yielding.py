"""Getting past other robots: which one makes room, and which way round."""

import math
from collections.abc import Mapping

from hthor.agents.skills.task_allocation import seat_order
from hthor.agents.skills.viewpoints import Routes, keeps_clear, path_length
from hthor.geometry.plane import turn
from hthor.navigation.path_follower import shift
from hthor.types import Briefing, Motion, Move, Observation, Vec2, Wait, is_person

_YIELD_S, _REST_S = 3.0, 2.0
"""How long to make way for another [s], and then not to make way again [s]."""
_STEP_M = 0.4
_ELBOW_M = 0.45
_BESIDE_M = 0.15
_DETOUR_M = 4.0
"""A path round another body may be this much longer than without that body [m]."""
_STARTS = 6
"""How many places beside the other body a path round it may begin with."""
_STILL_M = 0.02
"""Whoever has moved less than this between two looks stands still [m]."""
_SIDEWAYS = 1.5
"""Weight of a step to the side relative to one straight back."""
_DIRECTIONS = 16


class Yielding:
    """Behaviour after running into a robot: one of the two makes room, the other goes round it.

    A robot with an arm goes first; of equal robots, the one whose seat comes first. For people see
    `hthor.agents.skills.right_of_way.passing`.
    """

    def __init__(self, briefing: Briefing, routes: Routes) -> None:
        self.seat, self.routes, self.tick_s = briefing.seat, routes, briefing.tick_s
        self.bodies = {briefing.seat: briefing.body, **briefing.crew}
        self.radius = briefing.body.radius
        self._along: Vec2 = (0.0, 0.0)
        self._until = self._rest = -1.0
        self._other: Vec2 | None = None
        self._were: Mapping[str, Vec2] = {}

    def note(self, observation: Observation, motion: Motion) -> None:
        """Note the motion that begins now: its direction tells where an unseen body is if the robot runs into it."""
        if isinstance(motion, Move):
            self._along = turn((motion.forward, motion.left), observation.pose.yaw)

    def motion(self, observation: Observation) -> Motion | None:
        """A step out of the way, or None to carry on."""
        seconds = observation.tick * self.tick_s
        by = seat_bumped(observation)
        if by and not is_person(by) and self._goes_first(by) and seconds >= self._rest:
            self._until, self._rest = seconds + _YIELD_S, seconds + _YIELD_S + _REST_S
        if seconds >= self._until:
            return None
        if by:
            self._other = self.place(observation, by)
        if self._other is None or math.dist(self._other, _here(observation)) > self._room(by):
            return Wait(seconds=0.3)
        aside = self.aside(_here(observation), self._other)
        return Wait(seconds=0.3) if aside is None else shift(observation.pose, aside, _STEP_M)

    def give_way(self, observation: Observation, places: Mapping[str, Vec2]) -> Motion | None:
        """A step away from a robot close by that moves, or that has an arm and so may have work here.

        For a robot without a job; None if there is no such robot or no step helps. ``places`` are the positions of the
        other robots [m].
        """
        here, was, self._were = _here(observation), self._were, dict(places)
        if seat_bumped(observation):
            return None
        for seat in sorted(places, key=seat_order):
            works = seat not in was or math.dist(was[seat], places[seat]) > _STILL_M or self._goes_first(seat)
            if seat != self.seat and not is_person(seat) and works and math.dist(here, places[seat]) < self._room(seat):
                aside = self.aside(here, places[seat])
                if aside is not None:
                    return shift(observation.pose, aside, _STEP_M)
        return None

    def place(self, observation: Observation, seat: str) -> Vec2 | None:
        """Position [m] of a body that is in view, or that the robot has just run into."""
        for seen in observation.detections:
            if seen.id == seat:
                return seen.position[:2]
        length = math.hypot(*self._along)
        if seat != seat_bumped(observation) or length == 0.0:
            return None
        share = self.touching(seat) / length
        return (observation.pose.x + share * self._along[0], observation.pose.y + share * self._along[1])

    def _goes_first(self, seat: str) -> bool:
        return self._precedence(seat) < self._precedence(self.seat)

    def _precedence(self, seat: str) -> tuple[bool, tuple[bool, int, str]]:
        body = self.bodies.get(seat)
        return (body is None or "pick" not in body.capabilities, seat_order(seat))

    def touching(self, seat: str) -> float:
        body = self.bodies.get(seat)
        return self.radius + (self.radius if body is None else body.radius)

    def _room(self, seat: str) -> float:
        return self.touching(seat) + _ELBOW_M

    def around(self, observation: Observation, goal: Vec2) -> tuple[Vec2, ...]:
        """A path to ``goal`` that keeps out of the body in the way; () when it has to go away first."""
        here, by = _here(observation), seat_bumped(observation)
        other = self.place(observation, by)
        if other is None:
            return ()
        apart = self.touching(by) + _BESIDE_M
        spots = [
            spot
            for spot in (*_ring(other, apart), *_ring(other, 1.5 * apart))
            if self.routes.stands(spot)
            and self.routes.fits(here, spot)
            and keeps_clear(here, spot, other, apart - _BESIDE_M)
        ]
        body, most = (*other, apart - _BESIDE_M), path_length(self.routes.way(here, goal)) + _DETOUR_M
        for spot in sorted(spots, key=lambda spot: math.dist(here, spot))[:_STARTS]:
            way = self.routes.past(spot, goal, [body], most)
            if way:
                return (spot, *way)
        return ()

    def is_taken(self, observation: Observation, spot: Vec2) -> bool:
        """Whether the body that is in the way stands at this spot."""
        by = seat_bumped(observation)
        other = self.place(observation, by)
        return other is not None and math.dist(other, spot) < self.touching(by)

    def aside(self, here: Vec2, other: Vec2) -> Vec2 | None:
        """The spot a step away that leaves the other most room, preferably to the side; None if no spot does."""
        apart = max(math.dist(here, other), 1e-6)
        ux, uy = (here[0] - other[0]) / apart, (here[1] - other[1]) / apart
        best, most = None, apart + 0.05
        for spot in _ring(here, _STEP_M):
            dx, dy = spot[0] - other[0], spot[1] - other[1]
            score = math.hypot(dx, dy) + _SIDEWAYS * abs(ux * dy - uy * dx) if ux * dx + uy * dy > 0.5 * apart else 0.0
            if score > most + 1e-9 and self.routes.stands(spot) and self.routes.fits(here, spot):
                best, most = spot, score
        return best


def seat_bumped(observation: Observation) -> str:
    """The seat of the body that ended the last move, empty for none."""
    outcome = observation.outcome
    if outcome is None or outcome.ok or outcome.motion != "move":
        return ""
    return outcome.by if outcome.by.startswith(("human", "robot")) else ""


def _here(observation: Observation) -> Vec2:
    return (observation.pose.x, observation.pose.y)


def _ring(centre: Vec2, radius: float) -> list[Vec2]:
    angles = (2.0 * math.pi * k / _DIRECTIONS for k in range(_DIRECTIONS))
    return [(centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)) for angle in angles]
