"""Running the sessions of an evaluation in a worker: each trial becomes a record, and each failure a report."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import chain
from typing import TYPE_CHECKING

import msgspec

from hthor.eval.runner import fault_report
from hthor.eval.runner.messages import TrialOutcome
from hthor.trials.trial_runner import TrialRunner

if TYPE_CHECKING:
    from hthor.episode import TrialWorld
    from hthor.trials import Participants, Session, Sources
    from hthor.trials.trial_runner import TrialLoop
    from hthor.types import TrialSpec


def make_runner(
    sources: Sources | None = None,
    loop: TrialLoop | None = None,
    welcome: Callable[[Participants], None] | None = None,
    repetitions: Callable[[Session], Iterator[TrialSpec]] | None = None,
) -> Callable[[Session], Iterator[TrialOutcome]]:
    """A function that runs a session's trials in order. Called in the worker, as it imports large libraries.

    Args:
        loop: drives each trial; by default `hthor.episode.play`. welcome: called with a session's participants before
            its first trial. repetitions: asked after a session's last trial for attempts to play then, one by one.
    """
    from hthor.guest import GuestPool

    runner = TrialRunner(sources, GuestPool(), loop=loop)

    def run_session(session: Session) -> Iterator[TrialOutcome]:
        with runner.enter(session) as participants:
            if welcome is not None:
                welcome(participants)
            for trial in chain(session.trials, repetitions(session) if repetitions is not None else ()):
                yield run_trial(runner, participants, trial)

    return run_session


def run_trial(
    runner: TrialRunner, participants: Participants, trial: TrialSpec, world: TrialWorld | None = None
) -> TrialOutcome:
    """Run the session's next trial. An agent that failed is ended and reported.

    Args:
        world: used instead of the trial's world, for an observer.
    """
    from hthor.eval.records import trial_record

    played = runner.run(participants, trial, world)
    paths, log = runner.sources.agent_paths.values(), played.log
    faults = (msgspec.structs.replace(one, detail=fault_report.redact(one.detail, paths)) for one in log.faults)
    record = trial_record.make_record(trial, msgspec.structs.replace(log, faults=tuple(faults)))
    record = msgspec.structs.replace(record, files=played.opened or msgspec.UNSET)
    if not log.faults:
        return TrialOutcome(record=record)
    report = fault_report.describe_faults(record.key, trial, record.faults, participants.agents)
    for seat in dict.fromkeys(fault.seat for fault in log.faults):
        participants.dismiss(seat)
    return TrialOutcome(record=record, fault_report=report)
