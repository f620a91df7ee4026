"""Predictions of people's minds are scored against what these had in mind."""

from __future__ import annotations

import eval_fakes as fakes
import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor.eval.metrics.definitions.theory_of_mind import activity_match, belief_match
from hthor.eval.metrics.metric import Trial
from hthor.types.events import Believed, Predicted

_, (SESSION, *_) = fakes.run_of(10)
SPEC = SESSION.trials[0]
LOG = fakes.episode(SPEC)
PLACES = ("bed", "desk", "sofa")


def trial(said: list[dict[str, float]], true: list[dict[str, float]], **more: object) -> Trial:
    events = [Predicted(tick=n, seat="robot", person="human", object="apple", places=p) for n, p in enumerate(said)]
    journal = [Believed(tick=n, seat="human", object="apple", places=p, next="search") for n, p in enumerate(true)]
    return Trial(SPEC, msgspec.structs.replace(LOG, events=(*events, *LOG.events), journal=tuple(journal), **more))


distributions = st.lists(st.floats(0.0, 1.0), min_size=3, max_size=3).map(
    lambda raw: {place: share / max(1.0, sum(raw)) for place, share in zip(PLACES, raw, strict=True)}
)


@given(distributions, distributions)
def test_the_match_is_an_overlap(one: dict[str, float], two: dict[str, float]) -> None:
    match = belief_match(trial([one], [two]))
    assert match is not None
    assert 0.0 <= match <= 1.0
    assert match == pytest.approx(belief_match(trial([two], [one])), abs=1e-9)
    assert belief_match(trial([one], [one])) == pytest.approx(1.0, abs=1e-6)


def test_the_match_of_known_distributions() -> None:
    assert belief_match(trial([{"bed": 1.0}], [{"desk": 1.0}])) == 0.0
    assert belief_match(trial([{"bed": 0.5}], [{"bed": 0.2, "desk": 0.3}])) == pytest.approx(0.2 + 0.5)
    assert belief_match(trial([{"bed": 1.0}, {"bed": 1.0}], [{"bed": 1.0}, {"desk": 1.0}])) == 0.5


def test_trials_without_predictions_or_without_a_mind_have_no_value() -> None:
    assert belief_match(trial([], [{"bed": 1.0}])) is None
    assert belief_match(trial([{"bed": 1.0}], [])) is None
    assert activity_match(trial([{"bed": 1.0}], [{"bed": 1.0}])) is None


def test_an_activity_scores_the_probability_that_it_was_given() -> None:
    base = trial([{"bed": 1.0}], [{"bed": 1.0}])
    for share in (0.0, 0.25, 1.0):
        said = Predicted(tick=0, seat="robot", person="human", object="apple", next={"search": share, "rest": 0.0})
        log = msgspec.structs.replace(base.log, events=(said,))
        assert activity_match(Trial(SPEC, log)) == share
