"""Reading a run's log with the corrections of its trials, which are in a file beside it.

Everything that scores, compares, draws or lists trials reads them here, so that a correction counts everywhere. The
metrics are those of the corrected trial.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path

import msgspec

from hthor import log_corrections
from hthor.errors import RunError
from hthor.eval.records import scored_trial, trial_log
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.records.trial_log import Place
from hthor.eval.records.trial_record import TrialRecord
from hthor.log_corrections import CorrectAdoption, Corrections, VoidTrial

_ByTrial = Mapping[str, tuple[VoidTrial | CorrectAdoption, ...]]


def read(path: Path) -> Iterator[tuple[bytes, ScoredTrial]]:
    """As `trial_log.read`: every line as it stands in the log, and its record as corrected.

    Raises:
        RunError: also for damaged corrections, and for one of a trial that the log does not have.
    """
    for place, line, record in places(path):
        del place
        yield line, record


def places(path: Path) -> Iterator[tuple[Place, bytes, ScoredTrial]]:
    """As `read`, with the place of each line."""
    known, seen = log_corrections.beside(path), set[str]()
    by_trial = {line.trial: known.of(line.trial) for line in known.lines}
    for place, line, record in trial_log.places(path):
        seen.add(record.key)
        yield place, line, _with(record, by_trial)
    check_trials(path, known, seen)


def check_trials(log: Path, known: Corrections, trials: set[str]) -> None:
    """Raise a RunError that names the first correction of a trial that a log with these keys does not have."""
    for line in known.lines:
        if line.trial not in trials:
            raise RunError(
                f"{log.with_name(log_corrections.NAME)}, line {line.number}: trial: {log} has no trial {line.trial}. "
                "If the trial is yet to be played again, repeat the command of the run; otherwise the file belongs to "
                "another run, so take it away."
            )


def corrected(record: TrialRecord, known: Corrections) -> ScoredTrial:
    """A record with these corrections of its events, and its metrics."""
    return _with(record, {record.key: known.of(record.key)})


def _with(record: TrialRecord, by_trial: _ByTrial) -> ScoredTrial:
    if own := by_trial.get(record.key, ()):
        events = log_corrections.corrected_events(record.events, record.ticks, own)
        record = msgspec.structs.replace(record, events=events)
    return scored_trial.score(record)
