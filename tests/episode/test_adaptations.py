"""Robots tell that they have changed their own policy: what the log takes, and the two metrics of it."""

from __future__ import annotations

import math

import eval_fakes as fakes
import msgspec
import pytest
from walking_stage import begun

from hthor.eval.metrics.definitions.adaptation import adaptation_divergence, adaptations
from hthor.eval.metrics.metric import Trial
from hthor.types import HUMAN, Action, Adapt
from hthor.types.events import Adapted, Refused


def test_one_adaptation_of_a_robot_is_taken_in_a_tick() -> None:
    episode = begun()
    episode.submit("robot", Action(signals=(Adapt(divergence=0.12345678), Adapt(divergence=1.0))))
    first, second = episode.advance()[:2]
    assert first == Adapted(tick=0, seat="robot", divergence=0.123457)
    assert second == Refused(tick=0, seat="robot", reason="only one adaptation is taken in a tick")
    episode.submit("robot", Action(signals=(Adapt(divergence=0.0),)))
    assert isinstance(episode.advance()[0], Adapted)


@pytest.mark.parametrize(
    ("seat", "divergence", "says"),
    [
        ("robot", -0.1, "from 0 on"),
        ("robot", math.inf, "from 0 on"),
        ("robot", math.nan, "from 0 on"),
        (HUMAN, 0.1, "only robots"),
    ],
)
def test_what_is_no_adaptation_is_refused(seat: str, divergence: float, says: str) -> None:
    episode = begun()
    episode.submit(seat, Action(signals=(Adapt(divergence=divergence),)))
    event = episode.advance()[0]
    assert isinstance(event, Refused)
    assert says in event.reason


def test_adaptations_are_counted_and_their_divergence_is_averaged() -> None:
    _, (session, *_) = fakes.run_of(10)
    spec = session.trials[0]
    log = fakes.episode(spec)
    assert (adaptations(Trial(spec, log)), adaptation_divergence(Trial(spec, log))) == (None, None)
    events = tuple(Adapted(tick=n, seat="robot", divergence=0.1 * n) for n in range(4))
    adapted = Trial(spec, msgspec.structs.replace(log, events=(*events, *log.events)))
    assert adaptations(adapted) == 4
    assert adaptation_divergence(adapted) == pytest.approx(0.15)
