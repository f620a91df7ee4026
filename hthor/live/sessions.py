"""Plays sessions with people at pages: every trial until an attempt counts, after those that the log has already."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from hthor.eval.config.human_populations import LIVE
from hthor.eval.records import attempts, trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.replay.recorded_session import RecordedSeat
from hthor.eval.runner.messages import TrialOutcome
from hthor.eval.runner.session_runner import run_trial
from hthor.guest import GuestPool
from hthor.humans.model import State
from hthor.humans.models import live
from hthor.live.loop import RealTimeLoop
from hthor.live.practice import Practice
from hthor.live.practice_room import practice_trial
from hthor.live.preparation import prepare
from hthor.live.seat import LiveSeat
from hthor.live.unfinished import UnfinishedTrial
from hthor.trials import Participants, Sources, TrialRunner, Worlds
from hthor.trials.sessions import Session
from hthor.types import TrialSpec

if TYPE_CHECKING:
    from hthor.world import World

_WORLDS_BYTES = 100_000_000
"""The most memory for worlds that are kept: about three houses, as sessions seldom come back to one. Our choice."""
States = Mapping[str, State]
"""What people remember of earlier trials, by seat."""


class LiveSessions:
    """A session runner, see `hthor.eval.runner.messages.SessionRunner`, for people at pages.

    A trial that is voided is repeated at once, as its next attempt; simulated people remember nothing of it. Trials
    that are in the log are not repeated: when simulated people take part, those trials are run again from everybody's
    inputs, as in a replay, for them to remember.

    Args:
        folder: of the run. unfinished: keeps the trial that is going on.
        due: the next attempts at trials of a session, by its number, that were voided after they were over; they are
            played when all others are.
        practice: whether people practise before a session's first trial. A session that goes on begins without.
    """

    def __init__(
        self,
        sources: Sources,
        seats: Mapping[str, LiveSeat],
        loop: RealTimeLoop,
        folder: RunFolder,
        unfinished: UnfinishedTrial,
        due: Callable[[int], Sequence[TrialSpec]] = lambda _: (),
        *,
        practice: bool = False,
    ) -> None:
        self._runner = TrialRunner(sources, GuestPool(), Worlds(_WORLDS_BYTES), loop)
        self._past = TrialRunner(sources, worlds=self._runner.worlds)
        self._seats, self._folder, self._unfinished, self._due = seats, folder, unfinished, due
        self._loop, self._practises = loop, practice

    def __call__(self, session: Session) -> Iterator[TrialOutcome]:
        """Play what is left of a session."""
        if self._practises and not self._begun(session):
            self._practise(session)
        logged = {record.key: record for record in self._played(session)}
        past: list[ScoredTrial] = []
        states: States = {}
        with self._runner.enter(session) as participants:
            for trial in session.trials:
                if (record := logged.get(trial_record.key(trial))) is not None:
                    past.append(record)
                    continue
                states, past = remember(self._past, past, states), []
                yield from self._play(participants, trial, states)
                states = {seat: human.state() for seat, human in participants.humans.items()}
            while repeated := self._due(session.number):
                trial = repeated[0]
                before = [record for record in self._played(session) if record.spec.index < trial.index]
                yield from self._play(participants, trial, remember(self._past, before, {}))

    def _practise(self, session: Session) -> None:
        """Let the people at pages practise; nobody remembers it, and it is in no log."""
        first = session.trials[0]
        people = self._runner.make_people(first)
        practice = Practice(self._seats)
        trial = practice_trial(first, self._seats)
        with Participants({name: people[name] for name in self._seats}, trial.robots, lambda _: practice.guide) as all_:
            welcome(all_, self._seats)
            self._loop(trial, self._world(trial), all_.humans, all_.ready_agents(), practice)

    def _world(self, trial: TrialSpec) -> World:
        return prepare(lambda: self._runner.world(trial))

    def _begun(self, session: Session) -> bool:
        """Whether the log has any attempt at a trial of the session."""
        return any(record.spec.session == session.number for record in RunFolder(self._folder.path).attempts())

    def _played(self, session: Session) -> list[ScoredTrial]:
        """The session's trials that the log has, in their order."""
        records = RunFolder(self._folder.path).played()
        return [record for record in records if record.spec.session == session.number]

    def _play(self, participants: Participants, trial: TrialSpec, states: States) -> Iterator[TrialOutcome]:
        """Play a trial until an attempt counts."""
        number = trial.attempt or 0
        while True:
            participants.humans = self._runner.make_people(trial, states)
            welcome(participants, self._seats)
            attempt = attempts.numbered(trial, number)
            outcome = run_trial(self._runner, participants, attempt, self._world(attempt))
            yield outcome
            self._unfinished.forget()  # now that the record is in the log
            self._loop.show_played()
            if not outcome.record.log.voided:
                return
            number += 1


def remember(runner: TrialRunner, past: Sequence[ScoredTrial], states: States) -> States:
    """What people remember after trials of the log.

    Args:
        runner: plays them once more, from everybody's inputs.
        past: trials of one session, which followed on those that the people remember already, as ``states`` says.
    """
    if not past or all(human.model == LIVE for human in past[0].spec.humans):
        return states
    first = past[0].spec
    people = runner.make_people(first, states)
    people |= {one.seat: RecordedSeat(one.seat, past) for one in first.humans if one.model == LIVE}
    robots = {robot.seat: RecordedSeat(robot.seat, past) for robot in first.robots}
    with Participants(people, first.robots, lambda robot: robots[robot.seat]) as participants:
        for record in past:
            runner.run(participants, record.spec)
    return {seat: human.state() for seat, human in people.items()}


def welcome(participants: Participants, seats: Mapping[str, LiveSeat]) -> None:
    """Connect the people of a session with the pages in their seats."""
    for name, seat in seats.items():
        human = participants.humans[name]
        assert isinstance(human, live.Model)
        human.port = seat
