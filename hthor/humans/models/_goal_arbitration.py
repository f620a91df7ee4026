"""The choice of the goal that a participant pursues now."""

import math
from collections.abc import Callable, Sequence
from typing import Literal

from msgspec import Struct

from hthor.humans.communication.interpretation import Advice, AdviceTracker
from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.object_memory import ObjectMemory
from hthor.humans.memory.spatial_memory import SpatialMemory
from hthor.humans.memory.subgoals import Subgoal, SubgoalTracker
from hthor.types import Vec2, Vec3

Activity = Literal["begin", "deliver", "fetch", "haul", "follow", "search", "rest", "tour"]


class Goal(Struct, frozen=True, kw_only=True):
    """An activity of a participant, and the object or advice that it is about; goals are compared by identity."""

    activity: Activity
    subgoal: Subgoal | None = None
    advice: Advice | None = None

    @property
    def position(self) -> Vec3:
        """Where the goal leads [m]."""
        if self.advice is not None and self.advice.position is not None:
            return self.advice.position
        seen = self.subgoal.known.seen if self.subgoal is not None else None
        assert seen is not None, "only goals with a position are compared"
        return seen.position

    @property
    def words(self) -> str:
        """The goal in words, such as "fetch apple" or "search"."""
        if self.subgoal is not None:
            return f"{self.activity} {self.subgoal.known.id}"
        return self.activity if self.advice is None else f"{self.activity} message {self.advice.number}"

    @property
    def kind(self) -> str:
        """The goal as `hthor.types.events.Believed.next` has it: a message is not named, nor the object of it."""
        if self.subgoal is None or self.activity == "follow":
            return self.activity
        return f"{self.activity} {self.subgoal.known.id}"


BEGIN, SEARCH, REST = Goal(activity="begin"), Goal(activity="search"), Goal(activity="rest")
TOUR = Goal(activity="tour")


class GoalArbiter:
    """Chooses the goal: first the object in hand, then the known or advised object nearest on foot, then search.

    An object that another person seems about to take is left to them. People who do not know where anything belongs
    rest.

    A choice stands until something changes. ``missing`` are the subgoals whose objects must be searched for.
    """

    def __init__(
        self,
        human: HumanContext,
        subgoals: SubgoalTracker,
        objects: ObjectMemory,
        advice: AdviceTracker,
        memory: SpatialMemory,
        distances: Callable[[Vec2, Sequence[Vec2]], Sequence[float]],
    ) -> None:
        self.human, self.subgoals, self.objects, self.advice, self.memory = human, subgoals, objects, advice, memory
        self._distances = distances
        self.missing: tuple[Subgoal, ...] = tuple(subgoals.all.values())
        self._deliveries: dict[str, Goal] = {}
        self._fetches: dict[str, Goal] = {}
        for target, subgoal in subgoals.all.items():
            alone = subgoal.job.hands < 2
            self._fetches[target] = Goal(activity="fetch" if alone else "haul", subgoal=subgoal)
            self._deliveries[target] = Goal(activity="deliver", subgoal=subgoal) if alone else self._fetches[target]
        self._follows: dict[int, Goal] = {}
        self._in_hand: Subgoal | None = None
        self._seen_changes = -1
        self._left: frozenset[str] = frozenset()
        self._choice: Goal | None = None

    def goal(self) -> Goal | None:
        """The goal to pursue now, None when nothing is better than to search."""
        holding = self.human.now.holding
        if holding:
            delivery = self._deliveries.get(holding)
            if delivery is not None:
                self._in_hand = delivery.subgoal
                return delivery
        elif self._in_hand is not None:
            self._put_down(self._in_hand)
        moved = bool(self.human.others.seats) and self._others_have_moved()
        if moved or self._changes() != self._seen_changes:
            self._choice = self._choose()
            self._seen_changes = self._changes()
        return self._choice

    def _changes(self) -> int:
        """A number that grows with everything that could change the choice."""
        places = len(self.memory.places) if self.subgoals.many else 0
        return self.objects.changes + self.advice.changes + places

    def _others_have_moved(self) -> bool:
        """Whether the objects that are left to other people are not the same as before."""
        human, before = self.human, self._left
        lying = [(one.job, one.known.lies) for one in self.subgoals.unfinished()]
        free = [(job.target, seen) for job, seen in lying if seen is not None and job.hands - len(seen.bearers) < 2]
        spots = {target: seen.position[:2] for target, seen in free}
        self._left = human.others.expected_to_take(human.now.tick, human.here, spots)
        return self._left != before

    def _put_down(self, subgoal: Subgoal) -> None:
        """Note that the object in hand was put down, where it belongs or elsewhere."""
        self._in_hand, outcome = None, self.human.now.outcome
        self.objects.changes += 1
        if self.subgoals.many and outcome is not None and outcome.ok and outcome.motion == "place":
            subgoal.done, subgoal.tries = "seen", subgoal.tries + 1
            subgoal.known.at = -1  # its exact position is not seen yet

    def _choose(self) -> Goal | None:
        if all(subgoal.job.relation == "back" for subgoal in self.subgoals.all.values()):
            return REST
        self.subgoals.update()
        unfinished = self.subgoals.unfinished()
        lying = [subgoal for subgoal in unfinished if subgoal.known.lies is not None]
        for subgoal in lying:
            self.advice.drop_about(subgoal)
        self.missing = tuple(subgoal for subgoal in unfinished if subgoal.known.seen is None)
        options = [self._fetches[subgoal.target] for subgoal in lying if subgoal.target not in self._left]
        options += [self._follow(advice) for advice in self.advice.kept.values() if self._is_open(advice)]
        if len(options) > 1:
            return self._nearest(options)
        if options:
            return options[0]
        if self._left and not self.missing:
            return REST
        if not self.missing:
            self.missing = tuple(subgoal for subgoal in self.subgoals.all.values() if subgoal.done != "seen")
        return None if self.missing or not self.subgoals.many else REST

    def _is_open(self, advice: Advice) -> bool:
        return advice.subgoal is None or not advice.subgoal.done

    def _follow(self, advice: Advice) -> Goal:
        return self._follows.setdefault(advice.number, Goal(activity="follow", subgoal=advice.subgoal, advice=advice))

    def _nearest(self, options: list[Goal]) -> Goal:
        spots = [(goal.position[0], goal.position[1]) for goal in options]
        far, here = self._distances(self.human.here, spots), self.human.here
        return options[min(range(len(options)), key=lambda k: (far[k], math.dist(here, spots[k]), k))]
