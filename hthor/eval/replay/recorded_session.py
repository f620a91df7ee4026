"""Sessions with living people, run again: everybody does at every step what the journal says that they did.

Nobody can be asked again what they would do, and robots think in real time beside living people, so their decisions are
repeated too. Simulated people in the same trials decide once more, and decide the same.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import msgspec

from hthor.errors import RunError
from hthor.eval.config.human_populations import LIVE
from hthor.eval.records import trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.humans.core.recorded_inputs import RecordedInputs
from hthor.trials import Participants, TrialRunner
from hthor.trials.sessions import Session
from hthor.types import Action, Briefing, Controls, Observation, TrialSpec, Wait
from hthor.types.events import JournalEntry, Paused, Resumed


def is_live(spec: TrialSpec) -> bool:
    """Whether a living person took part in a trial."""
    return any(human.model == LIVE for human in spec.humans)


def enter(runner: TrialRunner, session: Session, folder: RunFolder) -> Participants:
    """The participants of a session that is run again: new ones, as in `TrialRunner.enter`, or those of the log.

    Raises:
        RunError: when an agent failed in a trial with living people, which cannot be repeated.
    """
    first = session.trials[0]
    if not is_live(first):
        return runner.enter(session)
    records = {record.key: record for record in folder.attempts()}
    logged = [records[trial_record.key(spec)] for spec in session.trials]
    if failed := next((one for one in logged if one.faults), None):
        raise RunError(
            f"{folder}: an agent failed in trial {failed.key}, beside a living person, and what it did cannot be "
            "repeated; 'hthor replay' without pictures of cameras draws the trial from its log alone."
        )
    robots = {robot.seat: RecordedSeat(robot.seat, logged) for robot in first.robots}
    participants = runner.enter(session)
    people = {human.seat: RecordedSeat(human.seat, logged) for human in first.humans if human.model == LIVE}
    return Participants({**participants.humans, **people}, first.robots, lambda robot: robots[robot.seat])


def without_pauses(record: TrialRecord) -> TrialRecord:
    """The record without its pauses, in which nothing happened."""
    return msgspec.structs.replace(
        record, events=tuple(one for one in record.events if not isinstance(one, Paused | Resumed))
    )


class RecordedSeat:
    """A person or a robot whose inputs were recorded, in the trials of a session one after another."""

    def __init__(self, seat: str, records: Sequence[TrialRecord]) -> None:
        self._seat, self._records = seat, iter(records)
        self._record: TrialRecord | None = None
        self._inputs: RecordedInputs | None = None

    def begin(self, briefing: Briefing) -> None:  # noqa: ARG002  the log says what was done
        """The next trial begins."""
        self._record = record = next(self._records)
        self._inputs = RecordedInputs(self._seat, record.events, record.journal, record.ticks)

    def frame(self, controls: Controls) -> None:
        """Do what was done in this step."""
        assert self._inputs is not None
        self._inputs.frame(controls)

    def act(self, observation: Observation) -> Action:  # noqa: ARG002  everything is done in `frame`
        """Never called; stands still."""
        return Action(motion=Wait())

    def rate(self, met: bool, tick: int) -> int | None:  # noqa: ARG002  the log says what they answered
        """The logged rating."""
        return self._record.ratings.get(self._seat) if self._record is not None else None

    def state(self) -> Mapping[str, Any]:
        """Nothing that would have to be kept."""
        return {}

    @property
    def journal(self) -> tuple[JournalEntry, ...]:
        """What the person's model wrote into the journal."""
        return self._inputs.own_journal if self._inputs is not None else ()
