"""The options of a participant who searches, and which of them is chosen.

An option is worth belief * exp(-exposure) / seconds^kappa; the choice follows Luce's law, P ~ worth^beta.
"""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

import msgspec

from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.spatial_memory import KnownPlace, SpatialMemory
from hthor.humans.motor import approach
from hthor.humans.motor.locomotion import Walker
from hthor.humans.search import option_description
from hthor.humans.search.option_description import Option
from hthor.types import Vec2

DOORWAY_S = 2.0
"""[s] Expected time to go through a doorway and look into the room, without the walk there. Our choice."""
SETTLE_S = 1.0
"""[s] Expected time to stop and turn at a place that is searched, without the look at it. Our choice."""
_STALE_TICKS = 100
"""[ticks] Time after which people choose again where to stand at a place. Our choice: ten seconds."""
_LEFT = 0.3
"""[ratio] Worth of an option that somebody else is nearer to, relative to its worth for a person alone. Our choice."""
_FRESH_TICKS = 50
"""[ticks] How long the options of the last choice count as current. Our choice: five seconds."""


class OptionChoice:
    """Lists the options of one search, for the "target", a "destination" or "room", weighs them and chooses.

    ``belief`` is the probability of each kind of furniture, adding up to 1; empty when the object would have been seen.
    It mixes ``knowledge`` and ``uniform`` ignorance; when these are set, choices are recorded in the journal.
    """

    def __init__(self, human: HumanContext, memory: SpatialMemory, walker: Walker, name: str) -> None:
        self.human, self.memory, self.walker, self.name = human, memory, walker, name
        self.belief: Mapping[str, float] = {}
        self.knowledge: Mapping[str, float] = {}
        self.uniform: Mapping[str, float] = {}
        self._spots: dict[str, tuple[int, list[Vec2]]] = {}
        self._choices = 0
        self._latest: tuple[int, list[Option]] = (-_FRESH_TICKS, [])

    def choose(self) -> Option | None:
        """The next thing to do, by the model's own law or by its policy, if it has one; None without options."""
        options, number, human = self.options(), self._choices, self.human
        self._latest = human.now.tick, options
        self._choices += 1
        if not options:
            return None
        if human.policy is None and not self.knowledge:
            chosen = self._by_luce(options, number)
        else:
            known, uniform = self._shares(options, self.knowledge), self._shares(options, self.uniform)
            if human.policy is None:
                chosen = self._by_luce(options, number)
            else:
                situation = option_description.describe(human, self.name, number, options, known, uniform)
                chosen = options[option_description.checked_index(human.policy.choose(situation), situation)]
            if self.knowledge:
                option_description.record_choice(human, self.name, number, options, chosen, known, uniform)
        if human.listener is not None:
            beliefs = self.place_beliefs(bool(self.memory.unexplored_doorways()))
            ahead = self.doorway_belief(beliefs)
            option_description.publish(human, self.name, self.memory, options, chosen, beliefs, ahead)
        return chosen

    def _by_luce(self, options: Sequence[Option], number: int) -> Option:
        """Luce's law by its Gumbel form: the largest utility, with a random part for each option by its name."""
        beta = self.human.traits.beta

        def utility(option: Option) -> float:
            luck = -math.log(-math.log(self.human.draw("choose", self.name, number, option.name)))
            return beta * math.log(max(option.value, 1e-12)) + luck

        return max(options, key=utility)

    def recent(self) -> list[Option]:
        """The options of the last choice if it was recent, else the current options."""
        tick, _ = self._latest
        if self.human.now.tick - tick >= _FRESH_TICKS:
            self._latest = self.human.now.tick, self.options()
        return self._latest[1]

    def options(self) -> list[Option]:
        """Everything that could be searched from here."""
        doorways = self.memory.unexplored_doorways()
        beliefs = self.place_beliefs(bool(doorways))
        places = [place for place in self.memory.places.values() if beliefs[place.id] > 0.0 and not self.is_done(place)]
        spots = [self.spots(place) for place in places]
        nearest = self._nearest([*spots, *([door.beyond] for door in doorways)])
        options = []
        for place, around in zip(places, spots, strict=True):
            option = self._searching(place, beliefs[place.id], around, *next(nearest))
            options += [option] if option else []
        ahead = self.doorway_belief(beliefs)
        for door in doorways:
            metres, _ = next(nearest)
            seconds = metres / self.human.traits.v_pace + DOORWAY_S
            if math.isfinite(seconds):
                value = ahead / len(doorways) / seconds**self.human.traits.kappa
                name = f"door {door.id}"
                options.append(
                    Option(name=name, value=value, spot=door.beyond, doorway=door, metres=metres, seconds=seconds)
                )
        return [self._shared(option) for option in options] if self.human.others.seats else options

    def _shared(self, option: Option) -> Option:
        """The option, worth less if another person is nearer to it and may search it as well."""
        human = self.human
        if not human.others.is_nearer(human.now.tick, human.here, option.spot):
            return option
        return msgspec.structs.replace(option, value=_LEFT * option.value)

    def place_beliefs(self, more: bool, belief: Mapping[str, float] | None = None) -> dict[str, float]:
        """Belief that the object is at each known place before any search, by kinds of furniture (`belief` by default).

        ``more``: there may be further places of each kind behind doorways.
        """
        by_kind = self.belief if belief is None else belief
        places = self.memory.places.values()
        kinds = Counter(place.kind for place in places)
        unseen = self.human.traits.unseen if more else 0.0
        return {place.id: by_kind.get(place.kind, 0.0) / (kinds[place.kind] + unseen) for place in places}

    def doorway_belief(self, beliefs: Mapping[str, float]) -> float:
        """Belief that the object is behind doorways not yet passed."""
        return max(self.human.traits.spare, 1.0 - sum(beliefs.values()))

    def is_done(self, place: KnownPlace) -> bool:
        """Whether the object is not expected any more at a place that is in plain view."""
        return place.state != "closed" and self.memory.exposure(place, self.human.now.tick) > self.human.traits.e_skip

    def least_searched(self) -> KnownPlace | None:
        """The place that was searched least, or longest ago, for when all places were searched."""
        places = [place for place in self.memory.places.values() if self.belief.get(place.kind, 0.0) > 0.0]
        tick = self.human.now.tick
        return min(places, key=lambda place: (self.memory.exposure(place, tick), place.id), default=None)

    def spots(self, place: KnownPlace) -> list[Vec2]:
        """Where to stand to search a place."""
        tick, known = self._spots.get(place.id, (-_STALE_TICKS, []))
        if self.human.now.tick - tick >= _STALE_TICKS or not known:
            known = approach.viewpoints_of_place(place, self.walker, front=bool(place.state))
            self._spots[place.id] = (self.human.now.tick, known)
        return known

    def _shares(self, options: Sequence[Option], belief: Mapping[str, float]) -> list[float]:
        """Probability of each option by a belief in kinds of furniture, before any search."""
        doors = len(self.memory.unexplored_doorways())
        beliefs = self.place_beliefs(doors > 0, belief)
        ahead = self.doorway_belief(beliefs) / max(1, doors)
        return [ahead if option.place is None else beliefs[option.place.id] for option in options]

    def _nearest(self, groups: Sequence[Sequence[Vec2]]) -> Iterator[tuple[float, int]]:
        """Walking distance [m] to the nearest point of each group, and its index."""
        return iter(self.walker.map.planner.nearest(self.human.here, groups) if groups else ())

    def _searching(
        self, place: KnownPlace, belief: float, spots: Sequence[Vec2], metres: float, number: int
    ) -> Option | None:
        if not math.isfinite(metres):
            return None
        traits, exposure = self.human.traits, self.memory.exposure(place, self.human.now.tick)
        seconds = metres / traits.v_pace + traits.t_dwell + SETTLE_S
        if place.state == "closed":
            seconds += traits.t_manip
        return Option(
            name=place.id,
            value=belief * math.exp(-exposure) / seconds**traits.kappa,
            spot=spots[number],
            place=place,
            metres=metres,
            seconds=seconds,
            exposure=exposure,
        )
