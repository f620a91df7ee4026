"""How people deal with messages: they notice, read, weigh, answer and follow; each step by its own law and luck."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest
from fake_flat import BODY, Flat, play
from hypothesis import given
from hypothesis import strategies as st

from hthor import seeds
from hthor.humans.behaviours import follow_message
from hthor.humans.communication import accept_decision
from hthor.humans.communication.message_reading import MessageReader, is_same_message
from hthor.humans.core import policy
from hthor.humans.core.policy import Offer
from hthor.humans.core.trial_context import HumanContext
from hthor.humans.models.proxy import Model
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Participant
from hthor.humans.search.option_description import Option
from hthor.navigation.grid_map import GridMap
from hthor.types import HUMAN, Briefing, Message, Observation, Pose, Scan

TRAITS = Parameters()
TWELVE = "I found the apple on the dining table in front of me."


def message(number=0, position=(1.0, 1.0, 1.0), thing="apple", text=TWELVE):
    return Message(id=number, sender="robot", tick=0, text=text, object=thing, position=position)


def subject(traits=TRAITS, root=0, chooser=None):
    briefing = Briefing(
        seat=HUMAN,
        instruction="",
        target="apple",
        destination="",
        relation="find",
        body=BODY,
        tick_s=0.1,
        time_limit=90.0,
    )
    me = HumanContext(traits, root, briefing, chooser)
    me.now = Observation(tick=100, pose=Pose(x=0.0, y=0.0, yaw=0.0), idle=True, senses=None)
    return me


def offer(number=1, **changed):
    given = {
        "text": "",
        "object": "apple",
        "sender": "robot",
        "number": number,
        "trust": 0.5,
        "useful": True,
        "gain": 0.0,
        "load": 0.0,
        "again": 0,
    }
    return Offer(**{**given, **changed})


def share(count=600, relevant=True, **changed):
    """Share of people who accept."""
    people = [subject(root=seeds.derive(1, k)) for k in range(count)]
    return sum(accept_decision.decide_answer(me, offer(**changed), relevant) == "accept" for me in people) / count


# ------------------------------------------------------------------------------------------------------ notice and read


def finished(reader, words=TWELVE, number=0, tick=0):
    """Ticks from when a message is shown until it was read; it is refused then."""
    reader.receive(tick, (message(number, text=words),))
    for later in range(tick, tick + 2000):
        reading = reader.ready(later)
        if reading is not None:
            reader.mark_answered(reading, accepted=False)
            reader.receive(later + 1, ())
            return later - tick
    raise AssertionError("never read")


def test_noticing_and_reading_take_their_time():
    """The median is that of the two medians together, as the literature has them."""
    times = sorted(finished(MessageReader(TRAITS, seeds.derive(0, k), 0.1)) / 10 for k in range(400))
    assert times[200] == pytest.approx(TRAITS.t_notice + TRAITS.t_read, rel=0.12)
    assert times[40] < 0.8 * times[200] < times[360] / 1.3


def test_long_messages_take_longer():
    short, long = (
        sum(finished(MessageReader(TRAITS, seeds.derive(0, k), 0.1), words) for k in range(60))
        for words in ("Here.", 3 * TWELVE)
    )
    assert long > 2.0 * short


def test_nobody_reads_before_they_noticed():
    reader = MessageReader(TRAITS, 3, 0.1)
    assert not reader.is_reading(0)
    reader.receive(0, (message(),))
    assert not reader.is_reading(0)
    assert reader.is_reading(math.ceil(reader.now.noticed))
    reader.mark_answered(reader.now, accepted=True)
    assert not reader.is_reading(10_000)


def test_a_repeated_message_is_read_on():
    reader = MessageReader(TRAITS, 0, 0.1)
    reader.receive(0, (message(0),))
    for tick in range(1, 200):
        reader.receive(tick, (message(tick),))
        if reader.ready(tick):
            break
    assert 5 < tick < 199


def test_another_offer_is_read_anew():
    reader = MessageReader(TRAITS, 0, 0.1)
    reader.receive(0, (message(0),))
    first = reader.now.until
    reader.receive(5, (message(1, (4.0, 1.0, 1.0)),))
    assert reader.now.number == 2
    assert reader.now.until != first


def test_what_was_read_before_is_read_faster_and_counted():
    firsts, seconds = [], []
    for k in range(200):
        reader = MessageReader(TRAITS, seeds.derive(0, k), 0.1)
        firsts.append(finished(reader))
        seconds.append(finished(reader, number=1, tick=300))
        reader.receive(900, (message(2),))
        assert reader.now.again == 2
    assert sum(seconds) < 0.85 * sum(firsts)


def test_sameness_is_of_object_and_place():
    assert is_same_message(message(0), message(1, (1.2, 1.1, 1.0)))
    assert not is_same_message(message(0), message(1, (3.0, 1.0, 1.0)))
    assert not is_same_message(message(0), message(1, thing="mug"))
    assert not is_same_message(message(0), message(1, None))
    assert is_same_message(message(0, None), message(1, None))


# -------------------------------------------------------------------------------------------------------------- decide


def test_answers_follow_every_term():
    assert share(trust=0.0) < share(trust=0.5) < share(trust=1.0)
    assert share(gain=60.0) > share(gain=0.0) > share(load=1.0) > share(load=1.0, again=3)
    slip = TRAITS.p_slip
    for changed, logit in (({}, TRAITS.a0), ({"load": 1.0}, TRAITS.a0 - TRAITS.a_load)):
        expected = (1 - slip) / (1 + math.exp(-logit)) + slip * (1 - 1 / (1 + math.exp(-logit)))
        assert share(**changed) == pytest.approx(expected, abs=0.05)


@given(st.floats(0, 1), st.floats(0, 90), st.floats(0, 1), st.integers(0, 5))
def test_the_terms_add_up_to_the_law(trust, saved, load, again):
    parts = accept_decision.acceptance_terms(TRAITS, offer(trust=trust, gain=saved, load=load, again=again))
    law = (
        TRAITS.a0
        + TRAITS.a_trust * (trust - 0.5)
        + TRAITS.a_gain * math.log(1.0 + saved)
        - TRAITS.a_load * load
        - TRAITS.a_again * again
    )
    assert sum(parts.values()) == pytest.approx(law)


def test_what_is_beside_the_point_is_accepted_by_slips_alone():
    assert share(relevant=False) == pytest.approx(TRAITS.p_slip, abs=0.02)
    careful = msgspec.structs.replace(TRAITS, p_slip=0.0)
    people = [subject(careful, seeds.derive(2, k)) for k in range(300)]
    said = [accept_decision.decide_answer(me, offer(), relevant=False) for me in people]
    assert "accept" not in said
    assert said.count("ignore") / 300 == pytest.approx(TRAITS.p_ignore, abs=0.08)


def test_each_message_has_its_own_luck():
    said = {
        tuple(accept_decision.decide_answer(subject(root=root), offer(number, trust=0.2)) for number in range(1, 30))
        for root in (5, 5, 6)
    }
    assert len(said) == 2
    assert all(len(set(row)) > 1 for row in said)


def test_a_policy_has_the_last_word():
    class Never(policy.Policy):
        def choose(self, situation):
            raise AssertionError

        def answer(self, offer):
            self.heard = offer
            return "ignore"

    head = Never()
    assert accept_decision.decide_answer(subject(chooser=head), offer(7)) == "ignore"
    assert head.heard.number == 7


def test_the_mind_tells_what_it_weighed():
    told = []
    me = subject()
    me.listener = told.append
    said = accept_decision.decide_answer(me, offer(gain=10.0))
    (event,) = told
    assert event.answer == said
    assert event.terms["gain"] == pytest.approx(TRAITS.a_gain * math.log(11.0), abs=1e-3)


# ---------------------------------------------------------------------------------------------------------------- gain


def option(name, belief, seconds, kappa=TRAITS.kappa):
    return Option(name=name, value=belief / seconds**kappa, spot=(0.0, 0.0), seconds=seconds)


def test_a_sure_thing_takes_its_time():
    assert accept_decision.expected_search_time([option("a", 1.0, 7.0)], 90.0, TRAITS.kappa) == pytest.approx(7.0)


def test_a_search_is_reckoned_in_its_order():
    found = accept_decision.expected_search_time(
        [option("far", 0.5, 20.0), option("near", 0.5, 5.0)], 90.0, TRAITS.kappa
    )
    assert found == pytest.approx(0.5 * 5.0 + 0.5 * 25.0)


def test_what_is_nowhere_takes_all_that_is_left():
    assert accept_decision.expected_search_time([], 40.0, TRAITS.kappa) == 40.0
    assert accept_decision.expected_search_time([option("a", 0.25, 10.0)], 40.0, TRAITS.kappa) == pytest.approx(
        0.25 * 10.0 + 0.75 * 40.0
    )


@given(st.lists(st.tuples(st.floats(0, 1), st.floats(1, 60)), max_size=12), st.floats(0, 90))
def test_no_search_takes_longer_than_is_left(parts, left):
    options = [option(str(k), belief, seconds) for k, (belief, seconds) in enumerate(parts)]
    assert 0.0 <= accept_decision.expected_search_time(options, left, TRAITS.kappa) <= left + 1e-9


# -------------------------------------------------------------------------------------------------------------- follow


def walled():
    """A map with a wall along x = 2, two metres of it, and a low thing along y = 2."""
    grid = GridMap(0.0, 0.0)
    bearings = np.linspace(-0.7, 0.7, 141)
    grid.integrate(
        Scan(
            origin=Pose(x=0.0, y=0.0, yaw=0.0),
            bearings=bearings,
            ranges=2.0 / np.cos(bearings),
            limit=8.0,
            tops=np.full(141, np.inf),
        )
    )
    up = bearings + math.pi / 2
    grid.integrate(
        Scan(
            origin=Pose(x=0.0, y=0.0, yaw=0.0),
            bearings=up,
            ranges=2.0 / np.cos(bearings),
            limit=8.0,
            tops=np.full(141, 0.9),
        )
    )
    return grid


def test_walls_hide_and_furniture_does_not():
    grid = walled()
    behind = follow_message.Walls(grid, (2.5, 0.0), 1.5)
    assert behind.hide((1.2, 0.1))
    assert not behind.hide((3.4, 0.3))
    over = follow_message.Walls(grid, (0.0, 2.5), 1.5)
    assert not over.hide((0.1, 1.2))


def journal(model, kind):
    return [entry for entry in model.journal if entry.kind == kind]


def heard(person, position, support="Fridge|1", ticks=300, traits=TRAITS, thing="apple"):
    flat = Flat(support)
    model = Model(Participant(seed=1, number=person, traits=traits))
    model.begin(flat.briefing(teammates=("robot",)))
    note = message(0, position, thing)
    answered = []

    def say(tick):
        return (note,) if tick >= 25 and not answered else ()

    for _ in range(ticks):
        answered += play(model, flat, ticks=1, say=say)[1]
    return model, flat, answered


def test_every_answer_is_in_the_journal():
    model, _, answered = heard(0, Flat("Fridge|1").apple, ticks=150)
    (entry,) = journal(model, "offer")
    assert entry.message == 0
    assert entry.words == 12
    assert entry.answer == ("accept" if answered and answered[0][1].accept else entry.answer)
    assert entry.useful
    assert entry.relevant
    assert entry.gain > 0.0
    assert 0.5 < entry.read_s < 15.0


def test_what_one_sees_oneself_may_still_be_accepted():
    """It saves nothing, and work is in hand; but it is about the task."""
    willing = msgspec.structs.replace(TRAITS, a0=9.0, p_slip=0.0)
    for person in range(6):
        flat = Flat("Table|1")
        model = Model(Participant(seed=1, number=person, traits=willing))
        model.begin(flat.briefing(relation="on", destination="bed", teammates=("robot",)))
        play(model, flat, ticks=400, until=lambda flat=flat, model=model: model.about.startswith("fetch"))
        if not model.about.startswith("fetch"):
            continue
        play(model, flat, ticks=80, say=lambda tick, flat=flat: (message(0, flat.apple),))
        entries = journal(model, "offer")
        if entries and not flat.held:
            assert not entries[0].useful
            assert entries[0].load == 1.0
            assert entries[0].gain == 0.0
            assert entries[0].answer == "accept"
            return
    raise AssertionError("nobody was asked on the way")


def test_words_that_name_neither_a_thing_nor_a_place_are_about_nothing():
    """Else "I am here." every five seconds is taken up like a find, and earns trust like one."""
    willing = msgspec.structs.replace(TRAITS, a0=9.0, p_slip=0.0)
    for name, place, relevant in (("", None, False), ("", (9.0, 2.5, 0.6), True), ("apple", None, True)):
        model, _, _ = heard(0, place, ticks=150, traits=willing, thing=name)
        (entry,) = journal(model, "offer")
        assert (entry.relevant, entry.answer == "accept") == (relevant, relevant), name
        assert (model._dialogue.experience.helped is not None) == relevant, "it earns no trust"


def test_a_place_without_a_name_matters_only_while_something_is_missing():
    willing = msgspec.structs.replace(TRAITS, a0=9.0, p_slip=0.0)
    for person in range(6):
        flat = Flat("Table|1")
        model = Model(Participant(seed=1, number=person, traits=willing))
        model.begin(flat.briefing(relation="on", destination="bed", teammates=("robot",)))
        play(model, flat, ticks=400, until=lambda flat=flat, model=model: model.about.startswith("fetch"))
        if not model.about.startswith("fetch"):
            continue
        play(model, flat, ticks=80, say=lambda tick: (message(0, (9.0, 2.5, 0.6), ""),))
        entries = journal(model, "offer")
        if entries and not flat.held:
            assert not entries[0].relevant
            assert entries[0].answer != "accept"
            return
    raise AssertionError("nobody was asked on the way")


def test_who_never_accepts_walks_as_if_nobody_spoke_when_reading_costs_nothing():
    """A declined message leaves no trace but the time it takes."""
    deaf = msgspec.structs.replace(TRAITS, a0=-50.0, p_slip=0.0, k_read=1.0)
    paths = []
    for says in (True, False):
        flat = Flat("Bed|1")
        model = Model(Participant(seed=1, number=2, traits=deaf))
        model.begin(flat.briefing(teammates=("robot",)))
        trace, _ = play(model, flat, ticks=300, say=(lambda tick: (message(0, (9.0, 2.5, 0.6)),)) if says else None)
        paths.append(trace)
    assert paths[0] == paths[1]
