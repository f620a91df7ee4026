"""A person who searches, reads messages and trusts more or less, as published studies suggest people do.

Knows nothing but what a headset's wearer perceives.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hthor.humans.errands import Errands
from hthor.humans.memory import Memory
from hthor.humans.messages import Reader
from hthor.humans.parameters import Parameters
from hthor.humans.perception import Eyes
from hthor.humans.person import Person, practised
from hthor.humans.subject import Deed, Subject
from hthor.humans.trust import Experience, Trust, initial
from hthor.humans.walking import Walker
from hthor.types import Action, Briefing, Message, Motion, Observation, Reply, Vec3, Wait

_RESTARTS = 2
_PAUSE_S = 0.5


class Model:
    """The human proxy.

    Args:
        person: who it is; the same person behaves the same on the same observations.
        state: what `state` gave after an earlier trial, to go on from there.
    """

    parameters = Parameters()

    def __init__(self, person: Person, state: Mapping[str, Any] | None = None) -> None:
        self.person = person
        self.traits = person.traits(self.parameters)
        self.trials = int(state["trials"]) if state else 0
        self.trust = Trust(alpha=state["alpha"], beta=state["beta"]) if state else initial(self.traits)

    def begin(self, briefing: Briefing) -> None:
        traits = practised(self.traits, self.trials)
        self._me = Subject(traits, self.person.trial(self.trials), briefing)
        self._experience = Experience()
        self._reader = Reader(traits, self._me.root, briefing.tick_s)
        self._memory = Memory(tau=traits.tau_mem / briefing.tick_s)
        self._eyes = Eyes(traits, self._me.root, briefing.target, self._memory, briefing.tick_s)
        self._hint: tuple[int, Vec3] | None = None
        self._walker: Walker | None = None
        self._deed: Deed | None = None
        self._purpose = "begin"

    def act(self, observation: Observation) -> Action:
        me = self._me
        me.now = observation
        say = self._mail(observation)
        if not observation.idle:
            return Action(motion=Wait(), say=say)
        walker, errands = self._awake(observation)
        if self._memory.visit(me.here, observation.room) and self._purpose != "begin":
            errands.exploring.fresh = me.here
        if self._eyes.due(observation.tick):
            walker.sense()
            self._eyes.look(observation)
        walker.haste = self._haste()
        return Action(motion=self._motion(errands), say=say)

    def rate(self, met: bool, tick: int) -> int | None:  # noqa: ARG002  the hour of help counts, not of the end
        traits, me = self.traits, self._me
        self.trials += 1
        if not me.task.teammates:
            return None
        self.trust = self.trust.after(self._experience.signal(met, traits), traits)
        return self.trust.report(me.normal("report"), traits)

    def state(self) -> dict[str, Any]:
        return {"trials": self.trials, "alpha": self.trust.alpha, "beta": self.trust.beta}

    # ------------------------------------------------------------------------------------------------- what to do next

    def _awake(self, observation: Observation) -> tuple[Walker, Errands]:
        if self._walker is None:
            self._walker = Walker(self._me, self._memory, observation.pose.x, observation.pose.y)
            self._errands = Errands(self._me, self._eyes, self._memory, self._walker)
            self._deed = self._errands.begin()
        return self._walker, self._errands

    def _motion(self, errands: Errands) -> Motion:
        """The next motion of what the person is about, starting anew when that has changed or is done."""
        purpose = self._wish()
        if purpose != self._purpose:
            self._purpose, self._deed = purpose, None
            errands.anew()
            if purpose == "fetch":
                self._hint = None
        for _ in range(_RESTARTS):
            if self._deed is None:
                self._deed = self._set_out(errands)
            motion = next(self._deed, None)
            if motion is not None:
                return motion
            self._finish()
        return Wait(seconds=_PAUSE_S)

    def _wish(self) -> str:
        """What the person is about now; seeing or holding the target comes before everything else."""
        if self._me.now.holding == self._me.task.target:
            return "deliver"
        if self._eyes.target is not None:
            return "fetch"
        if self._hint is not None:
            return f"follow {self._hint[0]}"
        return "begin" if self._purpose == "begin" and self._deed is not None else "search"

    def _set_out(self, errands: Errands) -> Deed:
        if self._purpose == "deliver":
            return errands.deliver()
        if self._purpose == "fetch":
            return errands.fetch()
        return errands.follow(self._hint[1]) if self._hint is not None else errands.search()

    def _finish(self) -> None:
        """The deed is done. A robot's word that led nowhere is not believed again."""
        self._deed = None
        if self._purpose.startswith("follow") and self._hint is not None:
            self._hint = None
            self._experience.misled, self._experience.helped = True, None
            self.trust = self.trust.after(0.0, self.traits)
        self._purpose = self._wish()

    # ---------------------------------------------------------------------------------------------------------- robots

    def _mail(self, observation: Observation) -> Reply | None:
        """Read what came, and answer what was read."""
        reader, tick = self._reader, observation.tick
        reader.receive(tick, observation.inbox)
        self._experience.offered = reader.offered
        message = reader.ready(tick)
        if message is None:
            return None
        reply = reader.answer(message, self.trust.mean, self._useful(message))
        if reply is not None and reply.accept:
            self._believe(message, tick)
        return reply

    def _useful(self, message: Message) -> bool:
        """Whether the message is about what the person still has to find."""
        task, aim = self._me.task, message.object
        if self._me.now.holding:
            return bool(task.destination) and aim.startswith(task.destination) and not self._knows(task.destination)
        return aim in ("", task.target) and self._eyes.target is None

    def _knows(self, kind: str) -> bool:
        return any(place.kind == kind for place in self._memory.places.values())

    def _believe(self, message: Message, tick: int) -> None:
        if self._experience.helped is None and not self._experience.misled:
            self._experience.helped = tick * self._me.tick_s
        if message.position is not None and self._useful(message):
            self._hint = (message.id, message.position)

    def _haste(self) -> float:
        if self._reader.reading:
            return 1.0 / self._me.traits.k_read
        return 1.0 / self._me.traits.k_map if self._purpose.startswith("follow") else 1.0
