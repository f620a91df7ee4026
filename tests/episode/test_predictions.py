"""Robots say what they think of a person's mind: the episode takes distributions, and nothing else depends on them."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import pytest
from episode_fakes import TASK, trial
from hypothesis import given
from hypothesis import strategies as st
from walking_stage import SEATS, Chancy, WalkingStage, begun, minds

from hthor.episode import EpisodeLog, play
from hthor.episode.predictions import PLACES_MAX, predicted
from hthor.types import HUMAN, Action, Observation, Predict
from hthor.types.events import Believed, Predicted, Refused

PEOPLE = (HUMAN, "human2")


def test_a_prediction_is_logged_by_name_and_a_second_one_in_a_tick_is_refused() -> None:
    episode = begun()
    said = Predict(object="apple", places={"table": 0.25, "bed": 0.123456}, next={"search": 1.0})
    episode.submit("robot", Action(signals=(said, said)))
    first, second = episode.advance()[:2]
    places = {"bed": 0.1235, "table": 0.25}
    assert first == Predicted(tick=0, seat="robot", person=HUMAN, object="apple", places=places, next={"search": 1.0})
    assert isinstance(first, Predicted)
    assert list(first.places) == sorted(places)
    assert second == Refused(tick=0, seat="robot", reason="only one prediction is taken in a tick")
    episode.submit("robot", Action(signals=(said,)))
    assert isinstance(episode.advance()[0], Predicted)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"person": "robot"}, "'robot' is no person of this trial; its people are human, human2"),
        ({"places": {"bed": 1.0}}, "needs an object"),
        ({"object": "apple", "places": {"bed": 0.7, "sofa": 0.7}}, "add up to 1.400"),
        ({"next": {"search": math.nan}}, "'next' has a probability that is not from 0 to 1"),
        ({"next": {"search": -0.1}}, "'next' has a probability that is not from 0 to 1"),
        ({"next": {str(n): 0.0 for n in range(PLACES_MAX + 1)}}, f"at most {PLACES_MAX}"),
        ({"next": {"a\x1bb": 0.5}}, "printable"),
        ({"object": "x" * 300}, "printable"),
    ],
)
def test_what_is_no_prediction_is_refused(wrong: dict[str, Any], says: str) -> None:
    event = predicted(3, "robot", Predict(**wrong), PEOPLE)
    assert isinstance(event, Refused)
    assert says in event.reason


@given(st.dictionaries(st.text(max_size=8), st.floats(), max_size=6))
def test_only_probabilities_are_logged(shares: dict[str, float]) -> None:
    event = predicted(0, "robot", Predict(object="apple", places=shares), PEOPLE)
    if isinstance(event, Predicted):
        assert all(0.0 <= share <= 1.0 for share in event.places.values())
        assert math.fsum(event.places.values()) <= 1.001
        assert set(event.places) == set(shares)


class Predicting(Chancy):
    """Acts as the other one does, and predicts at every call."""

    def act(self, observation: Observation) -> Action:
        action = super().act(observation)
        return msgspec.structs.replace(action, signals=(Predict(next={"search": 1.0}),))


class Open(Chancy):
    """Tells what it has in mind."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.journal: list[Believed] = []

    def record_belief(self, tick: int, object: str) -> None:
        self.journal.append(Believed(tick=tick, seat=HUMAN, object=object, next="search"))


def logs(robot: type[Chancy], person: type[Chancy]) -> EpisodeLog:
    people, robots = minds(4)
    people = {seat: person(*_arguments(one)) for seat, one in people.items()}
    robots = {seat: robot(*_arguments(one)) for seat, one in robots.items()}
    spec = msgspec.structs.replace(trial(), task=msgspec.structs.replace(TASK, time_limit=12.0))
    return play(spec, WalkingStage(), people, robots)  # type: ignore[arg-type]


def _arguments(one: Any) -> tuple[Any, ...]:
    return tuple(getattr(one, name) for name in ("seat", "root") if hasattr(one, name))


def test_predictions_change_nothing_and_ask_the_person_in_mind() -> None:
    plain, predicting = logs(Chancy, Chancy), logs(Predicting, Open)
    said = [event for event in predicting.events if isinstance(event, Predicted)]
    told = [entry for entry in predicting.journal if isinstance(entry, Believed)]
    assert said
    assert {event.seat for event in said} == {seat for seat in SEATS if seat not in PEOPLE}
    assert [(entry.tick, entry.object) for entry in told] == [(event.tick, event.object) for event in said]
    assert [event for event in predicting.events if not isinstance(event, Predicted)] == list(plain.events)
    assert predicting.paths == plain.paths
    assert not [entry for entry in logs(Predicting, Chancy).journal if isinstance(entry, Believed)]
