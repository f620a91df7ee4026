"""Trials that are driven from outside, copied and played by other clocks, in real worlds with human proxies."""

from __future__ import annotations

from typing import Any

import pytest

from benchmarks.driving import drive
from hthor import tasks
from hthor.episode import Charged, Concurrent, Episode, EpisodeLog, play
from hthor.tasks.suite import make_suite
from hthor.trials import TrialRunner
from hthor.trials.sessions import Session, make_sessions
from hthor.types import Action

TRIALS = 2


@pytest.fixture(scope="module", autouse=True)
def shared_worlds() -> None:
    """Here a runner of trials has worlds of its own."""


@pytest.fixture(scope="module")
def runner() -> TrialRunner:
    return TrialRunner()


@pytest.fixture(scope="module")
def elsewhere() -> TrialRunner:
    """Another, with worlds of its own."""
    return TrialRunner()


@pytest.fixture(scope="module")
def session() -> Session:
    few = make_suite("few", 1, tuple(task for task in tasks.load_suite("smoke").tasks if task.house == "elder"))
    return make_sessions(few, agent="frontier", participants=2)[1]


@pytest.fixture(scope="module")
def logs(runner: TrialRunner, session: Session) -> list[EpisodeLog]:
    """The session's first trials in lock-step."""
    with runner.enter(session) as people:
        return [play(one, runner.world(one), people.humans, people.ready_agents()) for one in session.trials[:TRIALS]]


def test_driven_from_outside_it_is_the_same_trial(
    runner: TrialRunner, session: Session, logs: list[EpisodeLog]
) -> None:
    with runner.enter(session) as people:
        trials = session.trials[:TRIALS]
        assert [drive(one, runner.world(one), people.humans, people.ready_agents()) for one in trials] == logs


def test_decisions_that_cost_nothing_change_nothing(
    runner: TrialRunner, session: Session, logs: list[EpisodeLog]
) -> None:
    with runner.enter(session) as people:
        first = session.trials[0]
        free = play(first, runner.world(first), people.humans, people.ready_agents(), Charged(lambda: 0.0))
    with runner.enter(session) as people:
        instant = Concurrent(pace=lambda _: instant.settle())
        threads = play(first, runner.world(first), people.humans, people.ready_agents(), instant)
    assert free == threads == logs[0]


@pytest.mark.parametrize("at", [0, 57, 161])
def test_a_copy_goes_on_as_the_trial_does(
    runner: TrialRunner, elsewhere: TrialRunner, session: Session, logs: list[EpisodeLog], at: int
) -> None:
    """Also in another world of the same house; models of people cannot be copied, so the copy repeats their actions."""
    first = session.trials[0]
    with runner.enter(session) as people:
        actors = {**people.humans, **people.ready_agents()}
        episode = Episode(first, runner.world(first), tuple(actors))
        episode.reset()
        for seat, actor in actors.items():
            actor.begin(episode.briefing(seat))
        _drive(episode, actors, at)
        state = episode.save_state()
        twin = Episode(first, elsewhere.world(first), tuple(actors))
        twin.load_state(state)
        for actions in _drive(episode, actors):
            for seat, action in actions.items():
                twin.submit(seat, action, twin.observe(seat))
            twin.advance()
    assert twin.log() == episode.log()
    assert (twin.log().events, twin.log().paths) == (logs[0].events, logs[0].paths)


def _drive(episode: Episode, actors: dict[str, Any], ticks: int = 10**6) -> list[dict[str, Action]]:
    """Drive an episode up to a tick; the actions of each tick, by seat."""
    ticks_actions = []
    while not episode.done and episode.tick < ticks:
        actions = {seat: actors[seat].act(episode.observe(seat)) for seat in episode.waiting}
        for seat, action in actions.items():
            episode.submit(seat, action)
        episode.advance()
        ticks_actions.append(actions)
    return ticks_actions
