"""What a participant could do next: in words, for policies, and in numbers, for the journal and for listeners."""

from collections.abc import Mapping, Sequence
from typing import Any

from msgspec import Struct

from hthor import catalog
from hthor.errors import HthorError
from hthor.humans.core.policy import OptionDescription, Situation
from hthor.humans.core.thoughts import Beliefs, PlaceBelief, RankedOptions
from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.spatial_memory import KnownDoorway, KnownPlace, SpatialMemory
from hthor.types import Vec2
from hthor.types.events import Choice, OptionRow

MAX_RECORDED = 12
"""[count] Options of one choice kept in the journal: the chosen one and a random sample. Our choice."""
FEATURES = ("knowledge", "uniform", "metres", "exposure", "closed", "is_door")
"""Fields of each option in the journal, see `hthor.humans.core.policy.OptionDescription`; the last two are 0 or 1."""
_GLANCED = 0.5
"""[exposure] Least exposure of a place that is described as "glanced at". Our choice."""
_SEARCHED = 2.0
"""[exposure] Least exposure of a place that is described as "already searched". Our choice."""
_HERE_M = 1.0
"""[m] Options nearer than this are described as "right here". Our choice."""


class Option(Struct, frozen=True, kw_only=True):
    """Search ``place``, or go through ``doorway``; ``value`` is its worth for the time that it takes.

    ``metres`` is the walk to ``spot`` [m], ``seconds`` the whole time, ``exposure`` how well the place was searched.
    """

    name: str
    value: float
    spot: Vec2
    place: KnownPlace | None = None
    doorway: KnownDoorway | None = None
    metres: float = 0.0
    seconds: float = 0.0
    exposure: float = 0.0

    @property
    def is_closed(self) -> bool:
        """Whether it is a place that must be opened first."""
        return self.place is not None and self.place.state == "closed"


def describe(
    human: HumanContext,
    name: str,
    number: int,
    options: Sequence[Option],
    knowledge: Sequence[float],
    uniform: Sequence[float],
) -> Situation:
    """Choice ``number`` of the search called ``name`` for a policy; ``knowledge`` and ``uniform``: probabilities."""
    return Situation(
        instruction=human.task.instruction,
        aim="target" if name in ("target", "tour") else "destination",
        number=number,
        left=human.seconds_left,
        room=human.now.room,
        holding=human.now.holding,
        options=tuple(_described(option, *parts) for option, *parts in zip(options, knowledge, uniform, strict=True)),
    )


def checked_index(index: Any, situation: Situation) -> int:
    """The index that a policy returned.

    Raises:
        HthorError: when it is not an index of an option.
    """
    count = len(situation.options)
    if isinstance(index, bool) or not isinstance(index, int) or not 0 <= index < count:
        raise HthorError(f"a policy's choose must return an index from 0 to {count - 1}, got {index!r}. Fix its file.")
    return index


def record_choice(
    human: HumanContext,
    name: str,
    number: int,
    options: Sequence[Option],
    chosen: Option,
    knowledge: Sequence[float],
    uniform: Sequence[float],
) -> None:
    """Record the choice in the journal: `FEATURES` of each option, and the index of the chosen one.

    Of more than `MAX_RECORDED` options the chosen one and an equally likely sample of the others are kept: a
    conditional logit fitted to such samples is consistent (McFadden 1978).
    """
    kept = list(zip(options, knowledge, uniform, strict=True))
    if len(kept) > MAX_RECORDED:
        luck = {o.name: human.draw("kept", name, number, o.name) for o in options if o is not chosen}
        names = {chosen.name, *sorted(luck, key=luck.__getitem__)[: MAX_RECORDED - 1]}
        kept = [one for one in kept if one[0].name in names]
    rows: tuple[OptionRow, ...] = tuple(
        (round(k, 5), round(u, 5), round(o.metres, 2), round(o.exposure, 3), int(o.is_closed), int(o.place is None))
        for o, k, u in kept
    )
    index = [option for option, *_ in kept].index(chosen)
    human.record(Choice(tick=human.now.tick, seat=human.seat, aim=name, options=rows, chosen=index))


def publish(
    human: HumanContext,
    name: str,
    memory: SpatialMemory,
    options: Sequence[Option],
    chosen: Option,
    beliefs: Mapping[str, float],
    ahead: float,
) -> None:
    """Send the listener `Beliefs` and `RankedOptions`; ``ahead`` is the belief in what lies behind doorways."""
    assert human.listener is not None
    tick, seat = human.now.tick, human.seat
    places = tuple(
        PlaceBelief(
            id=place.id,
            kind=place.kind,
            belief=round(beliefs[place.id], 5),
            exposure=round(memory.exposure(place, tick), 3),
        )
        for place in memory.places.values()
    )
    human.listener(Beliefs(tick=tick, seat=seat, aim=name, ahead=round(ahead, 5), places=places))
    ranked = sorted(options, key=lambda option: (-option.value, option.name))
    human.listener(
        RankedOptions(
            tick=tick,
            seat=seat,
            aim=name,
            options=tuple(option.name for option in ranked),
            values=tuple(round(option.value, 6) for option in ranked),
            metres=tuple(round(option.metres, 2) for option in ranked),
            chosen=chosen.name,
        )
    )


def _described(option: Option, knowledge: float, uniform: float) -> OptionDescription:
    place = option.place
    return OptionDescription(
        name=option.name,
        text=_text(option),
        verb="pass" if place is None else "search",
        kind="" if place is None else place.kind,
        knowledge=knowledge,
        uniform=uniform,
        metres=option.metres,
        seconds=option.seconds,
        exposure=option.exposure,
        closed=option.is_closed,
        value=option.value,
    )


def _text(option: Option) -> str:
    """Such as "open and search the fridge, 4 m away"."""
    far = "right here" if option.metres < _HERE_M else f"{option.metres:.0f} m away"
    if option.place is None:
        return f"go through a doorway to a room not seen yet, {far}"
    verb = "open and search" if option.is_closed else "search"
    seen = ""
    if option.exposure >= _GLANCED:
        seen = ", already searched" if option.exposure >= _SEARCHED else ", glanced at"
    return f"{verb} the {catalog.kind(option.place.kind).title.lower()}, {far}{seen}"
