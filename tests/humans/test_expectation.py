"""Where a person expects an object, and what they are doing, when a robot predicts it."""

from __future__ import annotations

import math

import pytest
from fake_flat import Flat, play

from hthor.humans.models import proxy
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Participant
from hthor.humans.search.expectation import after_advice
from hthor.types import HUMAN
from hthor.types.events import Believed

SURE = Parameters(p_slip=0.0, p_fail=0.0)


def person() -> proxy.Model:
    return proxy.Model(Participant(seed=0, number=0, traits=SURE))


def asked(flat: Flat, ticks: int, every: int = 10) -> list[Believed]:
    """What a person had in mind who was asked every so many ticks, while they looked for the apple and put it down."""
    one = person()
    one.begin(flat.briefing("on", "dining_table"))
    for _ in range(ticks // every):
        play(one, flat, every)
        one.record_belief(flat.tick, "apple")
    return [entry for entry in one.journal if isinstance(entry, Believed)]


def test_who_searches_in_vain_expects_it_elsewhere_and_who_sees_it_knows() -> None:
    told = asked(Flat(support="Fridge|1"), 200)
    for entry in told:
        assert all(0.0 <= share <= 1.0 for share in entry.places.values())
        assert math.fsum(entry.places.values()) <= 1.0 + 1e-3
        assert list(entry.places) == sorted(entry.places)
    assert told[-1].places["Bed|1"] < told[0].places["Bed|1"]  # it was looked at in vain
    assert told[-1].places["Fridge|1"] == max(told[-1].places.values())  # it is shut, and apples belong there
    told = asked(Flat(support="Bed|1"), 300)
    fetching = [entry for entry in told if entry.next == "fetch apple"]
    assert fetching
    assert all(entry.places == {"Bed|1": 1.0} for entry in fetching)
    assert [entry for entry in told if entry.next == "deliver apple" and entry.places == {HUMAN: 1.0}]


def test_to_be_asked_changes_nothing() -> None:
    def walk(every: int) -> list[object]:
        flat, one, trace = Flat(support="Bed|1"), person(), []
        one.begin(flat.briefing("on", "dining_table"))
        for _ in range(600):
            play(one, flat, 1)
            if every and flat.tick % every == 0:
                one.record_belief(flat.tick, "apple")
            trace.append(flat.pose)
        return [trace, [entry for entry in one.journal if not isinstance(entry, Believed)]]

    assert walk(0) == walk(1)


def test_an_object_that_is_not_of_the_task_is_expected_nowhere() -> None:
    one, flat = person(), Flat()
    one.begin(flat.briefing())
    one.record_belief(0, "apple")  # before they have opened their eyes
    play(one, flat, 50)
    one.record_belief(50, "piano")
    first, last = (entry for entry in one.journal if isinstance(entry, Believed))
    assert (first.places, first.next) == ({}, "begin")
    assert (last.object, last.places) == ("piano", {})


@pytest.mark.parametrize("trust", [0.0, 0.4, 1.0])
def test_accepted_advice_takes_its_share_from_the_rest(trust: float) -> None:
    before = {"bed": 0.3, "table": 0.5}
    after = after_advice(before, "bed", trust)
    assert after["bed"] == pytest.approx(0.3 * (1 - trust) + trust)
    assert after["table"] == pytest.approx(0.5 * (1 - trust))
    assert after_advice(before, "", trust) == {id: pytest.approx((1 - trust) * share) for id, share in before.items()}
