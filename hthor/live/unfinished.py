"""The trial that is going on, kept in the run's folder, so that a session that is killed in it loses nothing.

The log has only trials that are over. While a trial goes on, a file beside the log has it as it will stand there if the
session ends now: voided at this tick, with everything that happened and everybody's inputs. The command that resumes
the session adds it to the log, and the trial is repeated as another attempt.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import msgspec

from hthor.episode import Episode
from hthor.eval.records import trial_record
from hthor.eval.records.trial_log import TrialLog
from hthor.eval.records.trial_record import Damaged, OtherVersion, TrialRecord
from hthor.humans.model import HumanModel
from hthor.types import HUMAN
from hthor.types.events import Resumed, Voided

NAME = "unfinished.json"
INTERRUPTED = "the session was interrupted in this trial"
"""Why such an attempt does not count."""


class UnfinishedTrial:
    """The file in a run's folder."""

    def __init__(self, folder: Path) -> None:
        self._file = folder / NAME

    def keep(self, episode: Episode, humans: Mapping[str, HumanModel]) -> None:
        """Keep the trial as it is now. Survives the end of this process, and not always a loss of power."""
        beside = self._file.with_name(f".{NAME}")
        beside.write_bytes(trial_record.encode(_voided(episode, humans)))
        beside.replace(self._file)

    def forget(self) -> None:
        """The trial is over, and in the log."""
        self._file.unlink(missing_ok=True)

    def add_to(self, log: TrialLog) -> TrialRecord | None:
        """Add the trial to the log as a voided attempt; None if there is none, or the log has it."""
        try:
            record = trial_record.decode(self._file.read_bytes())
        except (FileNotFoundError, Damaged, OtherVersion):  # damaged: the power was lost while it was written
            record = None
        added = record is not None and log.add(record)
        log.sync()
        self.forget()
        return record if added else None


def _voided(episode: Episode, humans: Mapping[str, HumanModel]) -> TrialRecord:
    """The record of a trial that is voided now."""
    journals = {seat: tuple(getattr(human, "journal", ())) for seat, human in humans.items()}
    log, now = episode.log({}, journals), episode.tick
    ends = (
        *((Resumed(tick=now, seat=HUMAN),) if episode.paused else ()),
        Voided(tick=now, seat=HUMAN, reason=INTERRUPTED),
    )
    return trial_record.make_record(episode.trial, msgspec.structs.replace(log, events=(*log.events, *ends)))
