"""The mailbox's laws: one open message, statuses that only move forward, one end each, and no way to make it raise."""

from __future__ import annotations

import math
import unicodedata

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor import jsonio, rules
from hthor.comms import mailbox
from hthor.comms.mailbox import Mailbox
from hthor.types import HUMAN, Reply, Send

RANK = {"sent": 0, "shown": 1, "accepted": 2, "declined": 2, "covered": 2}
ROBOTS = ("robot", "robot2")


def kinds(events):
    return [event.kind for event in events]


def test_a_message_lives_as_sent_shown_confirmed():
    box = Mailbox(ROBOTS)
    assert box.receipt("robot") is None
    assert kinds(box.send(3, "robot", Send(text="here", object="apple", position=(1, 2, 3)))) == ["sent"]
    (message,) = box.inbox(HUMAN)
    assert (message.id, message.tick, message.sender, message.position) == (0, 3, "robot", (1.0, 2.0, 3.0))
    assert kinds(box.shown(4)) == ["shown"]
    assert box.shown(5) == ()
    assert kinds(box.reply(9, HUMAN, Reply(message=0, accept=True))) == ["accepted"]
    assert box.inbox(HUMAN) == ()
    assert (box.receipt("robot").status, box.receipt("robot").tick) == ("accepted", 9)


def test_any_robot_covers_the_open_message_and_the_covered_one_cannot_be_answered():
    box = Mailbox(ROBOTS)
    box.send(0, "robot", Send(text="a"))
    events = box.send(1, "robot2", Send(text="b"))
    assert [(event.kind, event.seat, event.message) for event in events] == [
        ("covered", "robot2", 0),
        ("sent", "robot2", 1),
    ]
    (refused,) = box.reply(2, HUMAN, Reply(message=0, accept=True))
    assert refused.kind == "refused"
    assert "covered" in refused.reason
    assert box.receipt("robot").status == "covered"
    assert box.receipt("robot2").status == "sent"


def test_an_answered_message_is_not_covered():
    box = Mailbox(ROBOTS)
    box.send(0, "robot", Send(text="a"))
    box.reply(1, HUMAN, Reply(message=0, accept=False))
    assert kinds(box.send(2, "robot", Send(text="b"))) == ["sent"]
    assert box.messages[0][1].status == "declined"


def test_changed_is_settled_by_reading():
    box = Mailbox(ROBOTS)
    assert not box.changed(HUMAN)
    box.send(0, "robot", Send(text="a"))
    assert box.changed(HUMAN)
    box.inbox(HUMAN)
    box.receipt("robot")
    assert not box.changed(HUMAN)
    assert not box.changed("robot")
    box.shown(1)
    assert box.changed("robot")
    assert not box.changed("robot2")
    assert not box.changed(HUMAN)
    box.receipt("robot")
    box.reply(2, HUMAN, Reply(message=0, accept=True))
    assert box.changed("robot")
    assert not box.changed(HUMAN)


def test_pictures_are_not_taken_by_the_mailbox():
    def image():
        raise AssertionError("rendered")

    box = Mailbox(ROBOTS)
    box.send(0, "robot", Send(text="a"), image)
    assert box.inbox(HUMAN)[0].image is image


def test_a_long_text_costs_no_more_than_a_short_one(monkeypatch: pytest.MonkeyPatch) -> None:
    looked: list[str] = []
    category = unicodedata.category
    monkeypatch.setattr(unicodedata, "category", lambda char: looked.append(char) or category(char))
    kept, cut = mailbox.clean_text("x" * 60_000, 280)
    assert (kept, cut) == ("x" * 280, 59_720)
    assert len(looked) < 3_000


def test_long_text_is_cut_and_the_event_says_so():
    box = Mailbox(ROBOTS)
    (event,) = box.send(0, "robot", Send(text="x" * (rules.TEXT_MAX + 7)))
    assert event.cut == 7
    assert len(box.inbox(HUMAN)[0].text) == rules.TEXT_MAX


@pytest.mark.parametrize("position", [(math.nan, 0, 0), (0, math.inf, 0), (1, 2), "abc", 5, ("a", 1, 2)])
def test_positions_that_are_no_positions_are_refused(position):
    (event,) = Mailbox(ROBOTS).send(0, "robot", Send(text="a", position=position))
    assert event.kind == "refused"
    assert "finite" in event.reason


def test_array_positions_become_plain_floats():
    box = Mailbox(ROBOTS)
    (event,) = box.send(0, "robot", Send(text="a", position=np.array([1.0, 2.0, 3.0], dtype=np.float32)))
    assert box.inbox(HUMAN)[0].position == (1.0, 2.0, 3.0)
    jsonio.canonical(event)


@pytest.mark.parametrize(
    ("seat", "send"),
    [
        ("ghost", Send(text="a")),
        ("robot9", Send(text="a")),
        ("robot", Send(text=None)),
        ("robot", Send(text="", object=3)),
    ],
)
def test_what_cannot_be_sent_is_refused(seat, send):
    box = Mailbox(ROBOTS)
    assert kinds(box.send(0, seat, send)) == ["refused"]
    assert box.inbox(HUMAN) == ()


@pytest.mark.parametrize(
    ("seat", "reply"),
    [
        ("robot", Reply(message=0, accept=True)),
        (HUMAN, Reply(message=7, accept=True)),
        (HUMAN, Reply(message=-1, accept=True)),
        (HUMAN, Reply(message="0", accept=True)),
        (HUMAN, Reply(message=0, accept="yes")),
    ],
)
def test_replies_that_make_no_sense_are_refused(seat, reply):
    box = Mailbox(ROBOTS)
    box.send(0, "robot", Send(text="a"))
    assert kinds(box.reply(1, seat, reply)) == ["refused"]
    assert box.receipt("robot").status == "sent"


@given(st.text())
def test_text_is_one_line_of_encodable_characters(written):
    kept, cut = mailbox.clean_text(written, 20)
    assert len(kept) <= 20
    assert cut >= 0
    assert kept == " ".join(kept.split())
    assert all(char.isprintable() for char in kept)
    assert mailbox.clean_text(kept, 20) == (kept, 0)
    kept.encode()


acts = st.one_of(
    st.tuples(st.just("send"), st.sampled_from(ROBOTS), st.text(max_size=5)),
    st.tuples(st.just("shown"), st.none(), st.none()),
    st.tuples(st.just("reply"), st.integers(-1, 8), st.booleans()),
)


@given(st.lists(acts, max_size=30))
def test_laws_of_every_history(history):
    box, before, ends = Mailbox(ROBOTS), {}, []
    for tick, (what, a, b) in enumerate(history):
        if what == "send":
            events = box.send(tick, a, Send(text=b))
        elif what == "shown":
            events = box.shown(tick)
        else:
            events = box.reply(tick, HUMAN, Reply(message=a, accept=b))
        jsonio.canonical(events)
        ends += [event.message for event in events if event.kind in ("accepted", "declined", "covered")]
        after = {message.id: receipt.status for message, receipt in box.messages}
        assert sum(status in ("sent", "shown") for status in after.values()) <= 1
        assert len(box.inbox(HUMAN)) == sum(status in ("sent", "shown") for status in after.values())
        for number, status in before.items():
            assert RANK[after[number]] > RANK[status] or after[number] == status
        before = after
    assert sorted(ends) == [number for number, status in before.items() if RANK[status] == 2]


PEOPLE = (HUMAN, "human2")


def test_each_person_answers_a_message_to_all():
    box = Mailbox(ROBOTS, PEOPLE)
    box.send(0, "robot", Send(text="here"))
    box.reply(1, "human2", Reply(message=0, accept=True))
    assert [receipt.status for _, receipt in box.messages] == ["sent", "accepted"]
    assert (box.receipt("robot").by, box.receipt("robot").status) == ("human2", "accepted")
    assert len(box.inbox(HUMAN)) == 1
    assert box.inbox("human2") == ()


def test_a_message_to_one_leaves_the_other_panel_alone():
    box = Mailbox(ROBOTS, PEOPLE)
    box.send(0, "robot", Send(text="both"))
    events = box.send(1, "robot2", Send(text="one", to="human2"))
    assert [event.kind for event in events] == ["covered", "sent"]
    assert events[0].reader == "human2"
    assert [message.text for message in box.inbox(HUMAN)] == ["both"]
    assert [message.text for message in box.inbox("human2")] == ["one"]


def test_people_write_to_robots_which_see_it_once():
    box = Mailbox(ROBOTS, PEOPLE)
    box.send(0, HUMAN, Send(text="I take the kitchen.", position=(1, 2, 0)))
    assert [message.text for message in box.inbox("robot")] == ["I take the kitchen."]
    assert kinds(box.shown(0, "robot")) == ["shown"]
    assert box.inbox("robot") == ()
    assert len(box.inbox("human2")) == len(box.inbox("robot2")) == 1


def test_a_question_to_a_person_is_answered_by_yes_or_no():
    box = Mailbox(ROBOTS)
    box.send(0, "robot", Send(text="Did you find it?", question=True))
    (event,) = box.reply(4, HUMAN, Reply(message=0, accept=False))
    assert (event.kind, event.yes) == ("answered", False)
    assert (box.receipt("robot").status, box.receipt("robot").yes) == ("answered", False)


def test_a_question_to_a_robot_stays_until_it_is_answered():
    box = Mailbox(ROBOTS)
    box.send(0, HUMAN, Send(text="Where is it?", to="robot", question=True))
    box.shown(0, "robot")
    assert len(box.inbox("robot")) == 1
    assert kinds(box.send(3, "robot", Send(text="There.", answers=0))) == ["answered", "sent"]
    assert box.inbox("robot") == ()
    assert box.inbox(HUMAN)[0].answers == 0
    assert kinds(box.send(4, "robot", Send(text="There!", answers=0))) == ["refused"]


def test_a_newer_question_of_the_same_person_covers_the_older():
    box = Mailbox(ROBOTS, PEOPLE)
    box.send(0, HUMAN, Send(text="Where is it?", to="robot", question=True))
    box.send(0, "human2", Send(text="And the mug?", to="robot", question=True))
    events = box.send(3, HUMAN, Send(text="Where is the book?", to="robot", question=True))
    assert kinds(events) == ["covered", "sent"]
    assert [message.text for message in box.inbox("robot")] == ["And the mug?", "Where is the book?"]


@pytest.mark.parametrize(
    ("seat", "send"),
    [
        ("robot", Send(text="a", to="robot2")),
        ("robot", Send(text="a", to="robot")),
        ("robot", Send(text="a", to="ghost")),
        ("robot", Send(text="a", to=3)),
        ("robot", Send(text="a", question="yes")),
        ("robot", Send(text="a", answers=7)),
        ("robot", Send(text="a", answers=0)),
        ("robot2", Send(text="a", answers=1)),
        ("robot", Send(text="a", answers=1, to="human2")),
    ],
)
def test_addresses_and_answers_that_fit_nothing_are_refused(seat, send):
    box = Mailbox(ROBOTS, PEOPLE)
    box.send(0, "robot", Send(text="a statement", to=HUMAN))
    box.send(0, HUMAN, Send(text="a question", to="robot", question=True))
    assert kinds(box.send(1, seat, send)) == ["refused"]
    assert len(box.messages) == 2


@given(st.lists(acts, max_size=20), st.lists(acts, max_size=10))
def test_a_copy_has_the_same_future(past, future):
    box, copy = Mailbox(ROBOTS), Mailbox(ROBOTS)

    def play(box, history, start):
        for tick, (what, a, b) in enumerate(history, start):
            if what == "send":
                yield box.send(tick, a, Send(text=b))
            elif what == "shown":
                yield box.shown(tick)
            else:
                yield box.reply(tick, HUMAN, Reply(message=a, accept=b))

    list(play(box, past, 0))
    copy.load_state(box.save_state())
    assert list(play(box, future, 100)) == list(play(copy, future, 100))
    assert box.messages == copy.messages
