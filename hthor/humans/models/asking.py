"""A proxy who asks: after searching in vain for a while, "Where is the apple?".

Speaking takes time, and slows walking as reading does. The answer is a message like any other: it is noticed, read, and
accepted or declined by the same law. In everything else, this person is a `hthor.humans.models.proxy`.
"""

from hthor.humans.communication.asking import Asking
from hthor.humans.memory.subgoals import object_kind
from hthor.humans.models import proxy
from hthor.types import Action, Briefing, Observation


class Model(proxy.Model):
    """The asking human."""

    def begin(self, briefing: Briefing) -> None:
        """Start a trial with an empty memory."""
        super().begin(briefing)
        self._asking = Asking(briefing.teammates, briefing.tick_s)

    def act(self, observation: Observation) -> Action:
        """The next motion, and what is said; a question begins after 20 s of searching in vain."""
        action = super().act(observation)
        if self._dialogue.is_occupied:
            self._asking.postpone(observation.tick)
            return action
        name = self._searched()
        question = self._asking.question(observation, name, object_kind(name))
        if question is not None:
            self._dialogue.ask(question)
        return action

    def _searched(self) -> str:
        """What the participant searches for: an object's id, or its kind if there are several; a kind of furniture."""
        if self._lacks_destination():
            assert self._goal.subgoal is not None
            return next(iter(self._goal.subgoal.job.destinations), "")
        if self._goal.activity != "search" or not self._arbiter.missing:
            return ""
        wanted = self._arbiter.missing[0]
        alike = [subgoal for subgoal in self._subgoals.all.values() if subgoal.kind == wanted.kind]
        return wanted.target if len(alike) == 1 else wanted.kind
