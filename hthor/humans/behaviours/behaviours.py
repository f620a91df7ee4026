"""All behaviours of a trial, built from perceiving, walking and handling."""

import math
from collections.abc import Sequence
from functools import partial

from hthor import rules
from hthor.humans.behaviours.carry import JointCarrying
from hthor.humans.behaviours.deliver import Delivery
from hthor.humans.behaviours.follow_instruction import InstructionFollowing
from hthor.humans.behaviours.follow_message import MessageFollowing
from hthor.humans.behaviours.tour import HouseTour
from hthor.humans.core.trial_context import Behaviour, HumanContext
from hthor.humans.memory.location_priors import location_belief
from hthor.humans.memory.map_memory import MapMemory
from hthor.humans.memory.spatial_memory import SpatialMemory
from hthor.humans.memory.subgoals import Subgoal, SubgoalTracker
from hthor.humans.motor.approach import PATIENCE, Approach
from hthor.humans.motor.locomotion import Walker, never
from hthor.humans.motor.manipulation import Hands
from hthor.humans.perception.perception import Eyes
from hthor.humans.search import expectation
from hthor.humans.search.exploration import Exploration
from hthor.humans.search.option_choice import OptionChoice
from hthor.navigation.waiting_spots import retreat
from hthor.types import Detection, Pick, Vec3

_FOUND_M = 1.3
"""[m] Distance from an object at which people stop when they only have to find it. Our choice."""
_SLACK_M = 0.04
"""[m] How much nearer people come than the rule of finding requires. Our choice."""
_LEAST_FOUND_M2 = 0.25
"""[m^2] Squared distance on the floor within which an object always counts as found. Our choice: half a metre."""
_CHECK_S = 0.4
"""[s] Duration of the look at an object before it is handled. Our choice."""
_PATIENCE_MANY = 3
"""[count] Failed tries after which people believe that an object is gone, in tasks with several jobs. Our choice."""
_ASIDE_M = 0.5
"""[m] How far people who get out of the way go at least. Our choice."""
_REST_S = 4.0
"""[s] Time between two looks round when all jobs are done. Our choice."""


class Behaviours:
    """All behaviours that the participant can begin."""

    def __init__(
        self,
        human: HumanContext,
        eyes: Eyes,
        memory: SpatialMemory,
        walker: Walker,
        subgoals: SubgoalTracker,
        display_map: MapMemory,
    ) -> None:
        self.human, self.eyes, self.memory, self.walker, self.map = human, eyes, memory, walker, display_map
        self.hands = Hands(human)
        self.exploration = Exploration(human, eyes, memory, walker, self.hands)
        self.approach = Approach(human, eyes, memory, walker)
        self.following = MessageFollowing(self.exploration)
        self.tour = HouseTour(self.exploration, eyes.objects)
        self.delivery = Delivery(self.approach, self.exploration, subgoals)
        self.carrying = JointCarrying(self.approach, self.exploration, subgoals)
        self._patience = _PATIENCE_MANY if subgoals.many else PATIENCE
        self._is_aside = False
        self._target_search = OptionChoice(human, memory, walker, "target")
        self.instructions = (
            InstructionFollowing(self.exploration, self._target_search) if human.task.relation == "go" else None
        )
        self.expect(tuple(subgoals.all.values()))

    def reset(self, subgoal: Subgoal | None = None) -> None:
        """Forget earlier tries, because a new behaviour begins; ``subgoal`` is the job that it works on."""
        self.approach.reset()
        self.eyes.attention = None
        self._is_aside = False
        if subgoal is not None:
            self.eyes.current = subgoal.known

    def expect(self, missing: Sequence[Subgoal]) -> None:
        """Search for the ``missing`` objects: divide the belief among them, with little of it at their destinations."""
        search, w_prior = self._target_search, self.human.traits.w_prior
        search.belief, search.knowledge, search.uniform = (self._belief(missing, w) for w in (w_prior, 1.0, 0.0))

    def _belief(self, missing: Sequence[Subgoal], w_prior: float) -> dict[str, float]:
        belief: dict[str, float] = {}
        for subgoal in missing:
            if subgoal.job.relation == "go":  # it is the thing itself that is missing
                return dict.fromkeys(subgoal.job.destinations, 1.0)
            shares = location_belief(subgoal.kind, w_prior)
            for home in subgoal.job.destinations:
                if home in shares:
                    shares = {**shares, home: shares[home] * self.human.traits.dest_factor}
            belief = {kind: belief.get(kind, 0.0) + share / len(missing) for kind, share in shares.items()}
        return belief

    def expected_places(self, subgoal: Subgoal) -> dict[str, float]:
        """The probability with which the object is expected at each known place; the rest is for what was not seen."""
        place = self.human.seat if self.human.now.holding == subgoal.target else expectation.seen_place(subgoal.known)
        if place:
            return {place: 1.0}
        by_kind = self._belief((subgoal,), self.human.traits.w_prior)
        return expectation.place_probabilities(self._target_search, by_kind, self.human.now.tick)

    @property
    def uses_map(self) -> bool:
        """Whether a participant who follows advice needs the map for it, and is not led by an instruction."""
        return self.instructions is None or self.instructions.uses_map

    def search_spared_by(self, request: str) -> OptionChoice:
        """The search that a message makes unnecessary: for the destination (``request`` "bring") or for the target."""
        return self.delivery.search if request == "bring" else self._target_search

    def begin(self) -> Behaviour:
        """Wait a moment, then look round."""
        yield from self.human.rest(self.human.traits.t_on)
        yield from self.exploration.look_round(self.human.traits.scan_first)
        return True

    def search(self) -> Behaviour:
        """Search for the missing objects, or walk where an instruction leads, without end."""
        if self.instructions is not None:
            return (yield from self.instructions.follow() if self.instructions.walks else self.rest())
        yield from self.exploration.look_for(self._target_search, never)
        return True

    def rest(self) -> Behaviour:
        """Look round now and then, because all jobs are done.

        After a tour, others may still have to do what the participant does not remember: so first get out of their way.
        """
        if self.human.began > 0 and not self._is_aside:
            self._is_aside = True
            here, known = self.human.here, self.walker.map
            way = retreat(known.grid, known.planner, here, here, _ASIDE_M)
            if way:
                yield from self.walker.go(way[-1])
        yield from self.human.rest(_REST_S)
        yield from self.exploration.look_round(self.human.traits.scan)
        return True

    def fetch(self, subgoal: Subgoal) -> Behaviour:
        """Go to a noticed object, and pick it up unless the task is only to find it; False when that failed."""
        target = subgoal.known.lies
        if target is None:
            return False
        self.eyes.attention = target.position
        if subgoal.job.relation == "find":
            stop = partial(self._is_close, subgoal)
            reach = self._finding_distance(target.position)
            arrived = yield from self.approach.to_object(target.position, target.support, reach, stop)
        else:
            arrived = yield from self.approach.to_object(target.position, target.support, self.approach.arm)
        if not arrived:
            self._give_up_if_tried(subgoal)
            return False
        visible = yield from self._check(subgoal, target)
        if not visible or subgoal.job.relation == "find":
            return visible
        reason = yield from self.hands.do(Pick(object=target.id), f"pick {target.id}")
        return not reason

    def follow(self, number: int, position: Vec3) -> Behaviour:
        """Go to the ``position`` [m] named by message ``number`` and look there; True when done, in vain or not."""
        if self.instructions is not None:
            return (yield from self.instructions.go_to(position))
        yield from self._visit_from_memory(number, position)
        return (yield from self.following.follow(position))

    def look_into(self, number: int, position: Vec3) -> Behaviour:
        """Go to furniture that a robot asks to search, open it and look; if it is in another room, find it first."""

        def is_known() -> bool:
            return self.memory.at(position) is not None

        yield from self._visit_from_memory(number, position)
        yield from self.exploration.make_for(position, is_known, self._target_search)
        return (yield from self.following.follow(position))

    def deliver(self, subgoal: Subgoal, number: int = -1, advised: Vec3 | None = None) -> Behaviour:
        """Bring the object in hand to where it belongs, such as a place ``advised`` [m] by message ``number``."""
        remembered = None if advised is None else self.map.recall(number, advised)
        if remembered is not None and not (yield from self.delivery.seek(subgoal, remembered)):
            self.map.consult(number)
        return (yield from self.delivery.deliver(subgoal, advised))

    def _visit_from_memory(self, number: int, position: Vec3) -> Behaviour:
        """With the map hidden, go where its place is remembered; who stays there in vain shows the map again."""
        remembered = self.map.recall(number, position)
        if remembered is None:
            return False
        yield from self.following.visit(remembered, lambda: not self.map.is_hidden_for(number))
        self.map.consult(number)
        return True

    def _is_close(self, subgoal: Subgoal) -> bool:
        known = subgoal.known
        return known.seen is not None and known.at == self.human.now.tick and known.seen.distance < _FOUND_M

    def _check(self, subgoal: Subgoal, target: Detection) -> Behaviour:
        """Whether the object is in view from here."""
        yield from self.human.look_at(target.position)
        since = self.human.now.tick
        yield from self.human.rest(_CHECK_S)
        if subgoal.known.at >= since:
            return True
        self._give_up_if_tried(subgoal)
        return False

    def _give_up_if_tried(self, subgoal: Subgoal) -> None:
        """After several tries, forget the object: it is gone, or it was a mistake."""
        if self.approach.tries > self._patience:
            self.reset()
            self.eyes.lose(subgoal.known)

    def _finding_distance(self, point: Vec3) -> float:
        """Distance [m] on the floor at which a point is near enough to the eye to count as found."""
        height = self.human.body.eye - point[2]
        return math.sqrt(max(_LEAST_FOUND_M2, rules.FIND_RANGE_M**2 - height**2)) - _SLACK_M
