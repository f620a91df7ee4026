"""Plays a logged trial again in a world that somebody watches, and checks that it went as it was logged."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from hthor import activity
from hthor.errors import RunError
from hthor.eval.records import trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay import recorded_session, session_history
from hthor.eval.replay.session_history import RunFiles
from hthor.eval.runner import session_runner
from hthor.guest import AgentInputs, GuestConfig
from hthor.trials import TrialRunner
from hthor.trials.sessions import Session

_Watched = TypeVar("_Watched", bound=Any)


def repeat_trial(
    folder: Path,
    wanted: TrialRecord,
    files: RunFiles,
    watch: Callable[[Any], _Watched],
    given: AgentInputs | None = None,
) -> _Watched:
    """Play the session of a run again up to one trial, and return the world of that trial.

    Args:
        folder: of the run. wanted: the trial.
        files: the user's files that the run's folder lacks. given: arguments and files that the agents were given.
        watch: makes of the trial's world one that the trial is played in, which must not change what happens.

    Raises:
        RunError: if trials before it are missing, another version of hthor played them, or the trial ends differently.
        HthorError: if a file that was not given is needed.
    """
    spec, run = wanted.spec, RunFolder(folder)
    session = Session(number=spec.session, trials=session_history.session_before(run, wanted))
    guests = GuestConfig(hidden=(str(folder.resolve()),), inputs=given or AgentInputs())
    stage = TrialRunner(session_history.replay_sources(run, spec, files, guests))
    with recorded_session.enter(stage, session, run) as company:
        for number, trial in enumerate(session.trials[:-1], 1):
            activity.say(f"playing {folder.name} again, trial {number} of {len(session.trials)}")
            session_runner.run_trial(stage, company, trial)
        activity.say(f"playing {folder.name} again, trial {len(session.trials)} of {len(session.trials)}")
        world = watch(stage.world(spec))
        done = session_runner.run_trial(stage, company, spec, world).record
        if _course(run.corrected(done)) != _course(wanted):
            if wanted.log.voided:
                raise RunError(
                    f"{folder}: trial {wanted.key} was voided while it was played, which cannot be repeated; "
                    "'hthor replay' draws the trial from its log alone."
                )
            raise RunError(
                f"{folder}: trial {wanted.key} did not repeat as it was logged, so its views would show another "
                "trial. The agent is not deterministic, or the machine is different; 'hthor replay' draws the trial "
                "from its log alone."
            )
        return world


def _course(done: TrialRecord) -> bytes:
    """Everything that happened, without the texts of faults, which agents write."""
    plain = tuple(msgspec.structs.replace(fault, detail="") for fault in done.faults)
    return trial_record.encode(msgspec.structs.replace(recorded_session.without_pauses(done), faults=plain))
