"""People ask and answer: it takes time to read, think, press and speak, and they say what they believe."""

from __future__ import annotations

import math
from itertools import pairwise

import msgspec
import pytest
from fake_flat import Flat, play

from hthor import plugins
from hthor.humans.communication import asking, speech
from hthor.humans.communication.asking import Asking
from hthor.humans.communication.message_reading import is_offer, is_remark
from hthor.humans.communication.speech import Speech
from hthor.humans.models import asking as asking_model
from hthor.humans.models import proxy
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Participant
from hthor.types import HUMAN, Message, Receipt, Reply, Send
from hthor.types.events import Asked, Misled, Offer, Replied

TRAITS = Parameters(p_slip=0.0, p_fail=0.0, read_sd=0.0)
FOUND, ACCEPTED, WHERE = "Have you found the apple?", "Did you accept my suggestion?", "Where is the apple?"
BED = (8.5, 2.7, 0.6)


def person(model=proxy.Model, number=0, **traits):
    return model(Participant(seed=0, number=number, traits=msgspec.structs.replace(TRAITS, **traits)))


def message(text, number=0, about="apple", sender="robot", **more):
    return Message(id=number, sender=sender, tick=0, text=text, object=about, **more)


def question(text, number=0, about="apple", sender="robot"):
    return message(text, number, about, sender, question=True)


class Panel:
    """Shows each message from its tick on, until it is answered or another one covers it."""

    def __init__(self, flat, *messages):
        self.flat, self.messages, self.closed = flat, messages, set()

    def __call__(self, tick):
        shown = [one for at, one in self.messages if at <= tick]
        return tuple(one for one in shown[-1:] if one.id not in self.closed)

    def run(self, one, ticks=900, until=None):
        """Let the person act; a reply closes its message. Returns poses and what was said."""
        trace, said = [], []
        for _ in range(ticks):
            part, heard = play(one, self.flat, 1, say=self)
            trace += part
            said += heard
            for _, say in heard:
                self.closed.add(say.message if isinstance(say, Reply) else say.answers)
            if until is not None and until():
                break
        return trace, said


def begun(model=proxy.Model, number=0, flat=None, robots=("robot",), **traits):
    flat, one = flat or Flat(), person(model, number, **traits)
    one.begin(flat.briefing(teammates=robots))
    return flat, one


def entries(one, kind):
    return [entry for entry in one.journal if isinstance(entry, kind)]


# ------------------------------------------------------------------------------------------------------- time to answer


def test_a_button_takes_a_press_and_a_sentence_its_words():
    voice = Speech(0.1)
    assert voice.begin(0, Reply(message=0, accept=True)) == speech.PREPARE_S + speech.PRESS_S
    assert voice.finish(15, (question(FOUND),)) is None
    assert voice.finish(16, (question(FOUND),)) == Reply(message=0, accept=True)
    assert voice.now is None
    assert voice.begin(0, Send(text="Where is the apple?")) == pytest.approx(speech.PREPARE_S + 4 / 2.5)
    assert 60 * speech.WORDS_PER_S == 150


def test_an_answer_lapses_when_its_question_is_gone():
    voice = Speech(0.1)
    voice.begin(0, Reply(message=3, accept=True))
    assert voice.finish(99, ()) is None
    assert voice.now is None


@pytest.mark.parametrize("text", [FOUND, ACCEPTED])
def test_a_question_takes_noticing_reading_thinking_and_a_press(text):
    flat, one = begun(flat=Flat(support="Fridge|1"))
    _, said = Panel(flat, (100, question(text))).run(one, 170)
    words = len(text.split())
    takes = TRAITS.t_notice + TRAITS.t_read * words / 12 + speech.PREPARE_S + speech.PRESS_S
    ((tick, reply),) = said
    assert reply == Reply(message=0, accept=False)
    assert tick - 100 == pytest.approx(takes / 0.1, abs=4)  # a motion or glimpse may have to end first
    (entry,) = entries(one, Replied)
    assert (entry.answer, entry.words, entry.seconds) == ("no", words, 1.55)
    assert entry.read_s == pytest.approx(TRAITS.t_notice + TRAITS.t_read * words / 12, abs=0.4)


def test_reading_and_answering_slows_walking():
    """The same course as without the question, but later: half the pace from noticing it to the press."""
    metres = {}
    for asked in (False, True):
        flat, one = begun(number=1, stop_every=math.inf)
        trace, _ = Panel(flat, *([(100, question(FOUND))] if asked else [])).run(one, 150)
        steps = [math.dist(a[:2], b[:2]) for a, b in pairwise(trace)]
        metres[asked] = sum(steps[:100]), sum(steps[100:])
    assert metres[True][0] == metres[False][0]
    seconds = TRAITS.t_read * 5 / 12 + speech.PREPARE_S + speech.PRESS_S
    lost = metres[False][1] - metres[True][1]
    assert lost == pytest.approx(seconds * TRAITS.v_pace * (1.0 - 1.0 / TRAITS.k_read), abs=0.1)


# -------------------------------------------------------------------------------------------------------------- answers


@pytest.mark.parametrize(("support", "knows"), [("Bed|1", True), ("Fridge|1", False)])
def test_says_whether_the_thing_was_found(support, knows):
    flat, one = begun(flat=Flat(support=support))
    _, said = Panel(flat, (100, question(FOUND))).run(one, 170)
    assert [say for _, say in said] == [Reply(message=0, accept=knows)]


@pytest.mark.parametrize(("willing", "accepts"), [(9.0, True), (-9.0, False)])
def test_says_whether_the_suggestion_was_accepted(willing, accepts):
    flat, one = begun(a0=willing, p_ignore=1.0, flat=Flat(support="Fridge|1"))
    offer = message("I found the apple on the bed.", 0, position=BED)
    _, said = Panel(flat, (100, offer), (200, question(ACCEPTED, 1, about=""))).run(one, 300)
    assert said[-1][1] == Reply(message=1, accept=accepts)


def test_a_suggestion_that_was_covered_unread_was_not_accepted():
    flat, one = begun(a0=9.0)
    offer = message("I found the apple on the bed.", 0, position=BED)
    _, said = Panel(flat, (100, offer), (105, question(ACCEPTED, 1))).run(one, 300)
    assert [say for _, say in said] == [Reply(message=1, accept=False)]


def test_another_person_who_asks_for_a_place_is_told():
    flat, one = begun(flat=Flat(support="Table|1"), robots=("human2", "robot"))
    _, said = Panel(flat, (450, question(WHERE, 0, sender="human2"))).run(one, 700)
    ((_, told),) = said
    assert isinstance(told, Send)
    assert (told.text, told.to, told.answers) == ("The apple is at the dining table.", "human2", 0)
    assert told.object == "apple"
    assert math.dist(told.position, flat.apple) < 0.01
    (entry,) = entries(one, Replied)
    assert entry.answer == "told"
    assert entry.seconds == pytest.approx(speech.PREPARE_S + 7 / speech.WORDS_PER_S, abs=0.01)


def test_who_does_not_know_a_place_says_no():
    flat, one = begun(flat=Flat(support="Fridge|1"))
    _, said = Panel(flat, (50, question(WHERE))).run(one, 200)
    assert [say for _, say in said] == [Reply(message=0, accept=False)]


def test_furniture_counts_too():
    flat, one = begun(flat=Flat(support="Fridge|1"))
    _, said = Panel(
        flat,
        (100, question("Where is the dining table?", 0, "dining_table")),
        (250, question("Is the apple on the table?", 1, "")),
        (350, question("How do you like it here?", 2, "")),
    ).run(one, 450)
    assert [say.answers for _, say in said] == [0]
    assert [entry.answer for entry in entries(one, Replied)] == ["told", "ignore", "ignore"]


@pytest.mark.parametrize("name", sorted(set(plugins.names("human model")) - {"live", "recorded", "replay"}))
def test_every_model_answers_questions(name):
    flat, one = begun(plugins.load("human model", name), flat=Flat(support="Fridge|1"))
    _, said = Panel(flat, (60, question(FOUND))).run(one, 200)
    assert any(isinstance(say, Reply) for _, say in said)


# ----------------------------------------------------------------------------------------------------------- own asking


def test_who_searches_in_vain_asks_and_is_heard_at_the_end_of_the_sentence():
    flat, one = begun(asking_model.Model, flat=Flat(support="Fridge|1"), lam0=1e-9)
    _, said = Panel(flat).run(one, 600, until=lambda: flat.open)
    tick, sent = said[0]
    assert sent == Send(text=WHERE, object="apple", to="robot", question=True)
    entry = entries(one, Asked)[0]
    assert (entry.object, entry.words, entry.seconds) == ("apple", 4, 2.95)
    assert tick == pytest.approx(entry.tick + 29.5, abs=4)
    assert entry.tick > asking.PATIENCE_S / 0.1


def test_the_proxy_never_asks():
    flat, one = begun(flat=Flat(support="Fridge|1"), lam0=1e-9)
    assert Panel(flat).run(one, 600)[1] == []


def ask(asker, now_tick, receipt=None, name="apple"):
    now = msgspec.structs.replace(Flat().observation(), tick=now_tick, receipt=receipt)
    return asker.question(now, name, name)


def test_asks_again_while_it_is_answered():
    asker, asked = Asking(("robot",), 0.1), []
    for tick in range(900):
        receipt = Receipt(message=len(asked), status="answered", tick=tick) if asked else None
        if ask(asker, tick, receipt) is not None:
            asked.append(tick)
    assert asked == [200, 400, 600, 800]


def test_stops_when_nobody_answers():
    asker = Asking(("robot",), 0.1)
    shown = Receipt(message=0, status="shown", tick=0)
    assert [tick for tick in range(900) if ask(asker, tick, shown if tick > 200 else None)] == [200, 400]


def test_waits_anew_for_another_thing_and_after_something_to_read():
    asker = Asking(("robot",), 0.1)
    assert [ask(asker, tick) for tick in (0, 150)] == [None, None]
    assert ask(asker, 250, name="dining_table") is None
    assert ask(asker, 440, name="dining_table") is None
    asker.postpone(440)
    assert ask(asker, 460, name="dining_table") is None
    assert ask(asker, 640, name="dining_table") is not None
    assert ask(asker, 2000, name="") is None


@pytest.mark.parametrize(
    ("teammates", "to"),
    [(("robot",), "robot"), (("human2", "robot"), "robot"), (("robot", "robot2"), ""), (("human2",), "")],
)
def test_asks_the_only_robot_or_everybody(teammates, to):
    asker = Asking(teammates, 0.1)
    ask(asker, 0)
    assert ask(asker, 200).to == to


def test_asks_nobody_when_alone():
    asker = Asking((), 0.1)
    assert all(ask(asker, tick) is None for tick in range(0, 900, 50))


def test_an_answer_with_a_place_is_an_offer_and_one_without_is_only_read():
    known = message("I saw the apple on the bed.", 1, position=BED, answers=0, to=HUMAN)
    unknown = message("I have not seen the apple yet.", 2, answers=0, to=HUMAN)
    flat, one = begun(a0=9.0, flat=Flat(support="Fridge|1"))
    _, said = Panel(flat, (100, unknown), (200, known)).run(one, 300)
    assert [say for _, say in said] == [Reply(message=1, accept=True)]
    assert [entry.message for entry in entries(one, Offer)] == [1]


# -------------------------------------------------------------------------------------------------- what others say


def test_what_is_an_offer():
    robots = message("I found the apple.", position=BED)
    assert is_offer(robots)
    assert is_offer(message("Please help me."))
    assert not is_offer(question(FOUND))
    assert is_remark(message("I look in the kitchen.", sender="human2"))
    assert not is_remark(message("It is there.", sender="human2", position=BED))
    assert not is_offer(message("It is there.", sender="human2", position=BED))
    assert is_remark(message("I have not seen the apple yet.", answers=3))


def test_remarks_of_other_people_are_read_without_an_answer():
    flat, one = begun(robots=("human2", "robot"))
    _, said = Panel(flat, (50, message("I am looking in the kitchen.", 0, "", "human2"))).run(one, 200)
    assert said == []
    assert one._dialogue.reader.now.answered


def test_another_persons_advice_is_followed_and_leaves_trust_in_robots_alone():
    flat, one = begun(a0=9.0, robots=("human2", "robot"), flat=Flat(support="Fridge|1"), lam0=1e-9)
    before = one.trust
    advice = message("The apple is on the bed.", 0, sender="human2", position=BED)
    _, said = Panel(flat, (50, advice)).run(one, 500, until=lambda: one.about == "search" and flat.tick > 400)
    assert [say for _, say in said] == [Reply(message=0, accept=True)]
    assert max(pose[0] for pose in _) > 5.5
    assert not entries(one, Misled)
    assert one.trust == before
    assert not one._dialogue.experience.offered
    assert one._dialogue.experience.helped is None
