"""What it costs to drive trials from outside, a tick at a time, instead of by `hthor.episode.play`."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from benchmarks.scenes import hands
from benchmarks.table import Clock, Row
from hthor.episode import Episode, EpisodeLog, play
from hthor.humans.model import HumanModel
from hthor.trials import TrialRunner
from hthor.trials.sessions import Session
from hthor.types import Mind, TrialSpec
from hthor.world import World

RATIO = 1.05
"""A trial that is driven from outside costs at most this many times as much."""

Player = Callable[[TrialSpec, World, Mapping[str, HumanModel], Mapping[str, Mind]], EpisodeLog]


def rows(suite: str, pairs: int) -> Iterator[Row]:
    """The cost of whole sessions with the frontier robot, driven from outside, as a ratio to `play`.

    Args:
        pairs: how many pairs of sessions are played, one of each sort, in alternating order.
    """
    runner, sessions = TrialRunner(), hands(suite, "frontier")
    _cost(runner, sessions[0], play)  # compiles
    ratios = []
    for number in range(pairs):
        session = sessions[number % len(sessions)]
        sorts: tuple[Player, ...] = (drive, play) if number % 2 else (play, drive)
        costs = {sort: _cost(runner, session, sort) for sort in sorts}
        ratios.append(costs[drive] / costs[play])
    remark = f"{pairs} pairs of sessions, {min(ratios):.2f} to {max(ratios):.2f}"
    value = statistics.median(ratios)
    yield Row(part="trials", what="driven from outside / play", value=value, unit="x", bar=RATIO, remark=remark)


def drive(trial: TrialSpec, world: World, humans: Mapping[str, HumanModel], robots: Mapping[str, Mind]) -> EpisodeLog:
    """Play a trial by the loop that docs/episode.md shows."""
    actors: dict[str, Any] = {**humans, **robots}
    episode = Episode(trial, world, tuple(actors))
    episode.reset()
    for seat, actor in actors.items():
        actor.begin(episode.briefing(seat))
    while not episode.done:
        for seat in episode.waiting:
            episode.submit(seat, actors[seat].act(episode.observe(seat)))
        episode.advance()
    ratings = {seat: human.rate(episode.met, episode.tick) for seat, human in humans.items()}
    return episode.log(ratings, {seat: getattr(human, "journal", ()) for seat, human in humans.items()})


def _cost(runner: TrialRunner, session: Session, player: Player) -> float:
    """CPU time [ms] of a session's trials."""
    cost = 0.0
    with runner.enter(session) as people:
        for trial in session.trials:
            world, robots = runner.world(trial), people.ready_agents()
            clock = Clock()
            player(trial, world, people.humans, robots)
            cost += clock()
    return cost
