"""A person's options put into words, and into numbers for the record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hthor import catalog, seeds
from hthor.errors import HthorError
from hthor.humans.core.policy import Choice, Situation
from hthor.types import HUMAN, Event

if TYPE_CHECKING:
    from hthor.humans.search.option_choice import Option, Search

MOST = 12
"""So many options of one choice are kept in the journal: the chosen one, and others that chance picks."""
FEATURES = ("knowledge", "uniform", "metres", "exposure", "closed", "is_door")
"""What the journal holds of each option, see `hthor.humans.core.policy.Choice`; the last two are 0 or 1."""
_LOOKED, _SEARCHED = 0.5, 2.0


def describe(search: Search, options: Sequence[Option], number: int) -> Situation:
    """The choice as somebody sees it who was asked to decide."""
    me = search.me
    known, uniform = _parts(search, options)
    return Situation(
        instruction=me.task.instruction,
        aim="target" if search.name == "target" else "destination",
        number=number,
        left=max(0.0, me.task.time_limit - me.now.tick * me.tick_s),
        room=me.now.room,
        holding=me.now.holding,
        options=tuple(_choice(option, *parts) for option, *parts in zip(options, known, uniform, strict=True)),
    )


def valid(answer: Any, situation: Situation) -> int:
    """The index that a policy gave.

    Raises:
        HthorError: when it is none of the options'.
    """
    count = len(situation.options)
    if isinstance(answer, bool) or not isinstance(answer, int) or not 0 <= answer < count:
        raise HthorError(
            f"a policy's choose must return an index from 0 to {count - 1}, got {answer!r}. Mend its file."
        )
    return answer


def features(search: Search, options: Sequence[Option], chosen: Option, number: int) -> dict[str, Any]:
    """The choice as the journal holds it: `FEATURES` of each option, and the index of the chosen one.

    Of more than `MOST` options chance keeps some, each equally likely, besides the chosen one: a conditional logit that
    is fitted to such samples is as right as one that is fitted to all of them (McFadden 1978).
    """
    kept = list(options)
    if len(kept) > MOST:
        root = search.me.root
        luck = {o.name: seeds.draw(root, "kept", search.name, number, o.name) for o in kept if o is not chosen}
        names = {chosen.name, *sorted(luck, key=luck.__getitem__)[: MOST - 1]}
        kept = [option for option in kept if option.name in names]
    known, uniform = _parts(search, kept)
    rows = [
        [round(k, 5), round(u, 5), round(o.metres, 2), round(o.exposure, 3), _closed(o), int(o.place is None)]
        for o, k, u in zip(kept, known, uniform, strict=True)
    ]
    return {"aim": search.name, "options": rows, "chosen": kept.index(chosen)}


def tell(search: Search, options: Sequence[Option], chosen: Option) -> None:
    """Let whoever looks into the mind know: events "beliefs" and "choice", by the options' names."""
    me, memory = search.me, search.memory
    assert me.think is not None
    beliefs = search.beliefs(any(door.sides and not door.spent for door in memory.doorways.values()))
    places = [
        {
            "id": place.id,
            "kind": place.kind,
            "belief": round(beliefs[place.id], 5),
            "exposure": round(memory.exposure(place, me.now.tick), 3),
        }
        for place in memory.places.values()
    ]
    about = {"aim": search.name, "ahead": round(search.ahead(beliefs), 5), "places": places}
    me.think(Event(tick=me.now.tick, seat=HUMAN, kind="beliefs", data=about))
    ranked = sorted(options, key=lambda option: (-option.value, option.name))
    data = {
        "aim": search.name,
        "options": [option.name for option in ranked],
        "values": [round(option.value, 6) for option in ranked],
        "metres": [round(option.metres, 2) for option in ranked],
        "chosen": chosen.name,
    }
    me.think(Event(tick=me.now.tick, seat=HUMAN, kind="choice", data=data))


def _parts(search: Search, options: Sequence[Option]) -> tuple[list[float], list[float]]:
    """Each option's share by common knowledge alone, and by not knowing."""
    doors = sum(door.sides != [] and not door.spent for door in search.memory.doorways.values())
    return _shares(search, options, search.knowledge, doors), _shares(search, options, search.uniform, doors)


def _shares(search: Search, options: Sequence[Option], hope: Mapping[str, float], doors: int) -> list[float]:
    beliefs = search.beliefs(doors > 0, hope)
    ahead = search.ahead(beliefs) / max(1, doors)
    return [ahead if option.place is None else beliefs[option.place.id] for option in options]


def _closed(option: Option) -> int:
    return int(option.place is not None and option.place.state == "closed")


def _choice(option: Option, knowledge: float, uniform: float) -> Choice:
    place = option.place
    return Choice(
        name=option.name,
        text=_text(option),
        verb="pass" if place is None else "search",
        kind="" if place is None else place.kind,
        knowledge=knowledge,
        uniform=uniform,
        metres=option.metres,
        seconds=option.seconds,
        exposure=option.exposure,
        closed=bool(_closed(option)),
        value=option.value,
    )


def _text(option: Option) -> str:
    """What a person would call it, such as "open and search the fridge, 4 m away"."""
    far = "right here" if option.metres < 1.0 else f"{option.metres:.0f} m away"
    if option.place is None:
        return f"go through a doorway to a room not seen yet, {far}"
    verb = "open and search" if _closed(option) else "search"
    seen = (
        ", already searched" if option.exposure >= _SEARCHED else ", glanced at" if option.exposure >= _LOOKED else ""
    )
    return f"{verb} the {catalog.kind(option.place.kind).title.lower()}, {far}{seen}"
