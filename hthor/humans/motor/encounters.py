"""How a participant gets past other people: keeps behind them, goes round them on the right, or lets them by.

People keep a gap to whoever walks ahead and plan round somebody who stands or comes towards them, sooner to the right:
in a corridor most pedestrians avoid each other to one side, the same one in a culture (Moussaid et al., 2009,
doi:10.1098/rspb.2009.0405). In a passage too narrow for two, one of them steps back. Everything else is our choice.
"""

import copy
import math

from hthor.geometry.plane import turn, wrap
from hthor.humans.core.other_people import OtherPerson
from hthor.humans.core.trial_context import Behaviour, HumanContext
from hthor.navigation.grid_map import CELL_M, GridMap
from hthor.navigation.path_follower import shift
from hthor.navigation.planner import Planner
from hthor.types import Vec2

Obstacle = tuple[float, float, float]
"""Middle and radius [m] of a disc on the floor."""

AVOID_S = 2.0
"""[s] How long people plan round another person that they met. Our choice: people move on sooner than robots."""
_GAP_M = 0.35
"""[m] Distance that people keep to a person ahead, from body to body. Our choice."""
KEEP_BEHIND_S = 0.2
"""[s] A pause behind somebody who walks ahead. Our choice."""
_SAME_WAY_RAD = math.radians(70.0)
"""[rad] Somebody whose heading differs by less than this goes the same way. Our choice."""
_STANDS_S = 0.6
"""[s] Somebody who has not moved for so long is standing. Our choice."""
_TO_THE_RIGHT_M = 0.1
"""[m] By how much a person is imagined farther to the left, so that the right side looks shorter. Our choice."""
_HOLDS_ON_S = 1.0
"""[s] How long people who do not step back wait for the other to do so. Our choice."""
_STEPS_M = (0.5, 0.9)
"""[m] How far people step back. Our choice."""
_DIRECTIONS = 16
"""[count] Directions in which people may step back. Our choice."""
_SIDEWAYS = 1.5
"""[ratio] Weight of a step to the side relative to one straight back. Our choice."""
_LETS_BY_S = 3.0
"""[s] Longest time for which people who stepped back wait for the other to pass. Our choice."""
_PAST_M = 1.2
"""[m] The other has passed at this distance. Our choice."""
_PIECE_S = 0.3
"""[s] How often people who wait look whether the other has passed. Our choice."""
_THERE_M = 0.05
"""[m] A step back ends this near to its spot. Our choice."""
_LONGEST_STEP_TICKS = 20
"""[ticks] Time after which a step back is over, wherever it led. Our choice."""
_CHANCE = 0.5
"""[chance] Probability of stepping back if neither of the two carries anything, or both do. Our choice."""


def planner_around(grid: GridMap, radius: float, obstacle: Obstacle) -> Planner:
    """A planner for a body of ``radius`` [m] on a copy of the map in which an obstacle stands."""
    trial = copy.deepcopy(grid)
    x, y, size = obstacle
    count = math.ceil(2.0 * math.pi * size / CELL_M)
    for k in range(count):
        angle = 2.0 * math.pi * k / count
        trial.mark_blocked(x + size * math.cos(angle), y + size * math.sin(angle))
    return Planner(trial, radius, optimistic=True)


def person_ahead(human: HumanContext, point: Vec2) -> OtherPerson | None:
    """The person in the way to ``point`` [m], close ahead; not one who holds the other end of the same thing."""
    (x, y), apart = human.here, max(math.dist(human.here, point), 1e-9)
    ux, uy = (point[0] - x) / apart, (point[1] - y) / apart
    wide = 2.0 * human.body.radius
    for other in human.others.recent(human.now.tick):
        dx, dy = other.spot[0] - x, other.spot[1] - y
        along, aside = dx * ux + dy * uy, abs(dy * ux - dx * uy)
        shares = bool(other.holding) and other.holding == human.now.holding
        if not shares and 0.0 < along < min(wide + _GAP_M, apart + wide) and aside < wide:
            return other
    return None


def goes_ahead(human: HumanContext, other: OtherPerson, point: Vec2) -> bool:
    """Whether somebody walks in the same direction as the participant, who walks to ``point`` [m]."""
    way = math.atan2(point[1] - human.here[1], point[0] - human.here[0])
    stands = human.now.tick - other.since >= round(_STANDS_S / human.tick_s)
    return not stands and abs(wrap(other.yaw - way)) < _SAME_WAY_RAD


class Encounters:
    """The latest person who was in the way, and how the participant gets past them.

    A path is planned round them for `AVOID_S`, as if they stood a little farther to the left, so that the right side
    looks shorter. ``met`` is where they were [m], None when something else was in the way.
    """

    def __init__(self, human: HumanContext) -> None:
        self.human = human
        self.met: Vec2 | None = None
        self._until = -1
        self._count = 0

    def avoid(self, other: Vec2) -> Obstacle:
        """The obstacle to plan round from now on: a person at ``other`` [m]."""
        here, radius = self.human.here, self.human.body.radius
        self.met, self._until = other, self.human.now.tick + round(AVOID_S / self.human.tick_s)
        bearing = math.atan2(other[1] - here[1], other[0] - here[0])
        dx, dy = turn((0.0, _TO_THE_RIGHT_M), bearing)
        return (other[0] + dx, other[1] + dy, radius)

    def forget(self) -> None:
        """Note that something else is in the way now."""
        self.met = None

    def blocks(self, goal: Vec2, within: float) -> bool:
        """Whether it may be the person who leaves no path to ``goal`` [m], and they do not stand there themselves."""
        if self.met is None or self.human.now.tick > self._until:
            return False
        return math.dist(self.met, goal) > 2.0 * self.human.body.radius + within

    def let_by(self, planner: Planner) -> Behaviour:
        """Let the person by, or wait until they make room."""
        met, self.met = self.met, None
        assert met is not None
        self._count += 1
        return (yield from _let_by(self.human, planner, met, self._count))


def _let_by(human: HumanContext, planner: Planner, other: Vec2, number: int) -> Behaviour:
    """Meet somebody at ``other`` [m] where there is no room for two: step back, or wait for them to do so.

    Who carries something has precedence, else chance decides; ``number`` counts the encounters of the trial.
    """
    near = [one for one in human.others.recent(human.now.tick) if math.dist(one.spot, other) < 2.0 * human.body.radius]
    loaded, theirs = bool(human.now.holding), any(one.holding for one in near)
    chance = _CHANCE if loaded == theirs else float(theirs)
    spot = _aside(human.here, other, planner) if human.draw("let by", human.seat, number) < chance else None
    if spot is None:
        yield from human.rest(_HOLDS_ON_S)
        return False
    for _ in range(_LONGEST_STEP_TICKS):
        yield shift(human.now.pose, spot, min(human.traits.v_pace, human.body.speed) * human.tick_s)
        outcome = human.now.outcome
        if math.dist(human.here, spot) < _THERE_M or (outcome is not None and not outcome.ok):
            break
    for _ in range(round(_LETS_BY_S / _PIECE_S)):
        yield from human.rest(_PIECE_S)
        seen = human.others.recent(human.now.tick)
        if all(math.dist(one.spot, human.here) > _PAST_M for one in seen):
            break
    return True


def _aside(here: Vec2, other: Vec2, planner: Planner) -> Vec2 | None:
    """The spot a step away that leaves the other most room, preferably to the side; None if no spot does."""
    apart = max(math.dist(here, other), 1e-6)
    ux, uy = (here[0] - other[0]) / apart, (here[1] - other[1]) / apart
    best, most = None, 0.0
    for step in _STEPS_M:
        for k in range(_DIRECTIONS):
            angle = 2.0 * math.pi * k / _DIRECTIONS
            spot = (here[0] + step * math.cos(angle), here[1] + step * math.sin(angle))
            dx, dy = spot[0] - other[0], spot[1] - other[1]
            score = math.hypot(dx, dy) + _SIDEWAYS * abs(ux * dy - uy * dx)
            back = ux * dx + uy * dy > 0.5 * apart
            if back and score > most + 1e-9 and planner.fits(*spot) and planner.straight(here, spot):
                best, most = spot, score
    return best
