"""Making a correction of a run's trial, and listing all: what `hthor correct` does."""

import os
from pathlib import Path
from typing import Any

from msgspec import UNSET, Struct

from hthor import jsonio, log_corrections
from hthor.errors import HthorError, RunError, UnknownName
from hthor.eval.records import find, trial_log
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.log_corrections import AnyCorrection, CorrectAdoption, VoidTrial, Withdraw

SCHEMA = "hthor.corrections/1"
ADOPTIONS: dict[str, bool | None] = {"yes": True, "no": False, "exclude": None}
"""The words for a judgement of an adoption."""


class CorrectionOptions(Struct, frozen=True, kw_only=True):
    """What `hthor correct` was asked for: one of ``void``, ``adoption`` and ``withdraw``, or none, to list all.

    ``adoption`` is one of `ADOPTIONS`, and ``seat`` the person's, which only trials of several people need.
    """

    trial: str = ""
    void: bool = False
    again: bool = False
    adoption: str = ""
    seat: str = ""
    withdraw: int | None = None
    reason: str = ""
    by: str = ""
    date: str = ""

    @property
    def asks(self) -> tuple[str, ...]:
        """The options that ask for a correction."""
        asked = {"--void": self.void, "--adoption": bool(self.adoption), "--withdraw": self.withdraw is not None}
        return tuple(name for name, given in asked.items() if given)


class CorrectedTrial(Struct, frozen=True, kw_only=True):
    """A correction, its trial, and whether it is in effect: it may be withdrawn, or replaced by a later one.

    ``trial_number`` is the trial's number on the command line, None for an attempt that was repeated.
    """

    correction: AnyCorrection
    in_effect: bool
    task: str
    session: int
    index: int
    trial_number: int | None


class CorrectionList(Struct, frozen=True, kw_only=True):
    """The document of `hthor correct`: all corrections of a run, the new one too, and whether that was written."""

    schema: str = SCHEMA
    folder: str
    corrections: tuple[CorrectedTrial, ...]
    added: int | None = None
    written: bool = False


def correct(folder: Path, options: CorrectionOptions, *, dry: bool = False, locked: bool = False) -> CorrectionList:
    """Make the correction that the options ask for, if they do, and list all.

    Args:
        dry: check everything, and write nothing. locked: this process has locked the run already.

    Raises:
        UnknownName, HthorError: when the options ask for nothing that can be done; says what can.
        RunLocked: when another process is writing this run.
        RunError: when the run cannot be read.
    """
    if len(options.asks) > 1:
        raise HthorError(f"{' and '.join(options.asks)} are two corrections; give one command for each.")
    run = RunFolder(folder)
    run.config  # noqa: B018  raises where there is no run
    if not options.asks:
        _check_listing(options)
        return _listed(run, run.corrections.lines)
    if dry:
        line = _make(run, options)
        return _listed(run, (*run.corrections.lines, line), line.number)
    lock = None if locked else trial_log.lock(folder)
    try:
        line = _make(run, options)
        append(folder, (line,))
    finally:
        if lock is not None:
            os.close(lock)
    run = RunFolder(folder)  # with the new correction
    return _listed(run, run.corrections.lines, line.number, written=True)


def append(folder: Path, lines: tuple[AnyCorrection, ...]) -> None:
    """Add lines to the corrections of a run that this process has locked."""
    path, check, data = folder / log_corrections.NAME, log_corrections.load(folder).check, b""
    for line in lines:
        text = log_corrections.encode(line, check)
        check = log_corrections.check_of(text)
        data += text
    handle = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC, 0o644)
    size = os.fstat(handle).st_size
    try:
        os.write(handle, data)
        os.fsync(handle)
    except OSError as error:
        os.ftruncate(handle, size)
        raise RunError(f"{path}: {error.strerror}. Nothing was added; make room, and repeat the command.") from None
    finally:
        os.close(handle)
    jsonio.sync_folder(folder)


def _make(run: RunFolder, options: CorrectionOptions) -> AnyCorrection:
    """The next line of the run's corrections."""
    if not options.reason.strip():
        raise HthorError(f"a correction needs a reason: add --reason 'why' to {options.asks[0]}.")
    if options.withdraw is not None:
        return _withdrawal(run, options, options.withdraw)
    if not options.trial:
        raise HthorError(f"{options.asks[0]} needs a trial: hthor correct RUN TRIAL {options.asks[0]}.")
    record = find.find_trial(run, options.trial)
    if record.log.voided:
        later = next((one.number for one in run.corrections.of(record.key) if isinstance(one, VoidTrial)), None)
        how = f"by correction {later}; withdraw that first" if later else "when it was played, and cannot be corrected"
        raise HthorError(f"trial {record.key} ({record.spec.task.id}) was voided {how}: {record.log.voided}.")
    own = _signed(run, record.key, options)
    if options.void:
        return VoidTrial(again=options.again, **own)
    return CorrectAdoption(seat=_seat(record, options.seat), adopted=_adopted(options.adoption), **own)


def _withdrawal(run: RunFolder, options: CorrectionOptions, number: int) -> Withdraw:
    lines = {line.number: line for line in run.corrections.lines}
    taken_back = {line.withdraws: line.number for line in lines.values() if isinstance(line, Withdraw)}
    if options.trial:
        raise HthorError(f"--withdraw names a correction by its number, and no trial: leave out '{options.trial}'.")
    if number not in lines:
        hint = f"'hthor correct {run}' lists them."
        raise UnknownName("correction", str(number), [str(one) for one in lines if one not in taken_back], hint)
    if isinstance(lines[number], Withdraw):
        raise HthorError(f"correction {number} is a withdrawal itself; make the correction again that it took back.")
    if number in taken_back:
        raise HthorError(f"correction {number} is withdrawn already, by correction {taken_back[number]}.")
    return Withdraw(withdraws=number, **_signed(run, lines[number].trial, options))


def _signed(run: RunFolder, trial: str, options: CorrectionOptions) -> dict[str, Any]:
    """The fields that every correction has."""
    return {
        "number": len(run.corrections.lines) + 1,
        "trial": trial,
        "reason": options.reason.strip(),
        "by": options.by.strip() or UNSET,
        "date": options.date.strip() or UNSET,
    }


def _adopted(word: str) -> bool | None:
    if word not in ADOPTIONS:
        raise UnknownName("judgement", word, ADOPTIONS, "--adoption says whether the person adopted a suggestion.")
    return ADOPTIONS[word]


def _seat(record: TrialRecord, wanted: str) -> str:
    """The seat of the person whose adoption is corrected."""
    if not record.spec.robots:
        raise HthorError(f"trial {record.key} has no robot, so nobody could adopt a suggestion.")
    people = [human.seat for human in record.spec.humans]
    if wanted and wanted not in people:
        raise UnknownName("person", wanted, people)
    if not wanted and len(people) > 1:
        raise HthorError(f"trial {record.key} has {len(people)} people; say whose adoption, with --seat {people[0]}.")
    return wanted or people[0]


def _check_listing(options: CorrectionOptions) -> None:
    """Check that no option was given that only a correction takes."""
    if options != CorrectionOptions():
        raise HthorError(
            "say what is to be corrected: --void for a broken trial, --adoption yes, no or exclude, or --withdraw N "
            "for correction N. 'hthor correct RUN' alone lists all corrections."
        )


def _listed(
    run: RunFolder, lines: tuple[AnyCorrection, ...], added: int | None = None, *, written: bool = False
) -> CorrectionList:
    """All lines with their trials."""
    records = {record.key: record for record in run.attempts()}
    numbers = {record.key: number for number, record in enumerate(run.played())}
    in_effect = {line.number for line in log_corrections.Corrections(lines=lines).in_effect}
    return CorrectionList(
        folder=str(run),
        corrections=tuple(
            CorrectedTrial(
                correction=line,
                in_effect=line.number in in_effect,
                task=records[line.trial].spec.task.id,
                session=records[line.trial].spec.session,
                index=records[line.trial].spec.index,
                trial_number=numbers.get(line.trial),
            )
            for line in lines
        ),
        added=added,
        written=written,
    )
