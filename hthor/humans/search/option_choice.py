"""What a person thinks of doing next while they look for something, and which of it they choose."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from msgspec import Struct

from hthor.humans.core.trial_context import Subject
from hthor.humans.memory.spatial_memory import Doorway, Memory, Place
from hthor.humans.motor import viewpoints
from hthor.humans.motor.locomotion import Walker
from hthor.humans.search import option_description
from hthor.types import Vec2

_STALE_TICKS = 100
_FRESH_TICKS = 50
DOOR_S = 2.0
SETTLE_S = 1.0


class Option(Struct, frozen=True, kw_only=True):
    """Search ``place``, or go through ``doorway``: ``value`` is what it promises for its time, ``spot`` where to go.

    ``metres`` is the way there, ``seconds`` what it takes, ``exposure`` how well the place was searched already.
    """

    name: str
    value: float
    spot: Vec2
    place: Place | None = None
    doorway: Doorway | None = None
    metres: float = 0.0
    seconds: float = 0.0
    exposure: float = 0.0


class Search:
    """Weighs and chooses.

    ``knowledge`` and ``uniform`` are the two parts that ``hope`` is mixed of: common knowledge, and not knowing. Where
    they are set, choices are written into the person's journal.

    Args:
        hope: belief in each kind of receptacle, adding up to 1; empty when the thing wanted would have been seen.
        name: what is looked for: "target", "destination" or "room".
    """

    def __init__(self, me: Subject, memory: Memory, walker: Walker, hope: Mapping[str, float], name: str) -> None:
        self.me, self.memory, self.walker, self.hope, self.name = me, memory, walker, hope, name
        self.knowledge: Mapping[str, float] = {}
        self.uniform: Mapping[str, float] = {}
        self._spots: dict[str, tuple[int, list[Vec2]]] = {}
        self._choices = 0
        self._thought: tuple[int, list[Option]] = (-_FRESH_TICKS, [])

    def choose(self) -> Option | None:
        """The next thing to do: by the person's own law, or as the policy says that decides in their place."""
        options, number, me = self.options(), self._choices, self.me
        self._thought = me.now.tick, options
        self._choices += 1
        if not options:
            return None
        if me.policy is None:
            chosen = self._own(options, number)
        else:
            told = option_description.describe(self, options, number)
            chosen = options[option_description.valid(me.policy.choose(told), told)]
        if self.knowledge:
            me.note("choice", **option_description.features(self, options, chosen, number))
        if me.think is not None:
            option_description.tell(self, options, chosen)
        return chosen

    def _own(self, options: Sequence[Option], number: int) -> Option:
        """Chance follows value^beta (Luce), with its own luck for each option."""
        beta = self.me.traits.beta

        def utility(option: Option) -> float:
            luck = -math.log(-math.log(self.me.draw("choose", self.name, number, option.name)))
            return beta * math.log(max(option.value, 1e-12)) + luck

        return max(options, key=utility)

    def recent(self) -> list[Option]:
        """What came to mind at the last choice, if that was just now; else everything that can be thought of."""
        tick, _ = self._thought
        if self.me.now.tick - tick >= _FRESH_TICKS:
            self._thought = self.me.now.tick, self.options()
        return self._thought[1]

    def options(self) -> list[Option]:
        """Everything that can be thought of from here."""
        doorways = [door for door in self.memory.doorways.values() if door.sides and not door.spent]
        beliefs = self.beliefs(bool(doorways))
        places = [place for place in self.memory.places.values() if beliefs[place.id] > 0.0 and not self.done(place)]
        spots = [self.spots(place) for place in places]
        nearest = self._nearest([*spots, *([door.beyond] for door in doorways)])
        found = []
        for place, some in zip(places, spots, strict=True):
            option = self._searching(place, beliefs[place.id], some, *next(nearest))
            found += [option] if option else []
        ahead = self.ahead(beliefs)
        for door in doorways:
            metres, _ = next(nearest)
            seconds = metres / self.me.traits.v_pace + DOOR_S
            if math.isfinite(seconds):
                value = ahead / len(doorways) / seconds**self.me.traits.kappa
                name = f"door {door.id}"
                found.append(
                    Option(name=name, value=value, spot=door.beyond, doorway=door, metres=metres, seconds=seconds)
                )
        return found

    def beliefs(self, more: bool, hope: Mapping[str, float] | None = None) -> dict[str, float]:
        """Belief that the target is at each known place, before it was searched.

        Args:
            more: whether there may be further places of each kind behind doorways.
            hope: belief in each kind of receptacle, the person's own by default.
        """
        held = self.hope if hope is None else hope
        places = self.memory.places.values()
        kinds = Counter(place.kind for place in places)
        unseen = self.me.traits.unseen if more else 0.0
        return {place.id: held.get(place.kind, 0.0) / (kinds[place.kind] + unseen) for place in places}

    def ahead(self, beliefs: Mapping[str, float]) -> float:
        """Belief that the target is behind doorways not yet passed."""
        return max(self.me.traits.spare, 1.0 - sum(beliefs.values()))

    def done(self, place: Place) -> bool:
        """Whether nothing is expected any more of a place that can be seen as it is."""
        return place.state != "closed" and self.memory.exposure(place, self.me.now.tick) > self.me.traits.e_skip

    def again(self) -> Place | None:
        """When everything was searched: the place that was searched least, or longest ago."""
        hoped = [place for place in self.memory.places.values() if self.hope.get(place.kind, 0.0) > 0.0]
        return min(hoped, key=lambda place: (self.memory.exposure(place, self.me.now.tick), place.id), default=None)

    def spots(self, place: Place) -> list[Vec2]:
        """Where to stand to search a place; worked out anew after ten seconds."""
        tick, known = self._spots.get(place.id, (-_STALE_TICKS, []))
        if self.me.now.tick - tick >= _STALE_TICKS or not known:
            known = viewpoints.at(place, self.walker, front=bool(place.state))
            self._spots[place.id] = (self.me.now.tick, known)
        return known

    def _nearest(self, groups: Sequence[Sequence[Vec2]]) -> Iterator[tuple[float, int]]:
        """How far on foot [m] the nearest point of each group is, and which it is."""
        return iter(self.walker.planner.nearest(self.me.here, groups) if groups else ())

    def _searching(
        self, place: Place, belief: float, spots: Sequence[Vec2], least: float, number: int
    ) -> Option | None:
        if not math.isfinite(least):
            return None
        traits, exposure = self.me.traits, self.memory.exposure(place, self.me.now.tick)
        seconds = least / traits.v_pace + traits.t_dwell + SETTLE_S
        if place.state == "closed":
            seconds += traits.t_manip
        return Option(
            name=place.id,
            value=belief * math.exp(-exposure) / seconds**traits.kappa,
            spot=spots[number],
            place=place,
            metres=least,
            seconds=seconds,
            exposure=exposure,
        )
