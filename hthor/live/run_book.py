"""The log of a run that is being played, as the experimenter's desk reads and corrects it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hthor import rules
from hthor.errors import HthorError
from hthor.eval.records import attempts, corrections
from hthor.eval.records.attempts import Attempts
from hthor.eval.records.corrections import CorrectionOptions
from hthor.eval.records.run_folder import RunFolder
from hthor.live.desk_wire import PlayedTrial

if TYPE_CHECKING:
    from hthor.eval.records.scored_trial import ScoredTrial
    from hthor.types import TrialSpec

_WORDS = {True: "yes", False: "no", None: "exclude"}
"""What `hthor correct --adoption` calls them."""


class RunBook:
    """The `hthor.live.desk.Book` of a run in a folder, which this process has locked; empty before `open`."""

    def __init__(self) -> None:
        self._path: Path | None = None

    def open(self, folder: RunFolder) -> None:
        """Show the run of this folder from now on."""
        self._path = folder.path

    def played(self) -> tuple[PlayedTrial, ...]:
        """The trials that are over, in the order of the session; an attempt that was voided comes before the next."""
        if self._path is None:
            return ()
        folder = RunFolder(self._path)
        if not folder.holds_run or not folder.log_file.exists():
            return ()
        return tuple(_line(folder, record) for record in folder.attempts())

    def repeat(self, trial: str, reason: str) -> None:
        """Void a trial that is over, and have it repeated; errors as in `hthor.eval.records.corrections.correct`."""
        self._correct(CorrectionOptions(trial=trial, void=True, again=True, reason=reason))

    def due(self, session: int) -> tuple[TrialSpec, ...]:
        """The next attempts at the trials of a session of which every attempt so far was voided."""
        assert self._path is not None
        folder = RunFolder(self._path)
        tried = {
            attempts.attempt_of(record, folder.corrections.given_up): record.spec
            for record in folder.attempts()
            if record.spec.session == session
        }
        known = Attempts(tried)
        numbers = {(one.place, one.number) for one in tried}
        specs = {one.place: spec for one, spec in tried.items()}
        return tuple(
            attempts.numbered(spec, known.number(place))
            for place, spec in specs.items()
            if (place, known.number(place)) not in numbers
        )

    def correct(self, trial: str, seat: str, adopted: bool | None, reason: str) -> None:
        """Add a correction to the run's; errors as in `hthor.eval.records.corrections.correct`."""
        self._correct(CorrectionOptions(trial=trial, adoption=_WORDS[adopted], seat=seat, reason=reason))

    def _correct(self, options: CorrectionOptions) -> None:
        if self._path is None:
            raise HthorError("no trial of this session has begun.")
        if not options.reason.strip():
            raise HthorError("a correction needs a reason; write one.")
        corrections.correct(self._path, options, locked=True)


def _line(folder: RunFolder, record: ScoredTrial) -> PlayedTrial:
    made = folder.corrections.of(record.key)
    people = [human.seat for human in record.spec.humans]
    shares = record.metrics.by_seat("adoption_by")
    if len(people) == 1 and (share := record.metrics["adoption"]) is not None:
        shares = {people[0]: share}  # values by person are kept only for several
    return PlayedTrial(
        key=record.key,
        task=record.spec.task.id,
        index=record.spec.index,
        attempt=record.spec.attempt or 0,
        met=record.met,
        seconds=round(record.ticks * rules.TICK_S, 1),
        voided=record.log.voided,
        adopted={seat: bool(shares[seat]) if seat in shares else None for seat in people},
        corrections=tuple(f"{one.number}: {one.reason}" for one in made),
    )
