"""Explores an unknown house with a map that grows."""

import math
from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from hthor.agents.skills.right_of_way.yielding import seat_bumped
from hthor.geometry.plane import wrap
from hthor.navigation.detours import Disc, detour, without
from hthor.navigation.frontier import Frontier, Survey
from hthor.navigation.grid_map import CELL_M, FREE, UNKNOWN, GridMap
from hthor.navigation.path_follower import Follower
from hthor.navigation.planner import Planner
from hthor.navigation.waiting_spots import park, retreat
from hthor.types import BodySpec, Motion, Observation, Pose, Rotate, Vec2, Vec3

CLOSE_M = 1.15
"""From this far [m] objects near the edge of a table or a counter are within the detector's range."""
_TURN_M_RAD = 1.5
"""Cost of turning [m/rad]."""
_LEAST_M = 0.5
_TURN_RAD = 0.8
"""Largest heading error at which the body moves without turning first: moving sideways saves time."""
_THINK_M = 1.0
"""Distance [m] that it moves before it drops a place that has become uninteresting."""
_TRIES = 4
_WALL_M = 0.12
_REFUGE_M = 5.0
"""Longest way to a place to wait [m]."""
_LOW_M, _HIGH_M, _ASIDE_M = 0.4, 1.1, 1.0


class Explorer:
    """Looks around, then goes to the cheapest frontier or place that was never seen from close by.

    Attributes:
        rounds: how often everything that can be reached was seen.
        edges_only: whether it is content to see the floor of the whole house, not every place from close by.
    """

    def __init__(self, body: BodySpec) -> None:
        self.body = body
        self.grid: GridMap | None = None
        self.follower = Follower(step=0.5, turn_rad=_TURN_RAD)
        self._turns = math.ceil(2.0 * math.pi / (0.9 * body.fov[0]))
        self._integrated: Pose | None = None
        self._place: Frontier | None = None
        self._chose: Vec2 = (0.0, 0.0)
        self._tries: dict[tuple[int, int], int] = {}
        self.rounds = 0
        self.edges_only = False

    def see(self, observation: Observation) -> None:
        """Bring the map up to date; call at every act."""
        pose = observation.pose
        if self.grid is None:
            self.grid = GridMap(pose.x, pose.y)
            self.planner = Planner(self.grid, self.body.radius, optimistic=False)
        if self._integrated != pose:
            self.grid.integrate(observation.scan, CLOSE_M, 0.45 * self.body.fov[0])
            self._integrated = pose
        outcome = observation.outcome
        if observation.idle and outcome is not None and not outcome.ok and outcome.motion == "move":
            self._bumped(pose, seat_bumped(observation))

    def begin_again(self) -> None:
        """Explore once more from here, because things were moved; the map of the house is kept."""
        self._turns, self.rounds = math.ceil(2.0 * math.pi / (0.9 * self.body.fov[0])), 0
        self._tries.clear()
        self.edges_only = False
        if self.grid is not None:
            self.drop()
            self.grid.forget_near()

    def motion(self, observation: Observation) -> Motion:
        """The next motion of the exploration."""
        if self._turns:
            return self._look_around(observation.pose)
        pose, place = observation.pose, self._place
        if place is None or self.follower.done or (self._has_moved(pose) and not self._is_open(place)):
            self._choose(pose)
        step = self.follower.next(observation.pose)
        if step is None:
            self._place = None
            return Rotate(yaw=0.9 * self.body.fov[0])
        return step

    def extra_cost(self, pose: Pose, centre: Vec2) -> float:
        """The cost [m] of a place to explore at ``centre`` [m], besides the way there: that of turning towards it."""
        return _TURN_M_RAD * abs(wrap(math.atan2(centre[1] - pose.y, centre[0] - pose.x) - pose.yaw))

    @property
    def is_on_the_way(self) -> bool:
        """Whether it is going somewhere."""
        return not self.follower.done

    def fits(self, a: Vec2, b: Vec2) -> bool:
        """Whether the body can go straight from ``a`` to ``b``, as far as the map tells."""
        return self.planner.straight(a, b)

    def retreat(self, pose: Pose, point: Vec2, apart_m: float) -> None:
        """Set out for a spot where it blocks nobody, ``apart_m`` metres from ``point``; `follower` leads there."""
        assert self.grid is not None
        self.drop()
        self.follower.take(retreat(self.grid, self.planner, (pose.x, pose.y), point, apart_m))

    def drop(self) -> None:
        """Forget the current goal."""
        self._place = None
        self.follower.take(None)

    def _look_around(self, pose: Pose) -> Motion:
        self._turns -= 1
        return Rotate(yaw=0.9 * self.body.fov[0], pitch=exploring_pitch(self.body) - pose.pitch)

    def _has_moved(self, pose: Pose) -> bool:
        """Whether it has moved far enough since its last choice to choose again."""
        x, y = self._chose
        return math.hypot(pose.x - x, pose.y - y) >= _THINK_M

    def _is_open(self, place: Frontier) -> bool:
        """Whether there is still something to learn at the place."""
        assert self.grid is not None
        x, y = place.centre
        if place.is_edge:
            around = ((CELL_M, 0.0), (-CELL_M, 0.0), (0.0, CELL_M), (0.0, -CELL_M))
            return any(self.grid.at(x + dx, y + dy) == UNKNOWN for dx, dy in around)
        return not self.grid.was_near(x, y)

    def _choose(self, pose: Pose) -> None:
        assert self.grid is not None
        self.drop()
        self._chose = pose.x, pose.y
        survey = Survey(self.grid, self.planner, pose, _LEAST_M)
        for place in survey.ranked(partial(self.extra_cost, pose)):
            key = _key(place)
            if self._tries.get(key, 0) >= _TRIES or (self.edges_only and not place.is_edge):
                continue
            self._tries[key] = self._tries.get(key, 0) + 1
            path = survey.path(place)
            if path is not None:
                self._place = place
                self.follower.take(path)
                return
        self.grid.forget_near()  # everything was seen: start again
        self._tries.clear()
        self.rounds += 1

    def _bumped(self, pose: Pose, by: str) -> None:
        """After a stop: block the cell in front, which no scan showed, or give up a place that ``by`` stands before."""
        assert self.grid is not None
        goal = self.follower.ahead
        if by:
            if self._place is not None:
                self._tries[_key(self._place)] = _TRIES
        elif goal is not None:
            angle = math.atan2(goal[1] - pose.y, goal[0] - pose.x)
            reach = self.body.radius + CELL_M
            self.grid.mark_blocked(pose.x + reach * math.cos(angle), pose.y + reach * math.sin(angle))
        self.drop()


class ObservedRoutes:
    """Routes of a robot through the part of a house that it has seen."""

    def __init__(self, explorer: Explorer) -> None:
        self.explorer = explorer

    def stands(self, spot: Vec2) -> bool:
        """Whether the body may stand here, according to the map."""
        return self.explorer.planner.fits(*spot)

    def standing(self, spots: Sequence[Vec2]) -> list[Vec2]:
        """The spots where the body may stand, according to the map."""
        return [spot for spot in spots if self.explorer.planner.fits(*spot)]

    def fits(self, a: Vec2, b: Vec2) -> bool:
        """Whether the body can go straight from ``a`` to ``b``."""
        return self.explorer.fits(a, b)

    def lengths(self, here: Vec2, spots: Sequence[Vec2]) -> Sequence[float]:
        """Walking distances [m]; inf where no path is known."""
        return self.explorer.planner.distances(here, spots)

    def way(self, here: Vec2, spot: Vec2) -> tuple[Vec2, ...]:
        """The shortest known path, () for none."""
        return self.explorer.planner.path(here, spot) or ()

    def past(self, here: Vec2, goal: Vec2, discs: Sequence[Disc], most_m: float) -> tuple[Vec2, ...]:
        """A known path of at most ``most_m`` [m] that keeps out of the discs; () when there is none."""
        grid = self.explorer.grid
        return () if grid is None else detour(self._free(grid), *_frame(grid), here, goal, discs, most_m)

    def refuge(self, here: Vec2, point: Vec2, apart_m: float, discs: Sequence[Disc]) -> tuple[Vec2, ...]:
        """Like `retreat`, on this side of the discs; () for no place that can be reached."""
        grid = self.explorer.grid
        if grid is None:
            return ()
        spot = park(without(self._free(grid), *_frame(grid), here, discs) > 0, *_frame(grid), here, point, apart_m)
        return () if spot is None else self.past(here, spot, discs, _REFUGE_M)

    def _free(self, grid: GridMap) -> NDArray[np.bool_]:
        """(ny, nx) where the body may be, according to the map."""
        free: NDArray[np.bool_] = (grid.cells == FREE) & (self.explorer.planner.levels < 2)
        return free

    def broad(self, here: Vec2, spot: Vec2) -> tuple[Vec2, ...]:
        """The shortest known path: a robot's own map is too coarse to prefer broad ones."""
        return self.way(here, spot)

    def retreat(self, here: Vec2, point: Vec2, apart_m: float) -> tuple[Vec2, ...]:
        """The path to a spot where the body blocks nobody, ``apart_m`` metres from ``point``; () to stay."""
        explorer = self.explorer
        return () if explorer.grid is None else retreat(explorer.grid, explorer.planner, here, point, apart_m) or ()

    def loose(self, here: Vec2) -> Vec2:
        """Where to go first when the body is stopped here: paths on a map begin with that anyway."""
        return here

    def sees(self, spot: Vec2, point: Vec3) -> bool:  # noqa: ARG002
        """Always True: without a model of the house it has to try."""
        return True

    def open_to(self, spot: Vec2, edge: Vec2) -> bool:
        """Whether nothing on the map is between a spot and the edge of a thing."""
        grid = self.explorer.grid
        return grid is not None and not grid.meets(spot, edge, _WALL_M)


def _frame(grid: GridMap) -> tuple[Vec2, float]:
    """The corner of the map and the side of its cells [m]."""
    return (grid.left * CELL_M, grid.bottom * CELL_M), CELL_M


def exploring_pitch(body: BodySpec) -> float:
    """Camera pitch [rad] that keeps the tops of tables in view from a metre away."""
    low, high = (math.atan2(height - body.eye, _ASIDE_M) for height in (_LOW_M, _HIGH_M))
    return max(-body.pitch_limit, min(body.pitch_limit, (low + high) / 2.0))


def _key(place: Frontier) -> tuple[int, int]:
    return round(place.centre[0] / 0.2), round(place.centre[1] / 0.2)
