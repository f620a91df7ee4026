"""A person who searches, reads messages and trusts more or less, as published studies suggest people do."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from hthor.humans.behaviours.behaviours import Errands
from hthor.humans.communication.interpretation import Claims
from hthor.humans.communication.trust import Trust, initial
from hthor.humans.core.policy import Policy
from hthor.humans.core.trial_context import Deed, Subject
from hthor.humans.memory.object_memory import Things
from hthor.humans.memory.spatial_memory import Memory
from hthor.humans.memory.subgoals import Duties, todo
from hthor.humans.models._dialogue import Talk
from hthor.humans.models._goal_arbitration import BEGIN, REST, SEARCH, Agenda, Aim
from hthor.humans.motor.locomotion import Walker
from hthor.humans.perception.perception import GLIMPSE_TICKS, Eyes
from hthor.humans.population.participant import Person
from hthor.humans.population.random_effects import practised
from hthor.types import Action, Briefing, Event, Motion, Observation, Reply, Vec2, Wait

_RESTARTS = 2
_PAUSE_S = 0.5
_BUSY = ("fetch", "deliver", "haul")
_MARGIN_M = 0.06
"""What is nearer to furniture on the map belongs to it; walls are thicker, so that what is behind one is not."""


class Model:
    """The human proxy.

    Args:
        person: who it is; the same person behaves the same on the same observations.
        state: what `state` gave after an earlier trial, to go on from there.
    """

    policy: Policy | None = None
    """What decides in the person's place, if anything; for models that are this one with another head."""
    eyes: type[Eyes] = Eyes
    """How what is in view is noticed; for models with other eyes."""
    listener: Callable[[Event], None] | None = None
    """Who is told what the person believes and chooses, from the next trial on; see `Subject.think`."""

    def __init__(self, person: Person, state: Mapping[str, Any] | None = None) -> None:
        self.person = person
        self.traits = person.traits
        self.trials = int(state["trials"]) if state else 0
        self.trust = Trust(alpha=state["alpha"], beta=state["beta"]) if state else initial(self.traits)

    def begin(self, briefing: Briefing) -> None:
        traits = practised(self.traits, self.trials)
        self._me = Subject(traits, self.person.trial(self.trials), briefing, self.policy)
        self._me.think = self.listener
        self._memory = Memory(tau=traits.tau_mem / briefing.tick_s)
        self._things = Things(job.target for job in todo(briefing))
        self._eyes = self.eyes(self._me, self._things, self._memory)
        self._duties = Duties(self._me, self._memory, self._things.known)
        self._claims = Claims(self._me, self._memory, self._duties)
        self._talk = Talk(self._me, self._claims)
        self._agenda = Agenda(self._me, self._duties, self._things, self._claims, self._memory, self._distances)
        self._walker: Walker | None = None
        self._deed: Deed | None = None
        self._aim = BEGIN

    def act(self, observation: Observation) -> Action:
        me = self._me
        me.now = observation
        say = self._mail(observation) if observation.inbox or self._talk.reader.now is not None else None
        if not observation.idle:
            return Action(motion=Wait(), say=say)
        walker, here = self._walker or self._awake(observation), me.here
        if self._memory.visit(here, observation.room) and self._aim is not BEGIN:
            self._errands.exploring.fresh = here
        if observation.tick - self._eyes.at >= GLIMPSE_TICKS or self._eyes.at < 0:
            walker.sense()
            self._eyes.look(observation)
        walker.haste, walker.looking = self._haste(), self._is_looking()
        return Action(motion=self._motion(), say=say)

    def rate(self, met: bool, tick: int) -> int | None:  # noqa: ARG002  the hour of help counts, not of the end
        traits, me = self.traits, self._me
        self._eyes.end()
        self.trials += 1
        if not me.task.teammates:
            return None
        self.trust = self.trust.after(self._talk.experience.signal(met, traits), traits)
        return self.trust.report(me.normal("report"), traits)

    @property
    def journal(self) -> Sequence[Event]:
        """What the person's recorder holds of the trial so far."""
        return self._me.journal

    @property
    def about(self) -> str:
        """What the person is about, in a word or two."""
        return self._aim.words

    def state(self) -> dict[str, Any]:
        return {"trials": self.trials, "alpha": self.trust.alpha, "beta": self.trust.beta}

    # ------------------------------------------------------------------------------------------------- what to do next

    def _awake(self, observation: Observation) -> Walker:
        self._walker = Walker(self._me, self._memory, observation.pose.x, observation.pose.y, _MARGIN_M)
        self._errands = Errands(self._me, self._eyes, self._memory, self._walker, self._duties)
        self._expected = self._agenda.missing
        self._deed = self._errands.begin()
        return self._walker

    def _distances(self, here: Vec2, points: Sequence[Vec2]) -> Sequence[float]:
        return self._walker.planner.distances(here, points) if self._walker is not None else [0.0] * len(points)

    def _motion(self) -> Motion:
        """The next motion of what the person is about, starting anew when that has changed or is done."""
        aim = self._wish()
        if aim is not self._aim:
            self._deed = None
            self._turn_to(aim)
        if self._expected is not self._agenda.missing:
            self._expected = self._agenda.missing
            self._errands.expect(self._expected)
        for _ in range(_RESTARTS):
            if self._deed is None:
                self._deed = self._set_out(self._errands)
            motion = next(self._deed, None)
            if motion is not None:
                return motion
            self._finish()
        return Wait(seconds=_PAUSE_S)

    def _wish(self) -> Aim:
        """What the person is about now; seeing or holding something wanted comes before everything else."""
        aim = self._agenda.aim()
        if aim is not None:
            return aim
        return BEGIN if self._aim is BEGIN and self._deed is not None else SEARCH

    def _turn_to(self, aim: Aim) -> None:
        self._aim = aim
        self._errands.anew(aim.duty)

    def _set_out(self, errands: Errands) -> Deed:
        aim = self._aim
        if aim.claim is not None and aim.claim.position is not None:
            look = errands.look_into if aim.claim.errand == "look" else errands.follow
            return look(aim.claim.position)
        if aim.duty is None:
            return errands.rest() if aim is REST else errands.search()
        if aim.verb == "deliver":
            return errands.delivering.deliver(aim.duty, self._claims.lead)
        return errands.fetch(aim.duty) if aim.verb == "fetch" else errands.hauling.haul(aim.duty)

    def _finish(self) -> None:
        """The deed is done. A robot's word that led nowhere is not believed again."""
        self._deed, claim = None, self._aim.claim
        if claim is not None:
            self._claims.drop(claim)
            if claim.errand != "look":
                self._talk.mislead()
                self.trust = self.trust.after(0.0, self.traits)
        aim = self._wish()
        if aim is not self._aim and aim.duty is not None:
            self._turn_to(aim)
        self._aim = aim

    # ---------------------------------------------------------------------------------------------------------- robots

    def _mail(self, observation: Observation) -> Reply | None:
        """Read what came, answer what was read, and mean to follow what was confirmed."""
        busy = bool(observation.holding) or self._aim.verb in _BUSY
        errands = self._errands if self._walker is not None else None
        said = self._talk.hear(observation, self.trust.mean, busy, errands)
        if said is None:
            return None
        if said.claim is not None:
            self._claims.believe(said.claim)
            if said.claim.errand == "bring":
                self._deed = None  # set out anew, this time to where one was told
        return said.reply

    def _haste(self) -> float:
        """Share of the pace that is left while reading, or while following the map to where one has never been."""
        if self._talk.reader.reads(self._me.now.tick):
            return 1.0 / self._me.traits.k_read
        led = self._aim.verb == "follow" or (self._claims.lead is not None and self._lacks_home())
        return 1.0 / self._me.traits.k_map if led else 1.0

    def _is_looking(self) -> bool:
        """Whether the person goes about to find something, and not to where they know or were told it is."""
        return self._aim.verb == "search" or (self._claims.lead is None and self._lacks_home())

    def _lacks_home(self) -> bool:
        """Whether the person has something in hand and does not know where it belongs."""
        aim = self._aim
        return aim.verb == "deliver" and aim.duty is not None and not self._duties.knows(aim.duty)
