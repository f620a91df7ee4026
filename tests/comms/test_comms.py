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
    assert [(event.kind, event.seat, event.data["message"]) for event in events] == [
        ("covered", "robot2", 0),
        ("sent", "robot2", 1),
    ]
    (refused,) = box.reply(2, HUMAN, Reply(message=0, accept=True))
    assert refused.kind == "refused"
    assert "covered" in refused.data["reason"]
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
    assert event.data["cut"] == 7
    assert len(box.inbox(HUMAN)[0].text) == rules.TEXT_MAX


@pytest.mark.parametrize("position", [(math.nan, 0, 0), (0, math.inf, 0), (1, 2), "abc", 5, ("a", 1, 2)])
def test_positions_that_are_no_positions_are_refused(position):
    (event,) = Mailbox(ROBOTS).send(0, "robot", Send(text="a", position=position))
    assert event.kind == "refused"
    assert "finite" in event.data["reason"]


def test_array_positions_become_plain_floats():
    box = Mailbox(ROBOTS)
    (event,) = box.send(0, "robot", Send(text="a", position=np.array([1.0, 2.0, 3.0], dtype=np.float32)))
    assert box.inbox(HUMAN)[0].position == (1.0, 2.0, 3.0)
    jsonio.canonical(event)


@pytest.mark.parametrize(
    ("seat", "send"),
    [
        (HUMAN, Send(text="a")),
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
    st.tuples(st.just("send"), st.sampled_from((*ROBOTS, HUMAN)), st.text(max_size=5)),
    st.tuples(st.just("shown"), st.none(), st.none()),
    st.tuples(st.just("reply"), st.integers(-1, 8), st.booleans()),
)


@pytest.mark.slow
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
        ends += [event.data["message"] for event in events if event.kind in ("accepted", "declined", "covered")]
        after = {message.id: receipt.status for message, receipt in box.messages}
        assert sum(status in ("sent", "shown") for status in after.values()) <= 1
        assert len(box.inbox(HUMAN)) == sum(status in ("sent", "shown") for status in after.values())
        for number, status in before.items():
            assert RANK[after[number]] > RANK[status] or after[number] == status
        before = after
    assert sorted(ends) == [number for number, status in before.items() if RANK[status] == 2]
