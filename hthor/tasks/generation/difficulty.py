"""How difficult a task is: its least time, and how many likelier places a person searches before the target's."""

import functools
from collections import Counter, defaultdict
from typing import Literal

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor import catalog, plugins
from hthor.catalog import priors
from hthor.tasks.arrangement.reachability import ReachableFloor
from hthor.tasks.jobs import jobs_left
from hthor.tasks.kind import TaskKind
from hthor.types import HouseSpec, Placement, TaskSpec

Level = Literal["easy", "medium", "hard"]

SEARCH_S = 20.0
"""[s] How much a task's score rises if all other expected places are searched first: about as much as the success of
people without a robot suggests."""
_PACE_M_S, _LOOK_S = 0.4, 5.0
"""Speed of the searcher [m/s] and time to look at a place [s]: chosen by us."""


class Difficulty(Struct, frozen=True, kw_only=True):
    """How difficult a task is.

    Attributes:
        least: the least time [s]. before: the share [0, 1] of the priors' mass that is searched before the target; a
            task without an object to search for has `hthor.tasks.kind.TaskKind.doubt` in its place.
        medium_from, hard_from: the scores at which the strata of the task's kind begin.
    """

    least: float
    before: float
    medium_from: float = TaskKind.medium_from
    hard_from: float = TaskKind.hard_from

    @property
    def score(self) -> float:
        """The least time plus `SEARCH_S` times ``before`` [s]."""
        return self.least + SEARCH_S * self.before

    @property
    def level(self) -> Level:
        """The stratum of this score."""
        return "easy" if self.score < self.medium_from else "medium" if self.score < self.hard_from else "hard"


def level_of(task: TaskSpec, house: HouseSpec, kind: TaskKind | None = None) -> Level:
    """The stratum of a task in its house; ``kind`` is the task's kind, loaded by its name if None."""
    return measure_difficulty(task, house, kind).level


def measure_difficulty(task: TaskSpec, house: HouseSpec, kind: TaskKind | None = None) -> Difficulty:
    """The measures that give a task's stratum; averaged over the targets of all jobs that are not done at the start."""
    own: TaskKind = kind or plugins.load("task kind", task.kind)
    wanted = {job.target for job in jobs_left(task.goal, task.objects, house)}
    targets = [placement for placement in task.objects if placement.id in wanted]
    shares = [_before(task, placement, house) for placement in targets]
    before = sum(shares) / len(shares) if shares else own.doubt(task, house)
    return Difficulty(least=own.least(task), before=before, medium_from=own.medium_from, hard_from=own.hard_from)


def _before(task: TaskSpec, target: Placement, house: HouseSpec) -> float:
    """The share [0, 1] of the prior mass that a sensible searcher looks at before the target's place.

    Places are searched in order of mass per second of walking there from the start and looking; ties count half.
    """
    mass = prior_mass(house, target.kind)
    ways = _ways(house, (task.human_start.x, task.human_start.y))
    worth = {id: share / (ways[id] / _PACE_M_S + _LOOK_S) for id, share in mass.items()}
    brought = {placed.id: placed.support for placed in task.objects}
    place = target.support or target.near
    own = worth.get(brought.get(place, place), 0.0)
    earlier = sum(share for id, share in mass.items() if worth[id] > own)
    level = sum(share for id, share in mass.items() if worth[id] == own)
    return (earlier + level / 2) / max(sum(mass.values()), 1e-12)


@functools.lru_cache(maxsize=256)
def prior_mass(house: HouseSpec, kind: str) -> dict[str, float]:
    """How much of the priors' mass of a kind of object lies at each thing of a house, by the thing's id.

    The weight of a triplet is shared among the things of its reference's kind; the weight of "near another target" goes
    to the things that the other target is *on* or *in*. For kinds without priors, all surfaces count the same.
    """
    if kind not in catalog.TARGETS:
        return {thing.id: 1.0 for thing in house.things if catalog.kind(thing.kind).rests(thing.size)}
    weights: defaultdict[str, float] = defaultdict(float)
    for (relation, reference), weight in priors.weights(kind).items():
        if relation == "near" and reference in catalog.TARGETS:
            for (other, place), share in priors.weights(reference).items():
                weights[place] += weight * share * (other != "near")
        else:
            weights[reference] += weight
    many = Counter(thing.kind for thing in house.things)
    known = [thing for thing in house.things if weights.get(thing.kind, 0.0) > 0.0]
    return {thing.id: weights[thing.kind] / many[thing.kind] for thing in known}


@functools.lru_cache(maxsize=256)
def _ways(house: HouseSpec, start: tuple[float, float]) -> dict[str, float]:
    """Walking distance [m] from a start to the free floor nearest to each thing."""
    ground = ReachableFloor.of(house)
    lengths = ground.paths.distances(ground.space.nearest_free(*start), _beside(house))
    return {thing.id: float(length) for thing, length in zip(house.things, lengths, strict=True)}


@functools.lru_cache(maxsize=32)
def _beside(house: HouseSpec) -> NDArray[np.float64]:
    """(N, 2) [m] For each thing, the place nearest to its middle where a person can stand."""
    space = ReachableFloor.of(house).space
    floor = space.component(*space.nearest_free(house.start.x, house.start.y))
    return np.array([space.nearest_free(*thing.centre[:2], floor) for thing in house.things]).reshape(-1, 2)
