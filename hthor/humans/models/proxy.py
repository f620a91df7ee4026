"""The human proxy: searches, reads messages and trusts more or less, as published studies suggest people do."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from hthor.humans.behaviours.behaviours import Behaviours
from hthor.humans.communication.accept_decision import time_saved
from hthor.humans.communication.interpretation import Advice, AdviceTracker
from hthor.humans.communication.trust import Trust, initial_trust
from hthor.humans.core.policy import Policy
from hthor.humans.core.thoughts import HumanThought
from hthor.humans.core.trial_context import Behaviour, HumanContext
from hthor.humans.memory.map_memory import MapMemory
from hthor.humans.memory.object_memory import KnownObject, ObjectMemory
from hthor.humans.memory.spatial_memory import SpatialMemory
from hthor.humans.memory.subgoals import SubgoalTracker
from hthor.humans.memory.tour_memory import remembered_briefing, still_believed
from hthor.humans.models._dialogue import Dialogue
from hthor.humans.models._goal_arbitration import BEGIN, REST, SEARCH, TOUR, Goal, GoalArbiter
from hthor.humans.motor.locomotion import Walker
from hthor.humans.perception.perception import GLIMPSE_TICKS, Eyes
from hthor.humans.population.participant import Participant, with_practice
from hthor.humans.search.expectation import after_advice
from hthor.types import Action, Briefing, Motion, Observation, Ready, Reply, Send, Signal, Vec2, Wait, is_person
from hthor.types.events import Believed, JournalEntry

_RESTARTS = 2
"""[count] Behaviours that may end without a motion in one decision. Our choice."""
_PAUSE_S = 0.5
"""[s] Pause before the next decision after `_RESTARTS` behaviours without a motion. Our choice."""
_BUSY = ("fetch", "deliver", "haul")
"""Activities in which something is in hand, or about to be."""


class Model:
    """A proxy; the contract is `hthor.humans.model.HumanModel`.

    Each decision goes through the same steps: read messages, perceive, choose the goal (`GoalArbiter`), and take the
    next motion of the behaviour that pursues it (`Behaviours`).

    Args:
        participant: number, seed and traits; the same participant behaves the same on the same observations.
        state: from `state` after an earlier trial, to continue from there.
    """

    policy: Policy | None = None
    """Decides in the participant's place; set by models that change only the decisions."""
    eyes: type[Eyes] = Eyes
    """How things in view are noticed; set by models that change only the eyes."""
    listener: Callable[[HumanThought], None] | None = None
    """Called with beliefs and choices, from the next trial on."""

    def __init__(self, participant: Participant, state: Mapping[str, Any] | None = None) -> None:
        self.participant = participant
        self.traits = participant.traits
        self.trials = int(state["trials"]) if state else 0
        self.trust = Trust(alpha=state["alpha"], beta=state["beta"]) if state else initial_trust(self.traits)

    def begin(self, briefing: Briefing) -> None:
        """Start a trial with an empty memory."""
        traits = with_practice(self.traits, self.trials)
        human = self._human = HumanContext(traits, self.participant.trial_root(self.trials), briefing, self.policy)
        human.listener = self.listener
        self._memory = SpatialMemory(tau=traits.tau_mem / briefing.tick_s)
        self._objects = ObjectMemory((job.target for job in briefing.todo), briefing.seat)
        self._prepare(human)
        self._walker: Walker | None = None
        self._phase = ""

    def _prepare(self, human: HumanContext) -> None:
        """Begin with a task as the participant knows it now."""
        self._eyes = self.eyes(human, self._objects, self._memory)
        self._subgoals = SubgoalTracker(human, self._memory, self._objects.known)
        self._advice = AdviceTracker(human, self._memory, self._subgoals)
        self._dialogue = Dialogue(human, self._advice)
        self._map = MapMemory(human)
        self._arbiter = GoalArbiter(
            human, self._subgoals, self._objects, self._advice, self._memory, self._walking_distances
        )
        self._behaviour: Behaviour | None = None
        self._goal = BEGIN

    def act(self, observation: Observation) -> Action:
        """The next motion, what is said (an answer when a message was read), and what is shown on the display."""
        human = self._human
        human.now = observation
        if observation.phase != self._phase:
            self._begin_phase(observation)
        dialogue = self._dialogue
        signals: tuple[Signal, ...] = self._map.signals(self._advice.followed) if self._map.is_known else ()
        engaged = observation.inbox or dialogue.reader.now is not None or dialogue.speech.now is not None
        say = self._read_messages() if engaged else None
        if not observation.idle:
            return Action(motion=Wait(), say=say, signals=signals)
        walker = self._walker or self._start_walking(observation)
        if self._memory.visit(human.here, observation.room) and self._goal is not BEGIN:
            self._behaviours.exploration.fresh = human.here
        if observation.tick - self._eyes.at >= GLIMPSE_TICKS or self._eyes.at < 0:
            walker.map.sense()
            self._eyes.look(observation)
            if human.others.seats:
                human.others.see(observation.tick, observation.detections)
        walker.haste, walker.looking = self._haste(), self._is_looking()
        motion = self._next_motion()
        if self._phase and self._behaviours.tour.ready:
            signals = (*signals, Ready())
        return Action(motion=motion, say=say, signals=signals)

    def rate(self, met: bool, tick: int) -> int | None:  # noqa: ARG002  the time of help counts, not the end
        """Update trust by the trial's outcome, and report it."""
        traits = self.traits
        self._eyes.end()
        self.trials += 1
        if all(is_person(seat) for seat in self._human.task.teammates):
            return None
        self.trust = self.trust.after(self._dialogue.experience.signal(met, traits), traits)
        return self.trust.report(self._human.normal("report"), traits)

    @property
    def journal(self) -> Sequence[JournalEntry]:
        """What a headset's recorder would store of the trial so far."""
        return self._human.journal

    def record_belief(self, tick: int, object: str) -> None:
        """Record in the journal where an object is expected, empty for none, and what the participant is doing."""
        subgoal, places = self._subgoals.all.get(object), dict[str, float]()
        if subgoal is not None and self._walker is not None:
            places = self._behaviours.expected_places(subgoal)
            advice = self._advice.kept.get(object)
            if advice is not None and advice.position is not None:
                told = self._memory.at(advice.position)
                places = after_advice(places, told.id if told else "", self.trust.mean)
        shares = {place: round(places[place], 4) for place in sorted(places)}
        seat = self._human.seat
        self._human.record(Believed(tick=tick, seat=seat, object=object, places=shares, next=self._goal.kind))

    @property
    def about(self) -> str:
        """The current goal, in a word or two."""
        return self._goal.words

    def state(self) -> dict[str, Any]:
        """The number of trials done, for practice, and trust."""
        return {"trials": self.trials, "alpha": self.trust.alpha, "beta": self.trust.beta}

    # ------------------------------------------------------------------------------------------------- what to do next

    def _begin_phase(self, observation: Observation) -> None:
        """Begin a tour of the house, or after it the task as remembered."""
        human, self._phase = self._human, observation.phase
        human.began = observation.tick
        if self._phase:
            self._eyes.current = KnownObject(id="")  # nothing is kept in mind more than the rest
        else:
            self._eyes.end()
            human.task = remembered_briefing(human.task, self._objects)
            self._memory.begin_again(any(job.place is not None for job in human.task.todo))
            self._objects = still_believed(human.task.todo, self._objects, human.seat)
            self._prepare(human)
        if self._walker is not None:
            known, self._walker = self._walker.map, None
            self._start_walking(observation).map = known

    def _start_walking(self, observation: Observation) -> Walker:
        """Make legs and behaviours at the first observation, where the mental map begins."""
        self._walker = Walker(self._human, self._memory, observation.pose.x, observation.pose.y)
        self._behaviours = Behaviours(self._human, self._eyes, self._memory, self._walker, self._subgoals, self._map)
        self._expected = self._arbiter.missing
        self._behaviour = self._behaviours.begin()
        return self._walker

    def _walking_distances(self, here: Vec2, points: Sequence[Vec2]) -> Sequence[float]:
        return self._walker.map.planner.distances(here, points) if self._walker is not None else [0.0] * len(points)

    def _next_motion(self) -> Motion:
        """The next motion; a new behaviour begins when the goal has changed or the old behaviour has ended."""
        goal = self._wanted_goal()
        if goal is not self._goal:
            self._behaviour = None
            self._turn_to(goal)
        if self._expected is not self._arbiter.missing:
            self._expected = self._arbiter.missing
            self._behaviours.expect(self._expected)
        for _ in range(_RESTARTS):
            if self._behaviour is None:
                self._behaviour = self._behaviour_for(self._goal)
            motion = next(self._behaviour, None)
            if motion is not None:
                return motion
            self._finish()
        return Wait(seconds=_PAUSE_S)

    def _wanted_goal(self) -> Goal:
        """The arbiter's goal, else the first look round, else a search."""
        goal = self._arbiter.goal() if not self._phase else None
        if goal is not None:
            return goal
        if self._goal is BEGIN and self._behaviour is not None:
            return BEGIN
        return TOUR if self._phase else SEARCH

    def _turn_to(self, goal: Goal) -> None:
        self._goal = goal
        self._behaviours.reset(goal.subgoal)

    def _behaviour_for(self, goal: Goal) -> Behaviour:
        behaviours = self._behaviours
        if goal.advice is not None and goal.advice.position is not None:
            follow = behaviours.look_into if goal.advice.request == "look" else behaviours.follow
            return follow(goal.advice.number, goal.advice.position)
        if goal is TOUR:
            return behaviours.tour.walk()
        if goal.subgoal is None:
            return behaviours.rest() if goal is REST else behaviours.search()
        if goal.activity == "deliver":
            advice = self._advice.destination
            return behaviours.deliver(goal.subgoal, *(() if advice is None else (advice.number, advice.position)))
        return behaviours.fetch(goal.subgoal) if goal.activity == "fetch" else behaviours.carrying.carry(goal.subgoal)

    def _finish(self) -> None:
        """Handle the end of a behaviour; advice that was of no help is not believed again."""
        self._behaviour, advice = None, self._goal.advice
        if advice is not None:
            self._advice.drop(advice)
            if advice.request != "look" and self._dialogue.is_from_robot(advice):
                self._dialogue.record_misled()
                self.trust = self.trust.after(0.0, self.traits)
        goal = self._wanted_goal()
        if goal is not self._goal and goal.subgoal is not None:
            self._turn_to(goal)
        self._goal = goal

    # --------------------------------------------------------------------------------------------------------- messages

    def _read_messages(self) -> Reply | Send | None:
        """Read new messages, answer those that were read, keep accepted advice, and say what is due."""
        now = self._human.now
        busy = bool(now.holding) or self._goal.activity in _BUSY
        decision = self._dialogue.read(now, self.trust.mean, busy, self._time_saved)
        if decision is None:
            return None
        if decision.advice is not None:
            self._advice.accept(decision.advice)
            if decision.advice.request == "bring":
                self._behaviour = None  # deliver again, this time to the advised place
        return decision.say

    def _time_saved(self, advice: Advice) -> tuple[float, float | None]:
        """Seconds that advice saves and metres to its place; nothing before the first look at the house."""
        if self._walker is None:
            return 0.0, None
        search = self._behaviours.search_spared_by(advice.request)
        return time_saved(self._human, self._walker, search, advice.position)

    def _haste(self) -> float:
        """Factor of the pace, below 1 while reading or speaking, or while following the map to an unknown place."""
        if self._dialogue.is_slowing(self._human.now.tick):
            return 1.0 / self._human.traits.k_read
        following = self._goal.activity == "follow"
        advice = self._goal.advice if following else self._advice.destination
        if advice is None or not (self._lacks_destination() if not following else self._behaviours.uses_map):
            return 1.0
        return 1.0 if self._map.is_hidden_for(advice.number) else 1.0 / self._human.traits.k_map

    def _is_looking(self) -> bool:
        """Whether the participant is searching, not on the way to a place that is known or advised."""
        return self._goal.activity == "search" or (self._advice.destination is None and self._lacks_destination())

    def _lacks_destination(self) -> bool:
        """Whether something is in hand and its destination is not known."""
        goal = self._goal
        return (
            goal.activity == "deliver"
            and goal.subgoal is not None
            and not self._subgoals.knows_destination(goal.subgoal)
        )
