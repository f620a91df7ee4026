"""What the experimenter reads of each kind of event."""

from __future__ import annotations

from typing import get_args

import pytest

from hthor.live.event_sentences import sentence
from hthor.types import HUMAN
from hthor.types.events import (
    Accepted,
    Adapted,
    AdoptionJudged,
    AgentFault,
    Answered,
    Blocked,
    Closed,
    Covered,
    Declined,
    Displayed,
    Dropped,
    Event,
    Held,
    InWay,
    Lifted,
    Lowered,
    Opened,
    Paused,
    PhaseBegan,
    Picked,
    Placed,
    Predicted,
    Progress,
    Refused,
    Released,
    Resumed,
    SaidReady,
    Sent,
    Shown,
    Success,
    Thought,
    Timeout,
    Voided,
)

AT = {"tick": 3, "seat": HUMAN}
ROBOT = {"tick": 3, "seat": "robot"}

EXAMPLES: dict[str, Event] = {
    "robot said (message 0): “An apple is here.”": Sent(**ROBOT, message=0, text="An apple is here."),
    "robot asked human (message 1): “Is it here?”": Sent(
        **ROBOT, message=1, text="Is it here?", to=HUMAN, question=True
    ),
    "human answered to robot (message 2): “In the fridge.”": Sent(
        **AT, message=2, text="In the fridge.", to="robot", answers=1
    ),
    "human saw message 0 of robot": Shown(**AT, message=0, sender="robot"),
    "human confirmed message 0 of robot": Accepted(**AT, message=0, sender="robot"),
    "human declined message 0 of robot": Declined(**AT, message=0, sender="robot"),
    "robot replaced message 0 by message 2": Covered(**ROBOT, message=0, sender="robot", by=2),
    "human answered message 1 of robot with no": Answered(**AT, message=1, sender="robot", yes=False),
    "human answered message 1 of robot": Answered(**AT, message=1, sender="robot"),
    "human hid the map": Displayed(**AT, what="map", on=False, message=0),
    "human showed the message": Displayed(**AT, what="panel", on=True, message=0),
    "robot predicted what human believes and does next": Predicted(**ROBOT, person=HUMAN),
    "robot adapted its policy": Adapted(**ROBOT, divergence=0.1),
    "robot failed (raised) and takes no further part": AgentFault(**ROBOT, fault="raised"),
    "the part “look around” began": PhaseBegan(**AT, name="look_around"),
    "the task itself began": PhaseBegan(**AT),
    "human is ready for the next part": SaidReady(**AT),
    "the trial was paused: a question": Paused(**AT, reason="a question"),
    "the trial was paused": Paused(**AT),
    "the trial went on": Resumed(**AT),
    "the trial was voided: the headset failed": Voided(**AT, reason="the headset failed"),
    "the goal was met": Success(**AT),
    "the time ran out": Timeout(**AT),
    "the adoption of human is excluded: they said so": AdoptionJudged(**AT, adopted=None, reason="they said so"),
    "human could not pick: it is too far away": Refused(**AT, reason="it is too far away", motion="pick"),
    "human could not do that: there is no such message": Refused(**AT, reason="there is no such message", message=7),
    "human picked up apple": Picked(**AT, object="apple"),
    "human put apple on or in fridge 1": Placed(**AT, object="apple", on="fridge|1"),
    "human let go of apple": Dropped(**AT, object="apple"),
    "human opened fridge 1": Opened(**AT, thing="fridge|1"),
    "human closed fridge 1": Closed(**AT, thing="fridge|1"),
    "human took hold of coffee table": Held(**AT, object="coffee_table"),
    "human lifted sofa with robot": Lifted(**AT, object="sofa", bearers=(HUMAN, "robot")),
    "robot put down sofa, carried with human": Lowered(**ROBOT, object="sofa", bearers=(HUMAN, "robot")),
    "human let go of the handle of sofa": Released(**AT, object="sofa"),
    "robot stopped at wall": Blocked(**ROBOT, by="wall"),
    "human had robot in the way": InWay(**AT, by="robot"),
}


@pytest.mark.parametrize(("words", "event"), EXAMPLES.items())
def test_an_event_is_a_sentence(words: str, event: Event) -> None:
    assert sentence(event) == words


def test_every_event_that_is_shown_has_an_example() -> None:
    assert {type(event) for event in EXAMPLES.values()} == set(get_args(Event)) - {Thought, Progress}
