"""The map on a participant's display: shown while it is needed, and what it costs to do without it."""

from __future__ import annotations

import math
import statistics
from pathlib import Path

import msgspec
import pytest
from fake_flat import BODY, Flat, play

from hthor.calibration import evidence
from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.map_memory import MapMemory
from hthor.humans.models.proxy import Model
from hthor.humans.population import population_file, resolve
from hthor.humans.population.parameters import NEUTRAL, Parameters
from hthor.humans.population.participant import Participant
from hthor.types import HUMAN, Briefing, Display, DisplayMap, Message, Observation, Pose, Show

SHOWN, HIDDEN = Parameters(), Parameters(map_hidden=1.0)
ON, OFF = (Show(what="map", on=True),), (Show(what="map", on=False),)
PLACE = (6.0, 0.0, 0.8)


def subject(traits: Parameters = SHOWN, root: int = 0) -> HumanContext:
    empty = dict.fromkeys(("instruction", "target", "destination", "relation"), "")
    me = HumanContext(traits, root, Briefing(seat=HUMAN, body=BODY, tick_s=0.1, time_limit=90.0, **empty))  # type: ignore[arg-type]
    see(me, None)
    return me


def see(me: HumanContext, display: Display | None, tick: int = 100) -> None:
    pose = Pose(x=0.0, y=0.0, yaw=0.0)
    me.now = Observation(tick=tick, pose=pose, idle=True, senses=None, display=display)  # type: ignore[arg-type]


def test_the_map_stays_shown_while_a_message_is_followed_and_is_hidden_after_it() -> None:
    me = subject()
    memory = MapMemory(me)
    assert memory.signals((1,)) == (), "an observation without a display"
    see(me, Display())
    assert memory.signals((1,)) == (), "nothing was confirmed yet"
    see(me, Display(map=DisplayMap()))
    assert memory.signals((1,)) == ()
    assert memory.signals(()) == OFF
    see(me, Display())
    assert memory.signals(()) == ()
    assert memory.signals((2,)) == ON, "it is needed again"
    assert memory.recall(1, PLACE) is None


def test_who_walks_with_the_map_hidden_shows_it_again_when_memory_was_of_no_help() -> None:
    me = subject(HIDDEN)
    memory = MapMemory(me)
    see(me, Display(map=DisplayMap()))
    assert memory.signals((1,)) == OFF
    see(me, Display())
    assert memory.signals((1,)) == ()
    memory.consult(1)
    assert memory.signals((1,)) == ON
    assert memory.recall(1, PLACE) is None


def test_a_remembered_direction_is_off_by_what_people_are_off_when_they_point() -> None:
    """On average 30 degrees, the middle of the published 20 to 40; the distance is remembered as it was on the map."""
    off = []
    for root in range(400):
        me = subject(HIDDEN, root)
        there = MapMemory(me).recall(1, PLACE)
        assert there is not None
        assert math.hypot(there[0], there[1]) == pytest.approx(6.0)
        off.append(math.atan2(there[1], there[0]))
    errors = [abs(math.degrees(math.remainder(angle, math.tau))) for angle in off]
    assert statistics.fmean(errors) == pytest.approx(30.0, abs=3.0)
    assert abs(math.degrees(statistics.fmean(off))) < 6.0, "to both sides"


def test_a_place_is_remembered_as_it_was_until_it_is_forgotten() -> None:
    """The span of memory is that of things that were seen: 1/e of people still know after ``tau_seen``."""
    kept = 0
    for root in range(300):
        me = subject(HIDDEN, root)
        memory = MapMemory(me)
        first = memory.recall(1, PLACE)
        see(me, Display(), tick=101)
        assert memory.recall(1, PLACE) == first
        see(me, Display(), tick=100 + round(HIDDEN.tau_seen / 0.1))
        kept += memory.recall(1, PLACE) is not None
    assert kept / 300 == pytest.approx(math.exp(-1.0), abs=0.08)


def test_the_share_of_messages_is_the_parameter() -> None:
    half = Parameters(map_hidden=0.5)
    hidden = [MapMemory(subject(half, root)).is_hidden_for(1) for root in range(400)]
    assert sum(hidden) / 400 == pytest.approx(0.5, abs=0.07)


def test_a_population_from_before_these_parameters_has_the_same_people() -> None:
    paper = population_file.load_population(resolve.default_population())
    assert {name: paper.fixed[name] for name in NEUTRAL} == {name: getattr(Parameters(), name) for name in NEUTRAL}
    assert not set(NEUTRAL) & set(paper.missing)
    assert paper.fixed["map_hidden"] == 0.0


def way(traits: Parameters, person: int) -> tuple[float, float]:
    """Seconds and metres from the confirmation until the named place is near; the apple is never noticed."""
    flat, place = Flat("Bed|1"), (8.3, 2.7, 0.6)
    blind = msgspec.structs.replace(traits, lam0=1e-9, a0=50.0, p_slip=0.0, sigma=0.0)
    model = Model(Participant(seed=1, number=person, traits=blind))
    model.begin(flat.briefing(teammates=("robot",)))
    note = Message(id=0, sender="robot", tick=0, text="It is here.", object="apple", position=place)
    answered: list[int] = []

    def say(tick: int) -> tuple[Message, ...]:
        return (note,) if tick >= 25 and not answered else ()

    def near() -> bool:
        if not answered and any(entry.kind == "offer" for entry in model.journal):
            answered.append(flat.tick)
        return math.dist((flat.pose.x, flat.pose.y), place[:2]) < 1.6

    trace, _ = play(model, flat, ticks=900, until=near, say=say)
    begun = answered[0]
    walked = sum(math.dist(a[:2], b[:2]) for a, b in zip(trace[begun:], trace[begun + 1 :], strict=False))
    return (flat.tick - begun) * 0.1, walked


def test_without_the_map_people_walk_farther_and_arrive_later() -> None:
    """In two rooms, the same people to the same place: who errs walks to the wrong spot first."""
    shown, hidden = [way(SHOWN, k) for k in range(12)], [way(HIDDEN, k) for k in range(12)]
    assert all(without[1] > with_map[1] for with_map, without in zip(shown, hidden, strict=True))
    times, later = (statistics.fmean(seconds for seconds, _ in ways) for ways in (shown, hidden))
    assert later > times + 2.0


def test_parameters_that_change_nothing_do_not_change_whose_evidence_it_is() -> None:
    paper = resolve.resolve_humans("study").population
    known = evidence.load_evidence(Path(evidence.__file__).parent / "evidence" / "paper.json")
    assert known.origin.population_sha256 == paper.sha256
    changed = msgspec.structs.replace(paper, fixed={**paper.fixed, "map_hidden": 0.2})
    assert changed.sha256 != paper.sha256
