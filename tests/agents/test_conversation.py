"""Built-in robots talk with people: they answer questions, and may ask what became of their suggestions."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import pytest
from episode_fakes import BODY
from hypothesis import given
from hypothesis import strategies as st

from hthor import plugins
from hthor.agents.skills.conversation import queries
from hthor.agents.skills.conversation.answers import kind_of, named_kind
from hthor.agents.skills.conversation.conversation import Conversation
from hthor.agents.skills.message_timing import AGAIN_S, MessageTiming
from hthor.comms.mailbox import Mailbox
from hthor.types import (
    HUMAN,
    Action,
    Briefing,
    Detection,
    Job,
    Message,
    Observation,
    Pose,
    Receipt,
    Reply,
    Send,
    ThingState,
    Vec3,
    Wait,
)

APPLE: Vec3 = (1.0, 1.0, 0.8)
FOUND = Send(text="I found the apple.", object="apple", position=APPLE)


class Eyes:
    def __init__(self, *seen: Detection) -> None:
        self.seen = seen

    def detections(self) -> tuple[Detection, ...]:
        return self.seen


def thing(id: str, kind: str = "", family: Any = "object", at: Vec3 = APPLE, support: str = "", held: str = "") -> Any:
    size = (0.1, 0.1, 0.1)
    return Detection(
        id=id,
        kind=kind or kind_of(id),
        family=family,
        position=at,
        size=size,
        yaw=0.0,
        distance=1.0,
        support=support,
        held_by=held,
    )


TABLE = thing("table|1", "dining_table", "furniture", at=(1.0, 1.0, 0.4))


def briefing(*teammates: str, targets: tuple[str, ...] = ("apple",), seat: str = "robot") -> Briefing:
    return Briefing(
        seat=seat,
        instruction="Find an apple.",
        target=targets[0],
        destination="",
        relation="find",
        body=BODY,
        tick_s=0.1,
        time_limit=90.0,
        teammates=teammates or (HUMAN,),
        jobs=tuple(Job(target=target, relation="find") for target in targets),
    )


def conversation(
    told: Briefing | None = None, *, asks: bool = False, open: tuple[str, ...] = ("apple",)
) -> Conversation:
    return Conversation(told or briefing(), lambda: open, asks)


def look(*seen: Detection, tick: int = 0, **more: Any) -> Observation:
    return Observation(tick=tick, pose=Pose(x=0.0, y=0.0), idle=True, senses=Eyes(*seen), **more)


def question(text: str = "Where is the apple?", about: str = "apple", id: int = 7, **more: Any) -> Message:
    given = {"sender": HUMAN, "tick": 0, "to": "robot"}
    return Message(id=id, text=text, object=about, question=True, **{**given, **more})


def reply(talk: Conversation, asked: Message, *seen: Detection, say: Send | None = None, **more: Any) -> Send | None:
    """What the robot says when it is asked while it sees these things, and its policy would say ``say``."""
    heard = talk.hear(look(*seen, inbox=(asked,), **more))
    said = talk.speak(heard, Action(motion=Wait(), say=say)).say
    assert said is None or isinstance(said, Send)
    return said


# -------------------------------------------------------------------------------------------------------------- answers


def test_tells_what_it_sees() -> None:
    said = reply(conversation(), question(), TABLE, thing("apple", support="table|1"))
    assert said == Send(
        text="I found the apple on the dining table in front of me.",
        object="apple",
        position=APPLE,
        to=HUMAN,
        answers=7,
    )


def test_tells_where_it_saw_it_last() -> None:
    talk = conversation()
    talk.hear(look(TABLE, thing("apple", at=(5.0, 5.0, 0.0))))
    talk.hear(look(thing("apple", support="table|1")))
    said = reply(talk, question())
    assert said is not None
    assert (said.text, said.position) == ("I saw the apple on the dining table.", APPLE)


def test_tells_of_furniture_too() -> None:
    talk = conversation()
    talk.hear(look(TABLE))
    said = reply(talk, question("Where is the dining table?", "dining_table"))
    assert said is not None
    assert (said.text, said.object) == ("I saw the dining table here.", "table|1")


def test_says_that_it_does_not_know() -> None:
    said = reply(conversation(), question(about="apple_2"))
    assert said == Send(text="I have not seen the apple yet.", object="apple_2", to=HUMAN, answers=7)
    assert reply(conversation(), question("How are you?", "")) == Send(text="I do not know.", to=HUMAN, answers=7)


def test_a_question_without_an_object_is_read_by_its_words() -> None:
    said = reply(conversation(), question("Hello! Did you see the remote control?", ""))
    assert said is not None
    assert said.text == "I have not seen the remote control yet."
    assert named_kind("Where is the dining table, or the coffee table?") in ("dining_table", "coffee_table")
    assert named_kind("Where are my glasses?") == ""


def test_says_who_has_it() -> None:
    for held, text in (
        (HUMAN, "You have"),
        ("robot", "I have"),
        ("robot2", "Another robot has"),
        ("human2", "Another"),
    ):
        said = reply(conversation(), question(), thing("apple", held=held))
        assert said is not None
        assert said.text.startswith(text)


def test_of_several_things_of_a_kind_the_one_that_is_still_to_be_done_counts() -> None:
    told = briefing(targets=("apple_1", "apple_2", "apple_3"))
    done, near, far = thing("apple_1", at=(0.1, 0.0, 0.0)), thing("apple_2", at=(1.0, 0.0, 0.0)), thing("apple_3")
    said = reply(conversation(told, open=("apple_2", "apple_3")), question(), done, near, far)
    assert said is not None
    assert said.object == "apple_2"
    none = reply(conversation(told, open=("apple_3",)), question(), done)
    named = reply(conversation(told, open=("apple_3",)), question(about="apple_1"), done)
    assert named is not None
    assert named.object == "apple_1"
    assert none is not None
    assert none.text == "I have not seen the apple yet."


def test_knowing_everything_it_speaks_of_what_it_was_close_to() -> None:
    """With true states: not before it has detected the thing, and then where the thing is now."""
    moved = (ThingState(id="apple", kind="apple", position=(3.0, 3.0, 0.4)),)
    unseen = reply(conversation(), question(), truth=moved)
    assert unseen is not None
    assert unseen.position is None
    talk = conversation()
    talk.hear(look(thing("apple")))
    seen = reply(talk, question(), truth=moved)
    assert seen is not None
    assert seen.position == (3.0, 3.0, 0.4)
    behind_a_door = conversation()
    behind_a_door.speak(look(), Action(say=FOUND))
    told = reply(behind_a_door, question(), truth=moved)
    assert told is not None
    assert told.position == (3.0, 3.0, 0.4)


def test_of_several_robots_one_says_that_nobody_knows() -> None:
    for seat, says in (("robot", True), ("robot2", False)):
        told = briefing(HUMAN, "robot2" if seat == "robot" else "robot", seat=seat)
        assert (reply(conversation(told), question(to="")) is not None) is says
        assert reply(conversation(told), question(to=seat)) is not None
        assert reply(conversation(told), question(to=""), thing("apple")) is not None


def test_a_question_is_answered_once_in_the_mailbox() -> None:
    mailbox, talk = Mailbox(["robot"]), conversation()
    mailbox.send(0, HUMAN, Send(text="Where is the apple?", object="apple", question=True))
    mailbox.send(0, HUMAN, Send(text="I am looking in the kitchen.", position=(1.0, 1.0, 0.0)))
    said = []
    for tick in range(1, 5):
        heard = talk.hear(look(tick=tick, inbox=mailbox.inbox("robot"), receipt=mailbox.receipt("robot")))
        mailbox.shown(tick, "robot")
        action = talk.speak(heard, Action())
        if isinstance(action.say, Send):
            assert all(event.__struct_config__.tag != "refused" for event in mailbox.send(tick, "robot", action.say))
            said.append((tick, action.say.answers))
    assert said == [(1, 0)]


@given(st.lists(st.sampled_from([None, "sent", "shown", "accepted", "declined", "covered"]), max_size=12))
def test_without_questions_a_policy_sees_and_says_what_it_would_alone(statuses: list[Any]) -> None:
    talk = conversation()
    for tick, status in enumerate(statuses):
        receipt = None if status is None else Receipt(message=tick // 4, status=status, tick=tick)
        observation = look(tick=tick, receipt=receipt)
        action = Action(say=FOUND if tick % 3 == 0 else None)
        assert talk.hear(observation) is observation
        assert talk.speak(observation, action) is action


# --------------------------------------------------------------------------------------------- answers and suggestions


def test_a_suggestion_of_the_same_thing_is_the_answer() -> None:
    talk = conversation()
    said = reply(talk, question(), thing("apple"), say=FOUND)
    assert said == msgspec.structs.replace(FOUND, to=HUMAN, answers=7)
    receipt = Receipt(message=8, status="accepted", tick=3)
    assert talk.hear(look(receipt=receipt)).receipt == receipt


def test_another_suggestion_waits_as_if_it_had_been_covered() -> None:
    talk = conversation()
    said = reply(talk, question("Where is the table?", "dining_table"), TABLE, say=FOUND, tick=20)
    assert said is not None
    assert said.object == "table|1"
    heard = talk.hear(look(tick=21, receipt=Receipt(message=8, status="accepted", tick=21))).receipt
    assert heard is not None
    assert (heard.status, heard.tick) == ("covered", 20)


def test_a_policy_never_sees_what_became_of_an_answer() -> None:
    talk = conversation()
    talk.speak(talk.hear(look()), Action(say=FOUND))
    shown = Receipt(message=0, status="shown", tick=2)
    assert talk.hear(look(tick=2, receipt=shown)).receipt == shown
    reply(talk, question("Where is the table?", "dining_table"), tick=30, receipt=shown)
    for status in ("sent", "shown", "declined"):
        heard = talk.hear(look(tick=40, receipt=Receipt(message=2, status=status, tick=40))).receipt  # type: ignore[arg-type]
        assert heard == msgspec.structs.replace(shown, status="covered", tick=30)


# -------------------------------------------------------------------------------------------------------- own questions


def suggested(status: str, *, asks: bool = True, told: Briefing | None = None) -> Conversation:
    """A robot whose suggestion has had this status since tick 0."""
    talk = conversation(told, asks=asks)
    talk.speak(talk.hear(look()), Action(say=FOUND))
    talk.hear(look(tick=1, receipt=Receipt(message=0, status=status, tick=0)))  # type: ignore[arg-type]
    return talk


def say(talk: Conversation, tick: int, status: str, *seen: Detection) -> Any:
    receipt = Receipt(message=0, status=status, tick=0)  # type: ignore[arg-type]
    return talk.speak(talk.hear(look(*seen, tick=tick, receipt=receipt)), Action()).say


@pytest.mark.parametrize(
    ("status", "seconds", "text"),
    [
        ("shown", queries.UNANSWERED_S, "Did you accept my suggestion about the apple?"),
        ("accepted", queries.UNFOUND_S, "Have you found the apple?"),
    ],
)
def test_asks_once_after_a_while(status: str, seconds: float, text: str) -> None:
    talk, due = suggested(status), round(seconds / 0.1)
    asked = [(tick, said) for tick in range(2, 900, 3) if (said := say(talk, tick, status)) is not None]
    assert [said for _, said in asked] == [Send(text=text, object="apple", to=HUMAN, question=True)]
    assert due <= asked[0][0] < due + 3
    assert all(say(suggested(status, asks=False), tick, status) is None for tick in range(2, 900, 50))


@pytest.mark.parametrize("status", ["sent", "declined", "covered"])
def test_does_not_ask_when_it_knows(status: str) -> None:
    talk = suggested(status)
    assert all(say(talk, tick, status) is None for tick in range(2, 900, 10))


def test_does_not_ask_about_what_is_done_or_in_somebodys_hand() -> None:
    held = thing("apple", held=HUMAN)
    assert all(say(suggested("accepted"), tick, "accepted", held) is None for tick in range(2, 900, 50))
    done = conversation(asks=True, open=())
    done.speak(done.hear(look()), Action(say=FOUND))
    assert all(say(done, tick, "accepted") is None for tick in range(2, 900, 50))


@pytest.mark.parametrize("yes", [True, False])
@pytest.mark.parametrize("status", ["shown", "accepted"])
def test_uses_the_answer(status: str, yes: bool) -> None:
    """After a yes the policy stays quiet; after a no its suggestion is due again at once."""
    talk = suggested(status)
    timing = MessageTiming(briefing(), most=2)
    timing.note(0)
    assert say(talk, 400, status) is not None
    answer = Receipt(message=1, status="answered", tick=430, yes=yes)
    heard = talk.hear(look(tick=431, receipt=answer)).receipt
    assert heard is not None
    assert heard.status == ("accepted" if yes else "declined")
    assert timing.due(431, heard) is not yes


def test_a_question_without_an_answer_has_covered_the_suggestion() -> None:
    talk = suggested("shown")
    assert say(talk, 400, "shown") is not None
    heard = talk.hear(look(tick=500, receipt=Receipt(message=1, status="shown", tick=402))).receipt
    assert heard is not None
    assert (heard.status, heard.tick) == ("covered", 400)
    assert MessageTiming(briefing(), most=2).due(400 + round(AGAIN_S / 0.1), heard)


@pytest.mark.parametrize("name", ["frontier", "oracle"])
def test_the_plain_robots_never_ask(name: str) -> None:
    assert not plugins.load("agent", name).asks
    asking = plugins.load("agent", f"asking_{name}")
    assert asking.asks
    assert asking.privileges == plugins.load("agent", name).privileges


def test_only_the_person_who_was_told_is_asked() -> None:
    talk = suggested("accepted", told=briefing(HUMAN, "human2"))
    receipt = Receipt(message=0, status="accepted", tick=0, by="human2")
    asked = talk.speak(talk.hear(look(tick=400, receipt=receipt)), Action()).say
    assert isinstance(asked, Send)
    assert asked.to == "human2"
    assert not isinstance(asked, Reply)
    assert math.isclose(queries.UNFOUND_S, 25.0)
