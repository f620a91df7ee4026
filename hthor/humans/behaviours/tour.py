"""Looking around the house before a task begins, to remember where things are."""

from hthor.humans.core.trial_context import Behaviour
from hthor.humans.memory.location_priors import receptacle_kinds
from hthor.humans.memory.object_memory import ObjectMemory
from hthor.humans.search.exploration import Exploration
from hthor.humans.search.option_choice import OptionChoice
from hthor.humans.search.option_description import Option

BORED_S = 30.0
"""[s] People end a tour after noticing nothing new for so long. Our choice."""
_LOOK_S = 4.0
"""[s] Time between two looks round while others are not ready yet. Our choice."""


class HouseTour:
    """One tour: every piece of furniture is as interesting as any other, so the nearest comes first.

    Attributes:
        ready: whether the participant has noticed all objects of the task, has looked at everything, or is bored.
    """

    def __init__(self, exploration: Exploration, objects: ObjectMemory) -> None:
        self.exploration, self.objects, self.human = exploration, objects, exploration.human
        self._search = _Sights(exploration.human, exploration.memory, exploration.walker, "tour")
        self._search.belief = dict.fromkeys(receptacle_kinds(), 1.0 / len(receptacle_kinds()))
        self._noticed, self._since = -1, self.human.now.tick
        self.ready = False

    def walk(self) -> Behaviour:
        """Look at everything, then wait for the others."""
        yield from self.exploration.look_for(self._search, self._is_over)
        self.ready = True
        while True:
            yield from self.human.rest(_LOOK_S)
            yield from self.exploration.look_round(self.human.traits.scan)

    def _is_over(self) -> bool:
        known = self.objects.known.values()
        noticed = [one for one in known if one.seen is not None or one.lost]
        count, tick = len(noticed) + len(self.exploration.memory.places), self.human.now.tick
        if count != self._noticed:
            self._noticed, self._since = count, tick
        bored = (tick - self._since) * self.human.tick_s > BORED_S
        return bored or self._search.exhausted or len(noticed) == len(known)


class _Sights(OptionChoice):
    """The choice of what to look at next; ``exhausted`` once nothing is left."""

    exhausted = False

    def choose(self) -> Option | None:
        option = super().choose()
        self.exhausted = option is None
        return option
